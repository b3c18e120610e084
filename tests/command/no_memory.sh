#!/bin/sh
# Is a program without memory never taken for one that is done? Memory is refused from the N-th piece on,
# for N from 1 until three have done without more: the status is 4, with one sentence, or nothing is
# missing. The control is that more than ten runs end so.
# Usage: no_memory.sh PROGRAM LIBRARY CASES TAP. Prints TAP.
set -u
program=$1
library=$2
cases=$3
. "$4"
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
log=$work/log

cat >pin.yaml <<'CASE'
bodies:
  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}
joints:
  hole: {between: [ground, pin], at: [0 mm, 0 mm], radial-clearance: 0.1 mm, pin: 10 mm, width: 15 mm}
contact: {stiffness: 6.6e10 N/m^1.5, restitution: 0.9}
run: {duration: 6 ms, samples: 20, step: 50 us, backends: [reference, ode]}
CASE

# Whether a command that ended with a status is done or says what it lacks.
is_right() {
    case $1 in
    0) [ "$(wc -l <out)" = "$(wc -l <whole)" ] ;;
    4) [ "$(grep -c '^jointplay: ' errors)" = 1 ] && grep -q memory errors ;;
    *) false ;;
    esac
}

# A command with its words, for pieces that grow by two thirds each.
starve() {
    "$program" "$@" >whole 2>errors || return 1
    refused=0
    n=1
    status=4
    : >"$log"
    done=0
    while [ "$done" -lt 3 ]; do
        FAILING_MEMORY=$n LD_PRELOAD=$library "$program" "$@" >out 2>errors
        status=$?
        is_right "$status" || { echo "$*, from $n on: $status" && cat errors; } >>"$log"
        done=$((status == 0 ? done + 1 : 0))
        [ "$status" = 4 ] && refused=$((refused + 1))
        n=$((n + 1 + 2 * n / 3))
    done
    ls | grep -F .part- >>"$log"
    [ ! -s "$log" ] && [ "$refused" -gt 10 ]
}

starve run pin.yaml --plot pin.svg --series pin.csv
report "run" $?
starve paper
report "paper" $?
starve map pin.yaml --steps "30 us" --set run.samples=2
report "map" $?
starve compare pin.yaml --fresh --steps "50 us" --schemes direct/plain
report "compare" $?

# the limit of a shell, by which memory lacks where it is large
(ulimit -v 1000000 && "$program" run "$cases/paper/impact-k66.yaml" --set run.samples=10000000) >out 2>"$log"
[ $? = 4 ] && grep -q 'there is no memory for this' "$log"
report "samples for which there is no room" $?
echo "1..$number"
