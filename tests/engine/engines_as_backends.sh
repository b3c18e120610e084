#!/bin/sh
# Do run, study and check take another engine as a backend like ODE, and is one that is missing or
# misbehaves a failed run with its reason? The engine is tests/engine/toy_driver.py, whose order and
# faults are known; the truth is the closed form. Prints TAP.
#     engines_as_backends.sh PROGRAM PYTHON
set -u
program=$1
python=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. "$(dirname "$0")/../support/tap.sh"
toy=toy=$JOINTPLAY_TOY_DRIVER
case=$work/case.yaml
cp "$JOINTPLAY_CASES/paper/ideal-nominal.yaml" "$case"
cd "$work" || exit 1
export JOINTPLAY_DRIVERS="$work/none"

run() {
    "$program" run "$case" --set run.samples=30 -q "$@" >out 2>"$log"
}

# Whether Python finds an expression over the result true.
holds() {
    "$python" -c "
import json, sys
r = json.load(open('out'))
runs = {x['backend']: x for x in r['runs']}
sys.exit(0 if $1 else 1)" 2>>"$log"
}

run --driver "$toy" --backend analytic,toy --step 200us --json &&
    holds "runs['driver']['status'] == 'ok' and 0 < runs['driver']['error']['omega_max'] < .1"
report "a driver's run is held against the closed form" $?
holds "runs['driver']['engine'] == {'name': 'Toy', 'version': '1.0', 'precision': 'double', 'way': 'euler', 'settings': 'none'} and runs['analytic']['engine'] is None"
report "its result names engine, version, precision and way" $?
coarse=$("$python" -c "import json; print(json.load(open('out'))['runs'][1]['error']['omega_max'])")
run --driver "$toy" --backend analytic,toy --step 40us --json &&
    holds "4.5 < $coarse / runs['driver']['error']['omega_max'] < 5.5"
report "at a fifth of the step its error is a fifth" $?
holds "runs['driver']['joints']['ground-crank']['force_max_N'] is None and runs['driver']['energy']['drive_work_J'] is None"
report "what it does not tell is null, and no number" $?

# means over a degree differ from the closed form's by (pi/180)^2/24 of the fourth derivative, and
# Euler's angles by a thousandth
JOINTPLAY_TOY_RECORDS=whole run --driver "$toy" --backend analytic,toy --step 40us --json \
    --set run.samples=360 &&
    holds "abs(runs['driver']['bodies']['follower']['alpha_max_rad_s2'] / runs['analytic']['bodies']['follower']['alpha_max_rad_s2'] - 1) < .01"
report "accelerations are those of the steps that it tells of" $?
for fault in gap few cut; do
    JOINTPLAY_TOY_RECORDS=$fault run --driver "$toy" --backend analytic,toy --step 200us
    [ $? = 4 ] && grep -q 'driver: toy euler.*its\|driver: its step' "$log"
    report "steps that do not follow each other ($fault) are a failed run" $?
done

run --driver "$toy" --backend analytic,toy --set run.step=auto --set run.tolerance=5e-2 --json &&
    holds "runs['driver']['error']['max'] <= 5e-2 and runs['driver']['step_s'] > 1e-5"
report "its step can be chosen for an error" $?

run --driver "$toy" --backend reference,toy --step 200us --json &&
    holds "runs['driver']['error']['against'] == 'analytic'"
report "the truth of a run need not be among its backends" $?

for fault in abort starts-over failed nan; do
    JOINTPLAY_TOY_FAULT=$fault run --driver "$toy" --backend analytic,toy --step 200us
    [ $? = 4 ] && grep -q 'on driver: toy euler: ' "$log" && grep -q 'driver FAILED' out
    report "a driver with the fault '$fault' is a failed run: exit status 4" $?
done
for fault in hang stops; do
    JOINTPLAY_TOY_FAULT=$fault run --driver "$toy" --backend analytic,toy --step 200us --time-limit 2s
    [ $? = 4 ] && grep -q 'on driver: toy euler: took longer than its limit of 2 s' "$log"
    report "a driver with the fault '$fault' is a failed run once its time is up" $?
done
JOINTPLAY_TOY_FAULT=hang "$program" report "$case" --set run.samples=30 -q --driver "$toy" \
    --backend analytic,toy --step 200us --time-limit 2s -o hung.html 2>"$log"
