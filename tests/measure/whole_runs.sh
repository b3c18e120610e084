#!/bin/bash
# How does the time of a whole run grow with the number of bodies? Runs of 50 ms from rest, all joints
# with 50 um of play: s of processor time of the command, reading the case and printing JSON included,
# and the exponent from each N to the next.
#     usage: whole_runs.sh BUILD [BACKEND [SAMPLES [KIND...]]]
set -eu
usage="usage: whole_runs.sh BUILD [BACKEND [SAMPLES [KIND...]]]"
build=${1:?$usage}
backend=${2:-reference}
samples=${3:-10}
shift "$(($# < 3 ? $# : 3))"
[ "$#" -gt 0 ] || set -- pendula separate chain four-bars scissors
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

TIMEFORMAT='%U %S'
for kind in "$@"; do
    echo "$backend, $kind"
    echo "       N    steps  evaluations        s   time^"
    for count in 15 60 240 960; do
        "$build/tests/measure/growing_case" "$kind" "$count" 1 50 >"$work/case.yaml"
        spent=$({ time "$build/src/cli/jointplay" run --uncertified --json --backend "$backend" \
            --set "run.samples=$samples" "$work/case.yaml" >"$work/run.json"; } 2>&1)
        echo "$count $spent $(sed -nE 's/.*"(steps|evaluations)": ([0-9]+),.*/\2/p' "$work/run.json" | head -2 | tr '\n' ' ')"
    done | awk '{
        s = $2 + $3
        exponent = n > 0 ? sprintf("%.2f", log(s / before) / log($1 / n)) : ""
        printf("%8d %8d %12d %8.2f %7s\n", $1, $4, $5, s, exponent)
        n = $1; before = s
    }'
done
