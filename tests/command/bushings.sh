#!/bin/sh
# Does every command take a case with bushings, and is the program that tune writes as right as it
# says? Prints TAP. Called with the program, program_error and the library's folder.
program=$(realpath "$1")
program_error=$(realpath "$2")
library=$(realpath "$3")
root=$4
cc=${JOINTPLAY_CC:-cc}
folder=$(mktemp -d)
log=$folder/log
trap 'rm -rf "$folder"' EXIT
cd "$root" || exit 1
. tests/support/tap.sh
cd "$folder" || exit 1

cat >soft.yaml <<'END'
title: An arm and a tip on bushings
bodies:
  arm: {mass: 1 kg, inertia: 0.02 kg m^2, at: [0.2 m, 0 m]}
  tip: {mass: 0.5 kg, inertia: 0.01 kg m^2, at: [0.4 m, -0.2 m], angle: -90 deg}
joints:
  root: {between: [ground, arm], at: [0 m, 0 m]}
bushings:
  knee: {between: [arm, tip], at-a: [0.4 m, 0 m], at-b: [0.401 m, 0.001 m], angle: -85 deg,
         damping: [10 N s/m, 20 N s/m], torsional-stiffness: 2 N m/rad,
         force-x: [[-5 mm, -30 N], [0 mm, 0 N], [5 mm, 10 N]],
         force-y: [[-5 mm, -10 N], [0 mm, 0 N], [5 mm, 40 N]]}
  foot: {between: [tip, ground], at: [0.4 m, -0.4 m], stiffness: [2e3 N/m, 4e3 N/m],
         damping: 5 N s/m, direction: 10 deg}
run: {duration: 100 ms, samples: 100}
expect: {bodies.arm.omega_max: above 0 rad/s}
END
cat >study.yaml <<'END'
title: How soft a bushing may be
case: soft.yaml
vary: {bushings.foot.stiffness: [1e3 N/m, 2e3 N/m]}
END

ends() {
    title=$1
    shift
    "$program" "$@" >"$log" 2>&1
    report "$title" $?
}

# Builds a program, and its error against the reference.
error_of() {
    $cc -O1 -Wall -Wextra -Werror -o world "$1" -I"$root/include" \
        $(pkg-config --cflags --libs ode) -L"$library" -ljointplay -lm &&
        LD_LIBRARY_PATH=$library ./world >series.csv 2>words &&
        "$program_error" soft.yaml series.csv inf "run.duration=100 ms" | cut -d' ' -f1
}

echo "1..15"
ends "run" run soft.yaml --plot soft.svg --series soft.csv --full
grep -q "bushings    knee: force by 6 points, 2 N m/rad; damping 10 and 20 N s/m" "$log"
report "run says what it is" $?
"$program" run -q soft.yaml --json >run.json 2>"$log"
grep -q '"deflection_max_m"' run.json
report "JSON has its largest force and deflection" $?
for way in plain staggered extrapolated; do
    ends "run by $way" run -q soft.yaml --step "50 us" --set "ode.stepping=$way"
done
ends "compare" compare -q soft.yaml --steps "100 us, 50 us" --schemes direct/staggered
ends "check" check -q --expect-only soft.yaml
ends "study" study -q study.yaml
ends "report" report -q soft.yaml --out soft.html
ends "tune, as a program" tune -q soft.yaml --error 1e-4 --cost steps \
    --schemes direct/staggered --code soft.c
error=$(error_of soft.c)
awk "BEGIN { exit !(\"$error\" != \"\" && $error + 0 <= 1e-4) }"
report "the program holds the error: $error" $?
# the control: without the foot's damper it is another mechanism
sed 's/\.damping = {5, 5}/.damping = {0, 0}/' soft.c >wrong.c
error=$(error_of wrong.c)
awk "BEGIN { exit !(\"$error\" != \"\" && $error + 0 > 1e-3) }"
report "another damping is caught: $error" $?
"$program" tune -q soft.yaml --error 1e-4 --code smooth.c \
    --set bushings.knee.interpolation=smooth >"$log" 2>&1
test $? -eq 2 && grep -q "the program has no bushing with a smooth curve" "$log"
report "a smooth curve is refused by name" $?
"$program" run -q soft.yaml --set space=spatial >"$log" 2>&1
test $? -eq 3 && grep -q "bushings are not available in space" "$log"
report "space is refused by name" $?
