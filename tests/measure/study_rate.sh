#!/bin/bash
# How many short runs does a study make per second of processor time? 10,000 runs of 60 steps each, in
# one process that distributes them and one that makes them: values, case, steps, metrics, row. Plain steps
# with ideal joints take 100 more before time zero, in which they settle.
#     usage: study_rate.sh BUILD [RUNS]
set -eu
build=$(cd "${1:?usage: study_rate.sh BUILD [RUNS]}" && pwd)
runs=${2:-10000}
cases=$(cd "$(dirname "$0")/../../cases" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

measure() { # case, scheme, turns, step
    cat >s.yaml <<END
title: Short runs
case: $cases/paper/$1.yaml
set: {run.revolutions: $3, run.samples: 60, run.step: $4}
vary: {scheme: [$2]}
draw: {count: $runs, keys: {drive.speed: {uniform: [990 rpm, 1010 rpm]}}}
truth: false
END
    rm -f s.sqlite
    TIMEFORMAT='%U %S'
    spent=$({ time "$build/src/cli/jointplay" study s.yaml --jobs 1 -q >output; } 2>&1)
    rows=$("$build/src/cli/jointplay" study export s.sqlite | grep -c '^[0-9]')
    echo "$1 $2 $rows $spent" | awk '{ printf "%-16s %-26s %6d runs  %5.2f s  %5.0f runs/s\n", $1, $2, $3, $4 + $5, $3 / ($4 + $5) }'
}

measure ideal-nominal direct/plain 1 '1 ms'
measure impact-k66 direct/plain/textbook 0.1 '100 us'
measure impact-k66 direct/staggered/impulse 0.1 '100 us'
