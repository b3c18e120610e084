#!/bin/sh
# Is the error that a run prints that of its series? It is recomputed by ten lines of Python from the
# columns of two series, for seeded random cases and two in space; a changed column must be seen.
# Prints TAP. Called with the program, random_case and error_from_series.py.
set -u
export MALLOC_PERTURB_=0 # see tests/support/program.h
jointplay=$(realpath "$1")
random_case=$(realpath "$2")
recompute=$(realpath "$3")
randoms="four-bar:1 four-bar:2 four-bar:3 bodies:1 bodies:4 bodies:5 sliders:1 sliders:3 sliders:4 limits:1
    limits:2 limits:6 limits:8 sprung:2 sprung:3 sprung:4 balls:1 pendula:1 pendula:3 four-bars:1"
spatial="overhung-pin bennett"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
number=0

report() {
    number=$((number + 1))
    if [ "$1" = 0 ]; then echo "ok $number - $2"; else echo "not ok $number - $2"; fi
}

# Whether the errors of run.json, with the scale's least share, are those of the series.
agrees() {
    python3 - "$recompute" <<'END'
import contextlib, io, json, math, runpy, sys
error = json.load(open("run.json"))["runs"][1]["error"]
horizon = str(error["horizon_s"] or math.inf)
sys.argv = [sys.argv[1], "s-ode.csv", "s-reference.csv", horizon, "1e-12"]
with contextlib.redirect_stdout(io.StringIO()) as words:
    runpy.run_path(sys.argv[0])
found = [float(x) for x in words.getvalue().split()]
printed = [error["max"], error["max_in_horizon"]]
# sums of squares may be rounded in another order
sys.exit(any(not abs(a - b) <= 1e-12 * b + 1e-18 for a, b in zip(found, printed, strict=True)))
END
}

check_case() {
    "$jointplay" run case.yaml --set "$2" --set run.tolerance=1e-3 --set run.step=auto --json -q \
        --series s.csv >run.json 2>words && agrees
    report $? "$1: $(tail -n 1 words)"
}

for random in $randoms; do
    "$random_case" "${random%:*}" "${random#*:}" >case.yaml
    length='run.duration=30 ms'
    ! grep -q 'revolutions: ' case.yaml || length=run.revolutions=0.05
    check_case "$random" "$length"
done
for name in $spatial; do
    cp "$JOINTPLAY_CASES/space/$name.yaml" case.yaml
    length='run.duration=10 ms'
    ! grep -q 'revolutions: ' case.yaml || length=run.revolutions=0.1
    check_case "$name" "$length"
done
# the control: one angular velocity of the reference's twice as large
python3 -c 'import csv
rows = list(csv.DictReader(open("s-reference.csv")))
column = [c for c in rows[0] if c.endswith("_omega_rad_s")][1]
out = csv.DictWriter(open("s-reference.csv", "w"), rows[0])
out.writeheader()
out.writerows({**row, column: 2 * float(row[column])} for row in rows)'
! agrees
report $? "a changed column is seen"
echo "1..$number"
