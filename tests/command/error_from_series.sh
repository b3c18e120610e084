#!/bin/sh
# Are the errors that a run prints those of its series? That of motion is recomputed by ten lines of
# Python from the columns of two series, those of forces and peaks by some more from these and the
# contacts, for seeded random cases and two in space; a changed column must be seen.
# Prints TAP. Called with the program, random_case, error_from_series.py and forces_from_series.py.
set -u
export MALLOC_PERTURB_=0 # see tests/support/program.h
jointplay=$(realpath "$1")
random_case=$(realpath "$2")
recompute=$(realpath "$3")
recompute_forces=$(realpath "$4")
randoms="four-bar:1 four-bar:2 four-bar:3 bodies:1 bodies:4 bodies:5 sliders:1 sliders:3 sliders:4 limits:1
    limits:2 limits:6 limits:8 sprung:2 sprung:3 sprung:4 balls:1 pendula:1 pendula:3 four-bars:1"
spatial="overhung-pin bennett"
python=${JOINTPLAY_PYTHON:-python3}
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
    "$python" - "$recompute" <<'END'
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

# Whether those of forces and peaks are, of a case in which a joint has play.
forces_agree() {
    "$python" - "$recompute_forces" <<'END'
import contextlib, io, json, math, runpy, sys
error = json.load(open("run.json"))["runs"][1]["error"]
if error["force_max"] is None:
    sys.exit(0)
sys.argv = [sys.argv[1], "run.json", "s-ode.csv", "s-reference.csv", str(error["horizon_s"] or math.inf)]
with contextlib.redirect_stdout(io.StringIO()) as words:
    runpy.run_path(sys.argv[0])
found = [float(x) for x in words.getvalue().split()]
keys = ["force_max", "force_max_in_horizon", "peak_force_max", "peak_force_max_in_horizon", "peak_alpha_max"]
# of bodies at rest the program measures rounding in its floor
near = lambda key, a: abs(a - (error[key] or 0)) <= 1e-12 * a + (1e-6 if key == "peak_alpha_max" and a == 0 else 1e-15)
wrong = [(key, a, error[key]) for key, a in zip(keys, found, strict=True) if not near(key, a)]
sys.exit(str(wrong) if wrong else 0)
END
}

check_case() {
    "$jointplay" run case.yaml --set "$2" --set run.backends='[reference, ode]' --set run.tolerance=1e-3 --set run.step=auto --json -q \
        --series s.csv >run.json 2>words && agrees && forces_agree 2>words
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
"$python" -c 'import csv
rows = list(csv.DictReader(open("s-reference.csv")))
column = [c for c in rows[0] if c.endswith("_omega_rad_s")][1]
out = csv.DictWriter(open("s-reference.csv", "w"), rows[0])
out.writeheader()
out.writerows({**row, column: 2 * float(row[column])} for row in rows)'
! agrees
report $? "a changed column is seen"
# and one force of the reference's in a joint with play
cp "$JOINTPLAY_CASES/paper/impact-k66.yaml" case.yaml
check_case impact-k66 run.revolutions=0.05
"$python" -c 'import csv
rows = list(csv.DictReader(open("s-reference.csv")))
largest = max(rows, key=lambda row: float(row["crank-coupler_force_N"]))
largest["crank-coupler_force_N"] = 1.001 * float(largest["crank-coupler_force_N"])
out = csv.DictWriter(open("s-reference.csv", "w"), rows[0])
out.writeheader()
out.writerows(rows)'
! forces_agree 2>words
report $? "a changed force is seen"
# the contacts of the reference with one peak changed
"$jointplay" run case.yaml --set run.revolutions=0.05 --set run.backends='[reference, ode]' --json -q --series s.csv >run.json
"$python" -c 'import json
runs = json.load(open("run.json"))
runs["runs"][0]["joints"]["crank-coupler"]["spikes"][0]["force_max_N"] *= 1.5
json.dump(runs, open("run.json", "w"))'
! forces_agree 2>words
report $? "a changed peak is seen"
echo "1..$number"
