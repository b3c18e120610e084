#!/bin/sh
# Does every command take a hole pattern with an error of place, in every scheme of ODE? Prints TAP.
program=$1
root=$2
folder=$(mktemp -d)
log=$folder/log
trap 'rm -rf "$folder"' EXIT
cd "$root" || exit 1
. tests/support/tap.sh
cd "$folder" || exit 1

# six pins on a circle, the first hole 10 um off, under a weight, and pressed by a torque
{
    echo "title: Six pins under a weight"
    echo "bodies:"
    echo "  plate: {mass: 2 kg, inertia: 400 kg mm^2, at: [0 mm, 0 mm]}"
    echo "joints:"
    awk 'BEGIN {
        for (i = 0; i < 6; i++) {
            angle = 1.0471975511965976 * i
            x = 20 * cos(angle)
            y = 20 * sin(angle)
            printf "  pin-%d: {between: [ground, plate], at-a: [%.12f mm, %.12f mm],\n", i + 1,
                x + (i == 0 ? 0.01 : 0), y
            printf "          at-b: [%.12f mm, %.12f mm], hole: 10.04 mm, pin: 10 mm, width: 8 mm}\n",
                x, y
        }
    }'
    echo "contact: {stiffness: 1e8 N/m, restitution: 0.5}"
    echo "run: {duration: 4 ms, samples: 100}"
    echo "expect: {joints.pin-1.impacts: above 0}"
} >pattern.yaml
sed 's/^contact: .*/contact: {stiffness: 1e8 N\/m, damping: viscous, viscous-coefficient: 5e3 N s\/m}/' \
    pattern.yaml >pressed.yaml
echo "loads: {twist: {body: plate, torque: 180 N m}}" >>pressed.yaml
cat >study.yaml <<'EOF'
title: How far a hole may be off
case: pattern.yaml
vary: {joints.pin-1.at-a: [["20 mm", "0 mm"], ["20.01 mm", "0 mm"]]}
EOF

ends() {
    title=$1
    shift
    "$program" "$@" >"$log" 2>&1
    report "$title" $?
}

echo "1..25"
ends "run" run pattern.yaml --plot pattern.svg --series pattern.csv --full
for way in plain/textbook plain/corrected plain/exact staggered/textbook staggered/midpoint \
    staggered/impulse; do
    ends "run by $way" run -q pattern.yaml --step "1 us" --set "ode.stepping=${way%/*}" \
        --set "ode.map=${way#*/}"
done
for collider in staves staves-gjk ode-convex trimesh; do
    ends "run with $collider" run -q pressed.yaml --step "5 us" --set "ode.collider=$collider" \
        --set contact.stiffness=1e7N/m
done
ends "run with the quick solver" run -q pattern.yaml --step "1 us" --set ode.solver=quick
ends "run in space" run -q pattern.yaml --set space=spatial --set "bodies.plate.offset=2 mm"
ends "compare" compare -q pattern.yaml --steps "10 us, 5 us" --schemes direct/staggered
ends "check" check -q --expect-only pattern.yaml
ends "map" map -q pattern.yaml --full
ends "tune, as a program" tune -q pattern.yaml --at-step "20 us" --error 0.1 \
    --schemes staggered/impulse --code pattern.c
ends "tune, for MuJoCo and Gazebo" tune -q pressed.yaml --error 0.1 --schemes staggered/impulse \
    --mjcf pattern.xml --sdf pattern.sdf
ends "study" study -q study.yaml
ends "report" report -q pattern.yaml --out pattern.html
"$program" run -q pattern.yaml >"$log" 2>&1
tr -s '\n ' ' ' <"$log" | grep -q "The 6 pins between ground and plate bear 10.5 N to 201 N at most each; the most loaded 1.9 times their mean"
report "run says how they share the load" $?
"$program" map -q pattern.yaml >"$log" 2>&1
tr -s '\n ' ' ' <"$log" | grep -q "the 6 between ground and plate, pressed together, swing up to 2.4 times"
report "map says how they swing together" $?
# the control: pins between different bodies share nothing
"$program" run -q "$root/cases/literature/three-clearances.yaml" >"$log" 2>&1
! grep -q "pins between" "$log"
report "pins of different bodies share nothing" $?
grep -q "hole\[0\] = 0.02001;" pattern.c && grep -q "pin\[0\] = 0.02;" pattern.c
report "the program of tune has both places" $?
# the control: a hole that is off by more than the play is refused
"$program" run -q pattern.yaml --set "joints.pin-1.at-a=[20.03 mm, 0 mm]" >"$log" 2>&1
test $? -eq 2 && grep -q "inside the metal" "$log"
report "a hole that is off by more than the play is refused" $?
