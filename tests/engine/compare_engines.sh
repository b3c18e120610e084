#!/bin/sh
# Does compare take other engines beside ODE, into its tables, picture and JSON, and keep their runs?
# The engine is tests/engine/toy_driver.py. Prints TAP.
#     compare_engines.sh PROGRAM PYTHON
set -u
program=$1
python=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. "$(dirname "$0")/../support/tap.sh"
case=$JOINTPLAY_CASES/paper/ideal-nominal.yaml
toy=toy=$JOINTPLAY_TOY_DRIVER
set -- "$case" --steps '200 us, 100 us, 50 us' --set run.samples=30 --schemes direct/staggered -q

compare() {
    "$program" compare "$@" --store "$work/store.jsonl" >"$work/out" 2>"$log"
}

# Whether Python finds an expression over the result true.
holds() {
    "$python" -c "
import json, sys
r = json.load(open('$work/out'))
schemes = {s['scheme']: s for s in r['schemes']}
errors = {n: [p.get('error_max') for p in s['points']] for n, s in schemes.items()}
sys.exit(0 if $1 else 1)" 2>>"$log"
}

echo 1..15
compare "$@" --driver "$toy" --json
report "a driver is compared beside ODE" $?
holds "schemes['toy/midpoint']['backend'] == 'toy' and schemes['toy/midpoint']['way'] == 'midpoint'"
report "its ways are schemes of their own" $?
holds "abs(schemes['toy/midpoint']['order']['order'] - 2) < .1 and abs(schemes['toy/euler']['order']['order'] - 1) < .1"
report "with their orders" $?
holds "r['engines'] == [{'name': 'toy', 'program': '$JOINTPLAY_TOY_DRIVER', 'engine': 'Toy', 'version': '1.0', 'precision': 'double', 'ways': ['euler', 'midpoint']}]"
report "engine, version and precision are in the result" $?
holds "[c['scheme'] for c in r['cheapest_of_backends'] if c['backend'] == 'toy' and c['error_at_most'] == 1e-3] == ['toy/midpoint']"
report "and the cheapest way of each backend" $?
holds "len([c for c in r['cheapest_of_backends']]) == 10 and max(len(p['wall_s']) for p in schemes['toy/midpoint']['points']) == 5"
report "at five errors, from five timing runs" $?

cp "$work/out" "$work/first"
cp "$work/out" "$work/result.json"
# the row of the toy has no way to the least errors, and midpoint to the others
"$program" report "$work/result.json" -o "$work/page.html" -q 2>>"$log" &&
    grep -q 'The cheapest way of each engine' "$work/page.html" &&
    grep -A 6 '<th scope="row">toy</th>' "$work/page.html" | grep -q '<td>[0-9.]* [a-z]*: midpoint, ' &&
    grep -q '<td>none</td>' "$work/page.html" && grep -q '>Error against wall time<' "$work/page.html" &&
    ! grep -q 'The cheapest setting of ODE' "$work/page.html"
report "the report has the cheapest way of each engine, and the engine" $?
JOINTPLAY_TOY_FAULT=exit compare "$@" --driver "$toy" --json; status=$?
[ "$status" = 4 ] && grep -q "the driver 'toy'" "$log" || [ "$status" = 0 ] && cmp -s "$work/out" "$work/first"
report "what was run is kept, and is not run again" $?

compare "$@" --driver "$toy" --backends toy/euler --full --plot "$work/picture.svg"
report "--backends names some of its ways alone" $?
grep -q '^  toy  .*Toy 1.0, in double precision' "$work/out" && ! grep -q 'direct/' "$work/out" &&
    grep -q 'Cheapest way of each backend' "$work/out" &&
    grep -q '^  toy/euler: none' "$work/out"
report "the text names the engine, and no scheme of ODE" $?
grep -q 'toy/euler' "$work/picture.svg"
report "the picture has it" $?

JOINTPLAY_TOY_FAULT=abort compare "$@" --driver "$toy" --backends ode,toy/euler --fresh --full
[ $? = 0 ] && grep -q 'toy/euler, 200 us failed: toy euler: ended by signal 6' "$work/out"
report "a run that aborts has failed, with its reason" $?

! compare "$@" --backends ode,no-such && grep -q "there is no driver for 'no-such' here" "$log"
report "an engine that is not there is refused" $?
! compare "$@" --driver "$toy" --backends toy/leapfrog &&
    grep -q "'toy' cannot run a case the way 'leapfrog'; it has euler, midpoint" "$log"
report "so is a way that it has not" $?
! "$program" compare "$JOINTPLAY_CASES/mechanisms/bouncing-ball.yaml" --driver "$toy" -q 2>"$log" &&
    grep -q "bouncing-ball.yaml: toy cannot run this case: its driver does not take stops (joint '" "$log"
report "and a case that no driver takes" $?
