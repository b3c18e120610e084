#!/bin/sh
# Do the quick ones of the hard cases end as they expect? Prints TAP. All of them, half a minute:
# jointplay check cases/hard
program=$1
root=$2
cd "$root" || exit 1
folder=cases/hard
log=$(mktemp)
trap 'rm -f "$log"' EXIT
. tests/command/held_cases.sh
echo "1..24"
cases_hold cannot-close change-point grashof-limit change-points-together grazing jammed \
    mass-ratio-ideal pin-leaves-its-hole quick-1-iteration redundant start-in-the-wall \
    step-through-the-hole three-impacts two-pins zero-eccentricity zeno-chatter backlash-0 \
    backlash-1e-9 gears-inertia-ratio stop-restitution-1 stop-shorter-than-a-step
# a step four times as long does not keep the limits, a pin that stays in its hole is not
# detected, and flanks that are apart are not passed by as if they were one
cases_do_not_hold "three-impacts run.step=20us" \
    "pin-leaves-its-hole contact.stiffness=6.6e10N/m^1.5" \
    "backlash-0 joints.hinge.backlash=1deg"
