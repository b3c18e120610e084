#!/bin/sh
# Do the quick ones of the hard cases end as they expect? Prints TAP. All of them, half a minute:
# jointplay check cases/hard
program=$1
root=$2
cd "$root" || exit 1
folder=cases/hard
cases="cannot-close change-point grashof-limit change-points-together grazing jammed mass-ratio-ideal pin-leaves-its-hole
    quick-1-iteration redundant start-in-the-wall step-through-the-hole three-impacts two-pins
    zero-eccentricity zeno-chatter"
# shellcheck disable=SC2086
set -- $cases
echo "1..$(($# + 2))"
number=0
check() {
    "$program" check --quiet --expect-only --time-limit "60 s" "$@" 2>&1
}
for case in $cases; do
    number=$((number + 1))
    if words=$(check "$folder/$case.yaml"); then
        echo "ok $number - $case"
    else
        echo "not ok $number - $case"
        echo "$words" | sed 's/^/# /'
    fi
done
# the controls: a step four times as long does not keep the limits, and a pin that stays in its hole
# is not detected
for setting in "three-impacts run.step=20us" "pin-leaves-its-hole contact.stiffness=6.6e10N/m^1.5"; do
    number=$((number + 1))
    check "$folder/${setting% *}.yaml" --set "${setting#* }" >/dev/null
    status=$?
    if [ "$status" -eq 1 ]; then
        echo "ok $number - $setting is WRONG"
    else
        echo "not ok $number - $setting is WRONG: status $status"
    fi
done
