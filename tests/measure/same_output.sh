#!/bin/sh
# Does a change of the structure leave what other programs read as it was? Runs two builds of the
# program with the same commands on all cases, and compares JSON, CSV, generated files and exit
# statuses byte by byte. Times, and what follows from them, are left out; so are words for people.
#
# tests/measure/same_output.sh OLD NEW [CASES]
#   OLD, NEW  two programs, such as build/src/cli/jointplay; NEW's build has its tests
#   CASES     the folder of the cases (default: this project's), with tests/ and results/ beside it
# Prints what differs and ends with status 1 where anything does. Some minutes.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
old=$(realpath "$1")
new=$(realpath "$2")
cases=$(realpath "${3:-$root/cases}")
project=$(dirname "$cases")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bad=$work/bad
mkdir "$bad"
(cd "$project" && "$(dirname "$new")/../../tests/unit/test_bad_cases" --files "$bad") || exit 2

# Runs a command and keeps its standard output and exit status under a name.
keep() {
    kept=$1
    shift
    "$@" >"$kept" 2>/dev/null
    echo "$kept $?" >>status
}

# A small study: numbers and words that vary, a draw, and truths.
write_study() {
    cat >small.yaml <<END
title: small
case: $cases/paper/impact-k66.yaml
set: {run.revolutions: 0.1}
vary:
  run.step: [20 us, 10 us]
  contact.damping: [lankarani-nikravesh, flores]
draw:
  count: 2
  keys:
    contact.restitution: {uniform: [0.8, 0.9]}
END
}

# Every command that other programs read, with the program $1, in the working folder.
run_all() {
    program=$1
    for case in "$cases"/paper/*.yaml "$cases"/literature/*.yaml; do
        name=$(basename "$case" .yaml)
        keep "run-$name.json" "$program" run --quiet --json --out=. "$case"
        keep "map-$name.json" "$program" map --quiet --json --csv="map-$name.csv" "$case"
        keep "map-$name.txt" "$program" map --quiet --wide --csv=- "$case"
        keep "check-$name.json" "$program" check --quick --quiet --json \
            --baselines="$project/results/baseline" --junit="check-$name.xml" "$case"
    done
    case=$cases/paper/impact-k66.yaml
    keep compare.json "$program" compare --quiet --json --fresh --store=journal.jsonl \
        --steps='30 us, 10 us' --csv=compare.csv "$case"
    keep tune.json "$program" tune --quiet --json --jobs=1 --cost=steps --error=1e-2 --sdf=tune.sdf \
        --mjcf=tune.mjcf "$case"
    keep tune-held.json "$program" tune --quiet --json --jobs=1 --cost=steps --at-step='1 ms' "$case"
    keep map-lone.json "$program" map --quiet --json --stiffness='1e9 N/m^1.5' --mass='1 kg' \
        --step='1 ms'
    keep map-inverse.json "$program" map --quiet --json --erp=0.2 --cfm=1e-5 --step='1 ms'
    keep map-laws.json "$program" map --quiet --json --laws=all --steps='10 us' "$case"
    keep map-penalty.json "$program" map --quiet --json --penalty --steps='10 us' "$case"
    keep paper.json "$program" paper --quiet --json
    keep auto.json "$program" run --quiet --json --step=auto --backend=ode "$case"
    write_study
    keep dry.json "$program" study --quiet --dry-run --json small.yaml
    keep study.json "$program" study --quiet --json --jobs=1 small.yaml
    keep study.csv "$program" study export small.sqlite
    keep study.jsonl "$program" study export small.sqlite --jsonl=-
    for wrong in "$bad"/*.yaml; do
        keep /dev/null "$program" run --quiet "$wrong"
        sed -i "\$s|.*|$(basename "$wrong") $(tail -n 1 status | sed 's/.* //')|" status
    done
}

# Takes out times, what follows from them, and the version.
strip() {
    for file in *.json *.jsonl; do
        sed -i -E '/"wall[a-z_]*": \[$/,/\]/d
            /"cheapest": \[$/,/^  \]/d
            /"(wall[a-z_]*|processor[a-z_]*|inside[a-z_]*|[a-z_]*cpu_s|us_per_step|real_time_factor|on_frontier|version)": ?[^[]*$/d
            s/"(wall[a-z_]*|processor[a-z_]*|us_per_step|real_time_factor)": ?[^,}]*,?//g' "$file"
    done
    for file in compare.csv study.csv; do
        awk -F, -v OFS=, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /wall|us_per_step|real_time|frontier/) drop[i] = 1 }
            { for (i = 1; i <= NF; i++) if (i in drop) $i = "" } 1' "$file" >stripped
        mv stripped "$file"
    done
    sed -i -E 's/ time="[^"]*"//' ./*.xml
    rm -f journal.jsonl small.sqlite ./*.svg ./*.txt
}

for side in old new; do
    mkdir "$work/$side"
    cd "$work/$side" || exit 2
    if [ "$side" = old ]; then run_all "$old"; else run_all "$new"; fi
    strip
done
cd "$work" || exit 2
echo "$(find old -type f | wc -l) files, $(wc -l <old/status) commands"
if diff -r old new; then
    echo "the same"
else
    exit 1
fi
