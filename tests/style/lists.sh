#!/bin/sh
# Does a member of a list of alternatives that is forgotten somewhere fail to compile? Adds one to
# each list in a copy of its header, and nothing else, and compiles files that have to know it.
# Prints TAP.
#     lists.sh SOURCE_ROOT GENERATED [FLAG...]    flags: of ODE's headers
set -u
root=$1
generated=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. "$(dirname "$0")/../support/tap.sh"

# Whether a source compiles, with headers of the work folder in place of those of the tree.
compiles() {
    source=$1
    shift
    ${CC:-cc} -std=gnu17 -fsyntax-only -Werror=switch \
        -Werror=implicit-function-declaration -Wmissing-field-initializers \
        -Werror=missing-field-initializers -I"$work/src" -I"$root/src" \
        -I"$root/include" -I"$generated" "$@" "$root/src/$source" 2>"$log"
}

# Adds a line in front of the member of a list that begins so, and asks the sources; the first of
# them also as it is, which is the control.
#     forget NAME HEADER FIRST LINE SOURCE...
forget() {
    name=$1
    header=$2
    first=$3
    line=$4
    shift 4
    rm -rf "$work/src"
    compiles "$1" $flags
    report "$1 compiles" $?
    mkdir -p "$work/src/$(dirname "$header")"
    FIRST=$first LINE=$line awk '
        index($0, ENVIRON["FIRST"]) > 0 && !done {
            print ENVIRON["LINE"] (/\\$|member/ ? " \\" : "")
            done = 1
        }
        { print }
        END { exit !done }' "$root/src/$header" >"$work/src/$header" || exit 1
    for source in "$@"; do
        ! compiles "$source" $flags
        report "$source does not without a new $name" $?
    done
}

flags="$*"
options=model/options.h
forget damping $options 'member(NONE,' 'member(NEW, "new", new_factor)' contact/damping.c \
    world/contact.c commands/tune/tune_program.c
forget law $options 'member(LAW_JOHNSON,' 'member(LAW_NEW, "new", law_new)' world/contact.c
forget map $options 'member(CORRECTED,' 'member(NEW, "new", new_map)' contact/map.c world/mapping.c \
    measure/mapping_contact.c
forget stepping $options 'member(ODE_STAGGERED,' 'member(ODE_NEW, "new", STEPPING_NEW, NULL, true)' \
    measure/chosen_run.c
forget solver $options 'member(ODE_QUICK,' 'member(ODE_NEW, "new")' ode/plane/world.c
forget collider $options 'member(ODE_COLLIDER_STAVES,' \
    'member(ODE_COLLIDER_NEW, "new", collider_new)' contact/facets.c
forget 'kind of joint' model/joint.h 'member(with, JOINT_GUIDE,' \
    'member(with, JOINT_NEW, LINE, DISC, NONE, false, "new")' casefile/joint_kind.c \
    engine/request.c commands/tune/tune_world_lacks.c
forget 'way to hold' model/joint.h '    JOINT_HOLDS_LINE,' 'JOINT_HOLDS_NEW,' model/joint_rows.c \
    model/response_rows.c
forget 'way to touch' model/joint.h '    JOINT_TOUCHES_DISC,' 'JOINT_TOUCHES_NEW,' model/linkage.c \
    model/linkage_check.c model/joint_rows.c contact/touch.c contact/law_depth.c \
    casefile/check_joints.c run/pressed.c run/settle_follow.c commands/run/run_text.c \
    commands/report/report_data.c
forget coordinate model/joint.h '    JOINT_COORDINATE_TEETH,' 'JOINT_COORDINATE_NEW,' \
    model/coordinate.c model/response_rows.c contact/touch.c casefile/limits.c \
    commands/run/run_text.c ode/stepping.c reference/plane/tree_coordinate.c reference/plane/plane_system.c
forget shape contact/touch.h 'member(with, TOUCH_LINE,' \
    'member(with, TOUCH_NEW, LINE, false, "new")' contact/touch.c ode/plane/world.c \
    ode/plane/impulse_step.c ode/plane/impulse_work.c reference/plane/dynamics.c \
    reference/plane/dynamics_slopes.c
forget dimension casefile/units.h 'member(DIMENSION_MASS,' 'member(DIMENSION_NEW)' casefile/units.c
numbers=model/number_list.h
row='"new", COUNT, "new", NULL, NULL, NUMBER_EVERYWHERE, 0, new_number(of), "new")'
forget 'number of a body' $numbers 'row(BODY, OMEGA_MAX,' "row(BODY, NEW, $row" \
    measure/number_values.c
forget 'number of a run' $numbers 'row(RUN, IMPACTS,' "row(RUN, NEW, $row" measure/number_values.c
forget 'number of a spike' $numbers 'row(owner, ONSET,' "row(owner, NEW, $row" \
    measure/number_values.c
forget 'kind of number' $numbers 'kind(COUNT)' 'kind(NEW)' casefile/expect.c \
    commands/check/check_measure.c commands/run/run_fields.c
forget 'owner of numbers' $numbers 'owner(BODY, ' 'owner(NEW, WHOLE, "new", "", "new")' \
    measure/number_values.c
forget 'extreme of a body' model/trajectory.h 'member(omega_max,' 'member(new_max, new, raise_to)' \
    run/recorder.c run/run.c analytic/analytic.c analytic/driven_extremes.c
echo "1..$number"
