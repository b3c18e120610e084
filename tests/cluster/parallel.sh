#!/bin/bash
# Does GNU parallel make a study with the flags that Slurm is given? Prints TAP. Arguments: the
# program, the folder of cases.
set -u
program=$(realpath "$1")
cases=$2
# shellcheck source=tests/cluster/rows.sh
. "$(dirname "$0")/rows.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

cat >"speeds.yaml" <<STUDY
title: Three speeds, two steps, four lengths
case: "$cases/paper/ideal-nominal.yaml"
vary:
  drive.speed: [300 rpm, 600 rpm, 900 rpm]
  run.step: [100 us, 50 us]
draw:
  count: 4
  seed: 1
  keys:
    four-bar.coupler.length: {uniform: [278.9 mm, 279.9 mm]}
STUDY

"$program" study speeds.yaml --store whole.sqlite --quiet >/dev/null
parallel --will-cite -j2 "$program" study speeds.yaml --shard {}/4 --jobs 1 --quiet ::: 1 2 3 4 \
    >/dev/null
made=$?
"$program" study merge speeds.yaml >/dev/null 2>&1
merged=$?
study_rows "$program" whole.sqlite >whole.csv
study_rows "$program" speeds.sqlite >merged.csv
study_rows "$program" speeds.1-of-4.sqlite >part.csv

number=0
check() {
    local sentence=$1
    shift
    number=$((number + 1))
    if "$@"; then echo "ok $number - $sentence"; else echo "not ok $number - $sentence"; fi
}

echo 1..5
check "every shard ends well" [ $made = 0 ]
check "the shards merge" [ $merged = 0 ]
check "the whole has a row a run below its heading" [ "$(wc -l <whole.csv)" = 25 ]
check "the shards gathered equal the whole, row for row" cmp whole.csv merged.csv
check "one of them alone does not" eval '! cmp -s whole.csv part.csv'
