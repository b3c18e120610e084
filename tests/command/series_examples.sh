#!/bin/sh
# Do the examples of docs/output.md for pandas, Octave and gnuplot work as they stand there? Their
# text is taken from the page and run on a series that the page's command writes; what they compute
# must be what the run itself says, to the last bit. Where a program is not here, its example is
# skipped. Prints TAP. Called with the program, the source tree and the page.
set -u
export MALLOC_PERTURB_=0 # see tests/support/program.h
jointplay=$(realpath "$1")
root=$2
page=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
log=$work/log
. "$root/tests/support/tap.sh"
skip() {
    number=$((number + 1))
    echo "ok $number - $1 # SKIP $2 is not here"
}

# The example in a language, as the page has it.
example() {
    awk -v start="\`\`\`$1" '$0 == "## Reading a series" { is_here = 1 } /^```$/ { is_in = 0 }
        is_here && is_in { print } $0 == start { is_in = 1 }' "$page"
}

# The command of the page, as it stands there, with JSON to compare with.
command=$(sed -n '/^## Reading a series/,/^## Picture/s/^    jointplay \(run .* --series .*\)/\1/p' "$page")
ln -s "$root/cases" cases
eval "$jointplay $command --quiet --json" >run.json 2>log && [ -s s-analytic.csv ] && [ -s s-ode.csv ]
report "the command of the page writes the series" $?

# The largest force that a run names, with the shortest digits that read back.
python=${JOINTPLAY_PYTHON:-python3}
largest() {
    "$python" -c 'import json, sys
runs = {run["backend"]: run for run in json.load(open("run.json"))["runs"]}
print(runs[sys.argv[1]]["joints"]["crank-coupler"]["force_max_N"])' "$1"
}
force=$(largest reference)

# Whether words have a number that is this one to the last bit, with whatever digits it is written.
has_number() {
    "$python" -c 'import re, sys
words = re.findall(r"-?[0-9.]+(?:e[-+]?[0-9]+)?", open(sys.argv[1]).read())
sys.exit(float(sys.argv[2]) not in [float(word) for word in words if re.search("[0-9]", word)])' "$1" "$2"
}

# The reference's series alone.
one_run() {
    "$jointplay" run cases/paper/stackup-impact.yaml --backend reference --uncertified --series "$1" -q >log 2>&1
}

pandas=
for candidate in "$python" /usr/bin/python3; do
    if [ -z "$pandas" ] && "$candidate" -c 'import pandas, matplotlib' 2>log; then pandas=$candidate; fi
done
export MPLBACKEND=svg MPLCONFIGDIR="$work"
example python >example.py
if [ -n "$pandas" ]; then
    [ -s example.py ] && "$pandas" example.py >said 2>log && has_number said "$force"
    report "the example for pandas prints the run's largest force" $?
    grep -q '<svg' force-pandas.svg
    report "and draws it" $?
    # what the page says of reading the file, and what pandas does by itself
    "$pandas" - >log 2>&1 <<'END'
import pandas as pd
exact = pd.read_csv("s-reference.csv", float_precision="round_trip")
bits = lambda frame: frame.astype("float64").to_numpy().view("int64")
none = exact.isna().to_numpy()
assert all(repr(float(cell)) == repr(value) for cell, value in
           zip(open("s-reference.csv").read().split("\n")[2].split(","), exact.iloc[1]) if cell)
# the control: without the option digits are lost
assert ((bits(pd.read_csv("s-reference.csv")) != bits(exact)) & ~none).any()
END
    report "pandas reads the numbers to the last bit with the option, and does not without" $?
else
    skip "the example for pandas" pandas
fi

example octave >example.m
if command -v octave-cli >/dev/null; then
    [ -s example.m ] && octave-cli -qf example.m >said 2>log && has_number said "$force"
    report "the example for Octave prints the run's largest force" $?
else
    skip "the example for Octave" octave-cli
fi

example gnuplot >example.gp
if command -v gnuplot >/dev/null; then
    [ -s example.gp ] && gnuplot example.gp >said 2>&1 && has_number said "$force"
    report "the example for gnuplot prints the run's largest force" $?
    grep -q '<svg' force-gnuplot.svg
    report "and draws it" $?
else
    skip "the example for gnuplot" gnuplot
fi

# the controls: another backend's force is none of theirs, nor is a neighbour of the last bit
echo "$force N" >said
! has_number said "$(largest ode)" && ! has_number said "$("$python" -c "import math; print(math.nextafter($force, 0.0))")"
report "another number is seen" $?
echo "1..$number"
