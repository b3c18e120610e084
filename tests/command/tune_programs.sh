#!/bin/sh
# Is the error of a program of `tune --code` the one that was promised? Seeded random cases that
# nobody tuned for: each program is compiled and run, and its series held against the reference in
# another frame. Prints TAP. Called with the program, random_case, program_error and the library's
# folder; in PROGRAMS the kinds and seeds, as "four-bar:3 limits:7".
set -u
export MALLOC_PERTURB_=0 # see tests/support/program.h
jointplay=$(realpath "$1")
random_case=$(realpath "$2")
program_error=$(realpath "$3")
library=$4
cc=${JOINTPLAY_CC:-cc}
target=${TARGET:-1e-3}
programs=${PROGRAMS:-"four-bar:1 four-bar:3 bodies:2 bodies:11
    pendula:1 sprung:1 sprung:5 limits:1 limits:8 limits:14 limits:16
    sliders:1 balls:1"}
# shellcheck disable=SC2086
set -- $programs
python=${JOINTPLAY_PYTHON:-python3}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
echo "1..$(($# + 2))"
number=0
written=0

# Of the JSON: how far the truth goes, its uncertainty, and the error that was promised.
values() {
    "$python" -c 'import json
tune = json.load(open("tune.json"))
truth = tune["truth"]
print(truth["horizon_s"] if truth["is_limited"] else "inf", truth["uncertainty"],
      tune["program"]["error_max"])'
}

# Whether the words of a line hold, as awk puts them.
holds() {
    awk "BEGIN { exit !($1) }"
}

report() {
    number=$((number + 1))
    if [ "$1" = 0 ]; then echo "ok $number - $2"; else echo "not ok $number - $2"; fi
}

# Builds a program and writes its series.
run_world() {
    $cc -O1 -Wall -Wextra -Werror -o world "$1" -I"$JOINTPLAY_HEADERS" \
        $(pkg-config --cflags --libs ode) -L"$library" -ljointplay -lm &&
        LD_LIBRARY_PATH=$library ./world >series.csv 2>words
}

check_program() {
    values >values
    read -r horizon slack printed <values
    found=$(run_world world.c && "$program_error" case.yaml series.csv "$horizon" "$length")
    error=${found%% *}
    [ -n "$error" ] && holds "$error <= $target && $error <= $printed * 1.001 + $slack &&
        $error >= $printed * 0.999 - $slack"
    report $? "$1: $found, printed $printed, asked for $target"
    [ $written = 0 ] && check_control "$1"
    written=$((written + 1))
}

# The same program with another weight must miss.
check_control() {
    sed 's/dWorldSetGravity(world, 0, -9/dWorldSetGravity(world, 0, -8/' world.c >wrong.c
    found=$(run_world wrong.c && "$program_error" case.yaml series.csv "$horizon" "$length")
    error=${found%% *}
    [ -n "$error" ] && holds "$error > 2 * $target"
    report $? "$1 with another weight is caught: $found"
}

for program in "$@"; do
    "$random_case" "${program%:*}" "${program#*:}" >case.yaml
    length='run.duration=20 ms'
    ! grep -q 'revolutions: ' case.yaml || length=run.revolutions=0.05
    rm -f world.c
    "$jointplay" tune case.yaml --set "$length" --error "$target" --cost steps --code world.c \
        --schemes direct/staggered --json --quiet >tune.json 2>words
    status=$?
    if [ -e world.c ]; then
        check_program "$program"
    elif [ $status = 2 ]; then
        grep -q '^jointplay: --code: ' words
        report $? "$program: refused before the search, $(cat words)"
    else
        [ $status = 1 ]
        report $? "$program: status $status, $(cat words)"
    fi
done
holds "$written >= $# / 2"
report $? "$written programs of $# were written"
