#!/bin/sh
# Does a mechanism of cases/mechanisms that is changed leave the limits that it expects? Prints TAP.
# That all of them keep these as they are .ci/run asks: jointplay check --quick cases/mechanisms
program=$1
root=$2
cd "$root" || exit 1
folder=cases/mechanisms
log=$(mktemp)
trap 'rm -f "$log"' EXIT
. tests/command/held_cases.sh
echo "1..14"
cases_hold slider-crank bouncing-ball newtons-cradle pendulum pin-coupling
# a floor that takes more, spheres that lose some of their speed, a longer rod, teeth that keep to one
# flank, gears that give way by more, another gravity, a stronger torque, a hole in its place
cases_do_not_hold "bouncing-ball contact.restitution=0.7" \
    "newtons-cradle contact.damping=lankarani-nikravesh" "slider-crank slider-crank.rod.length=121mm" \
    "gear-pair torsion-springs.bearing.damping=6N*mm*s/rad" "servo-backlash joints.output.stiffness=160N*m/rad" \
    "pendulum gravity=9.82m/s^2" "four-bars-2 gravity=9.82m/s^2" "andrews drive.torque=0.034N*m" \
    "pin-coupling joints.pin-1.at-a=[20mm,0mm]"
