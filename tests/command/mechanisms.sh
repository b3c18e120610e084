#!/bin/sh
# Do the mechanisms of cases/mechanisms keep the limits that they expect, and does a change of them
# leave these? Prints TAP. The longer ones: jointplay check cases/mechanisms
program=$1
root=$2
cd "$root" || exit 1
folder=cases/mechanisms
cases="slider-crank slider-crank-pin slider-crank-guide slider-crank-both woodpecker bouncing-ball
    newtons-cradle"
# shellcheck disable=SC2086
set -- $cases
echo "1..$(($# + 3))"
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
# the controls: a floor that takes more, spheres that lose some of their speed, a longer rod
for setting in "bouncing-ball contact.restitution=0.7" \
    "newtons-cradle contact.damping=lankarani-nikravesh" "slider-crank slider-crank.rod.length=121mm"; do
    number=$((number + 1))
    check "$folder/${setting% *}.yaml" --set "${setting#* }" >/dev/null
    status=$?
    if [ "$status" -eq 1 ]; then
        echo "ok $number - $setting leaves the limits"
    else
        echo "not ok $number - $setting leaves the limits: status $status"
    fi
done