[ $? = 4 ] && grep -q 'on driver: toy euler: took longer than its limit of 2 s' "$log"
report "in a report as well" $?
run --backend analytic,mujoco --step 200us
[ $? = 4 ] && grep -q "there is no driver for 'mujoco' here" "$log"
report "so is one that is missing" $?
run --driver "mujoco=$JOINTPLAY_TOY_DRIVER" --backend analytic,mujoco --step 200us --json &&
    holds "runs['mujoco']['engine']['name'] == 'Toy'"
report "--driver names another program for an engine" $?
run --driver "mujoco=$JOINTPLAY_TOY_DRIVER" --backend mujoco --step 200us --set engines.mujoco=kernel
[ $? = 4 ] && grep -q "the driver 'mujoco' has no way 'kernel'" "$log"
report "a way that it has not is a failed run" $?

# finding a start would take minutes here, and show its progress
refused() {
    timeout 30 "$program" "$@" --driver "$toy" --set 'run.settle-budget=900 s' \
        --set run.settle-least=1000000 >out 2>"$log"
    [ $? = 3 ] && ! grep -q settling "$log" && [ ! -s out ] && grep -q \
        "toy.* cannot run this case: its driver does not take the pin-in-hole 'crank-coupler'" "$log"
}
play=$JOINTPLAY_CASES/paper/impact-k66.yaml
refused run "$play" --backend ode,toy && refused report "$play" --backend ode,toy -o page.html &&
    [ ! -e page.html ]
report "what a driver does not take is said before a start is looked for and others run" $?
refused compare "$play" && refused tune "$play" --backend toy --error 1e-2
report "before a comparison and a search, too" $?

run --driver "$toy"
[ $? = 2 ] && grep -q "is not used: 'toy' is not among the backends" "$log"
report "a driver that nothing asks for is refused" $?
run --driver "ode=$JOINTPLAY_TOY_DRIVER"
[ $? = 2 ] && grep -q "none of our own backends" "$log"
report "so is one in the place of our own" $?

"$program" tune "$case" --driver "$toy" --backend toy --error 1e-5 --json -q --set run.samples=30 \
    >out 2>"$log"
"$python" -c "
import json, sys
r = json.load(open('out'))
best = r['cheapest']
tried = [t for t in r['trials'] if t['scheme'] == best['scheme']]
# the coarsest that holds, of the method of order 2: the other takes longer for less
sys.exit(0 if best['scheme'] == 'toy/midpoint' and best['error_max'] <= 1e-5 and
         best['step_s'] == min(t['step_s'] for t in tried) and
         all(t['error_max'] > 1e-5 for t in tried if t['step_s'] > best['step_s']) else 1)" 2>>"$log"
report "tune finds the cheapest way and step of an engine" $?
"$program" tune "$case" --driver "$toy" --backend toy/leapfrog --error 1e-2 -q >out 2>"$log"
[ $? = 2 ] && grep -q "cannot run a case the way 'leapfrog'" "$log"
report "and refuses a way that it has not" $?
"$program" tune "$case" --driver "$toy" --backend toy --error 1e-2 --code x.c -q >out 2>"$log"
[ $? = 2 ] && grep -q 'with --backend tune searches' "$log"
report "and a program of it" $?

cat >study.yaml <<STUDY
case: case.yaml
set: {run.samples: 30, run.step: 200 us}
vary:
  scheme: [driver, driver/kernel]
STUDY
"$program" study study.yaml --driver "$toy" -q --store s.sqlite >out 2>"$log"
"$program" study export s.sqlite >rows 2>>"$log"
grep -q '^0,driver,ok,' rows && grep -q "^1,driver/kernel,failed,the driver 'toy' has no way 'kernel'" rows
report "a study has an engine's runs, and those that fail with their reasons" $?

sed -i 's|^run:.*|run: {revolutions: 1, samples: 30, step: 200 us, backends: [analytic, driver]}|' case.yaml
sed -i '/^ode:/d' case.yaml
cat >>case.yaml <<EXPECT
expect:
  driver.error.omega_max: below 1.8e-2
EXPECT
"$program" check case.yaml --driver "$toy" -q >out 2>"$log"
report "check judges an engine's run by the case's limits" $?
JOINTPLAY_TOY_FAULT=drive "$program" check case.yaml --driver "$toy" -q >out 2>"$log"
[ $? = 4 ]
report "and fails where the run does" $?
"$program" check case.yaml --driver "$toy" -q --set run.step=400us >out 2>"$log"
[ $? = 1 ] && grep -q 'driver.error.omega_max is' "$log"
report "a coarser step is outside of them" $?
"$program" --version | grep -q 'drivers of other engines: none'
report "--version says what there is" $?
echo 1..$number
