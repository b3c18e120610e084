#!/usr/bin/env bash
# Is a change that matters seen? Makes one small fault after another in a copy of the sources, builds
# it, and expects `jointplay check --quick` to end with status 1, or 4 where a run does not end any
# more. Prints, for each, which number was furthest off and by how many of its bands. Ends with status
# 1 where a fault was not seen.
#
# tests/measure/sensitivity.sh [FOLDER]    builds in FOLDER, which is kept, or in a temporary one
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
if [ $# -gt 0 ]; then
    mkdir -p "$1"
    work=$(cd "$1" && pwd)
else
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work/tree"
for part in meson.build meson_options.txt README.md CHANGELOG.md LICENSE include src cases results docs tests; do
    cp -r "$root/$part" "$work/tree/"
done
cd "$work/tree" || exit 1
meson setup "$work/build" -Dtests=disabled --buildtype=release >"$work/log" 2>&1 || {
    cat "$work/log"
    exit 1
}
program=$work/build/src/cli/jointplay

build() {
    ninja -C "$work/build" src/cli/jointplay >"$work/log" 2>&1 || {
        echo "not built:"
        tail -n 20 "$work/log"
        exit 1
    }
}

missed=0
number=0

# The worst number of each case that is out, and how many there are.
show() {
    python3 - "$work/out.json" <<'EOF'
import json, sys
report = json.load(open(sys.argv[1]))
rows = [(row, case) for case in report["cases"] for row in case["metrics"]
        if row["verdict"] not in ("within", "left out")]
cases = sum(1 for case in report["cases"] if case["status"] == "out")
failed = [case for case in report["cases"] if case["status"] == "failed"]
if not rows:
    print("    ", failed[0]["message"] if failed else "nothing is out")
    sys.exit()
def weight(pair):
    # settings and changed lists first, then what has a band
    off = pair[0].get("bands_off")
    return off if off is not None else -1.0
worst = max(rows, key=weight)
name = worst[1]["case"].split("/")[-1] + ": " + worst[0]["metric"]
off = worst[0].get("bands_off")
far = "%.3g bands" % off if off is not None else worst[0]["message"]
print("     %d numbers of %d cases; worst: %s, %s" % (len(rows), cases, name, far))
EOF
}

# One check; its status must be one of those that are expected.
expect() {
    local wanted=$1 what=$2
    shift 2
    "$program" check --quick --quiet --json "$@" >"$work/out.json" 2>"$work/errors"
    local status=$?
    number=$((number + 1))
    if [[ " $wanted " == *" $status "* ]]; then
        echo "ok $number - $what"
    else
        echo "not ok $number - $what: status $status, not of $wanted: $(head -n 1 "$work/errors")"
        missed=$((missed + 1))
    fi
    show
}

# A fault: what it is, the file, and the edit. One that changes nothing is no fault.
fault() {
    local what=$1 file=$2 edit=$3
    cp "$file" "$work/kept"
    sed -i "$edit" "$file"
    if cmp -s "$file" "$work/kept"; then
        echo "not applied: $what"
        missed=$((missed + 1))
        return
    fi
    build
    expect "1 4" "$what"
    cp "$work/kept" "$file"
}

build
expect 0 "the sources as they are"

echo "# faults in the sources"
fault "stiffness off by 1 %" src/kernel/force_law.c \
    's/^        \.stiffness = stiffness,/        .stiffness = 1.01 * stiffness,/'
fault "restitution off by 0.01" src/contact/damping.c \
    's/const double e = restitution;/const double e = restitution - 0.01;/'
fault "step 10 % larger" src/ode/plane/plain.c \
    's/plain->step_s = scenario->run\.step;/plain->step_s = 1.1 * scenario->run.step;/'
fault "another map" src/contact/law_row.c \
    's/map_get(ODE_MAP_TEXTBOOK) : map)/map_get(ODE_MAP_TEXTBOOK) : map_get(ODE_MAP_CORRECTED))/'
fault "clearance off by 1 %" src/model/linkage.c \
    's/return joint->clearance.hole_radius - joint->clearance.pin_radius;/return 1.01 * (joint->clearance.hole_radius - joint->clearance.pin_radius);/'
fault "gravity off by 1 in 1000" src/ode/plane/world.c \
    's/dWorldSetGravity(id, scenario->gravity.x, scenario->gravity.y,/dWorldSetGravity(id, scenario->gravity.x, 1.001 * scenario->gravity.y,/'
fault "gravity left out" src/ode/plane/world.c \
    's/dWorldSetGravity(id, scenario->gravity.x, scenario->gravity.y,/dWorldSetGravity(id, 0.0 * scenario->gravity.x, 0.0 * scenario->gravity.y,/'
fault "contact normal turned by 0.1 degree" src/ode/plane/contact_rows.c \
    's/geom\.normal\[0\] = -row->normal\.x;/geom.normal[0] = -row->normal.x + 1.7453e-3 * row->normal.y;/
     s/geom\.normal\[1\] = -row->normal\.y;/geom.normal[1] = -row->normal.y - 1.7453e-3 * row->normal.x;/'
fault "ERP of the joints times .999" src/ode/plane/world.c \
    's/dJointSetBallParam(ball, dParamERP, world_hold_erp(options));/dJointSetBallParam(ball, dParamERP, 0.999 * world_hold_erp(options));/'
fault "ERP of the contacts times .999" src/ode/plane/contact_rows.c \
    's/\.soft_erp = soft\.erp,/.soft_erp = 0.999 * soft.erp,/'
fault "damping factor of Hunt and Crossley in place of Lankarani and Nikravesh" src/model/options.h \
    's/0\.75 \* (1\.0 - e) \* (1\.0 + e))/1.5 * (1.0 - e))/'
fault "one contact in 1000 left out" src/ode/plane/contact_rows.c \
    's/^            make_row(rows, i, step_s);/            static long made;\n            if (++made % 1000 == 0) {\n                rows->rows[i].feedback = (dJointFeedback){0};\n                continue;\n            }\n            make_row(rows, i, step_s);/'
fault "mass of the bodies off by 1 in 100 000" src/ode/plane/world.c \
    's/body->mass/(1.00001 * body->mass)/'
fault "tolerance of the reference a hundred times coarser" src/model/options.c \
    's/\.tolerance = 3e-13,/.tolerance = 3e-11,/'
build

echo "# other settings of the cases"
named="cases/paper/impact-k66.yaml"
for change in "contact.stiffness=6.666e10 N/m^1.5" "contact.restitution=0.91" "run.step=1.1 us" \
    "ode.map=corrected" "joints.crank-coupler.radial-clearance=14.645 um" "gravity=0 m/s^2" \
    "ode.erp=0.1998" "contact.damping=hunt-crossley"; do
    expect 1 "$change" $named --set "$change"
done

echo "$((number - missed)) seen, $missed missed"
[ "$missed" = 0 ]
