#!/bin/sh
# Does the library of cases say what the commands say, number for number? The program of
# docs/library-case.md, built as C and as C++, beside `jointplay run --json` of ten cases; and what
# the library shows and needs. Prints TAP.
# Usage: case_numbers.sh SOURCES PROGRAM LIBRARY EXAMPLE...
set -u
root=$1
program=$2
library=$3
shift 3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. "$root/tests/support/tap.sh"

# What is printed but for how long it took: that is another each time.
answer() {
    grep -vE '"(wall_s|us_per_step|real_time_factor)":' "$1"
}

# A case, and its settings.
compare() {
    example=$1
    case=$2
    shift 2
    settings=
    for setting in "$@"; do settings="$settings --set $setting"; done
    "$program" run "$case" --json --quiet $settings >"$work/command" 2>"$log" &&
        "$example" "$case" "$@" >"$work/library" 2>>"$log" &&
        answer "$work/command" >"$work/command.answer" &&
        answer "$work/library" >"$work/library.answer" &&
        cmp "$work/command.answer" "$work/library.answer" >>"$log" 2>&1
}

for example in "$@"; do
    name=$(basename "$example")
    compare "$example" "$root/cases/paper/impact-k66.yaml" run.start=centred run.revolutions=0.1
    report "$name: the paper's case by its path" $?
done
while read -r case settings; do
    compare "$1" "$case" $settings
    report "$case $settings" $?
done <<CASES
impact-k66 run.revolutions=0.1 run.settle-starts=2
ideal-nominal
pendulum
stop-rebound
slider-crank
gear-pair run.backends=[reference]
servo-backlash
friction-circle run.backends=[reference]
overhung-pin run.start=centred run.duration=5ms
CASES
compare "$1" impact-k66 run.start=centred run.revolutions=0.1 ode.map=corrected
report "another map" $?
"$program" run impact-k66 --json --quiet --set run.start=centred --set run.revolutions=0.1 >"$work/other" 2>"$log"
answer "$work/other" >"$work/other.answer"
! cmp -s "$work/other.answer" "$work/library.answer"
report "the control: another map has other numbers" $?
"$1" impact-k66 joints.crank-coupler.hole=3kg >"$work/library" 2>"$work/said"
[ $? = 2 ] && ! [ -s "$work/library" ] && grep -q "^joints.crank-coupler.hole: expected a length" "$work/said"
report "a mistake is said as on the command line, behind the key and with its status" $?

nm -D --defined-only "$library" | awk '{ sub(/@.*/, "", $3) } $3 !~ /^jp_(case|answer|key|quantity|run_options|map_options)_/ && $3 !~ /^JOINTPLAY_CASE/ { print $3 }' >"$log"
[ ! -s "$log" ]
report "the library shows its functions alone" $?
nm -D --undefined-only "$library" | awk '{ sub(/@.*/, "", $2); print $2 }' |
    grep -xE 'exit|abort|v?f?printf|puts|putchar|perror|stdout|stderr|setlocale|sigaction|atexit|longjmp_chk' |
    grep -vx 'fprintf' >"$log"
[ ! -s "$log" ]
report "it cannot print, end the process, or change its locale" $?
echo "1..$number"
