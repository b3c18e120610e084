#!/usr/bin/env bash
# Is the first screen of `run` a screen, whatever the case? Of every case in cases/ and of random
# ones: at most 24 lines of 80 columns, and no number that is none.
#
#     tests/measure/screens.sh PROGRAM RANDOM_CASE [SEEDS]
#
# PROGRAM and RANDOM_CASE are build/src/cli/jointplay and build/tests/measure/random_case. Prints
# each screen that is not; exit status 1 where there is one.
set -u
program=$1
random_case=$2
seeds=${3:-6}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
looked=0
wrong=0

look() {
    timeout 60 "$program" run "$1" --quiet --set run.samples=90 >"$work/screen" 2>/dev/null
    [ -s "$work/screen" ] || return # refused
    looked=$((looked + 1))
    # the empty line behind a case is none of its lines, and a path is as long as it is
    awk -v name="$1" '
        !/^  case  / && length($0) > 80 { print name ": " length($0) " columns: " $0; bad = 1 }
        /(^|[ ,;(])-?nan([ ,;.)]|$)|\(null\)|(^|[ ,;(])-?inf([ ,;.)]|$)/ { print name ": " $0; bad = 1 }
        $0 != "" { last = NR }
        END { if (last > 24) { print name ": " last " lines"; bad = 1 } exit bad }
    ' "$work/screen" || wrong=$((wrong + 1))
}

for case in cases/*/*.yaml; do
    case $case in cases/studies/*) ;; *) look "$case" ;; esac
done
for kind in four-bar bodies sliders limits space; do
    for seed in $(seq 1 "$seeds"); do
        "$random_case" "$kind" "$seed" >"$work/$kind-$seed.yaml" && look "$work/$kind-$seed.yaml"
    done
done
echo "$looked screens, $wrong of them wrong"
[ "$wrong" = 0 ]
