#!/bin/sh
# Does a hard case that is changed no longer end as it expects? Prints TAP. That all of them end so
# as they are, half a minute, .ci/run asks: jointplay check --expect-only cases/hard
program=$1
root=$2
cd "$root" || exit 1
folder=cases/hard
log=$(mktemp)
trap 'rm -f "$log"' EXIT
. tests/command/held_cases.sh
echo "1..6"
cases_hold three-impacts pin-leaves-its-hole backlash-0
# a step four times as long does not keep the limits, a pin that stays in its hole is not
# detected, and flanks that are apart are not passed by as if they were one
cases_do_not_hold "three-impacts run.step=20us" \
    "pin-leaves-its-hole contact.stiffness=6.6e10N/m^1.5" \
    "backlash-0 joints.hinge.backlash=1deg"
