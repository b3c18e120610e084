#!/usr/bin/env bash
# Does any command, case, study, baseline, store or journal bring the program down? Makes seeded random
# ones and runs them with the address and undefined-behaviour sanitizers: names that do harm, stores
# changed by SQL, journals beside them, closed descriptors and small limits for files among them. A
# finding is an exit status that the program does not have, a report of a sanitizer, a number that is
# none in what it printed or wrote with status 0, an input that was changed, a name that was run or
# printed as it is, or more than 20 s of processor time without a word. Prints each finding with its seed, and
# ends with status 1 where there was one.
#
# tests/measure/fuzz.sh [SECONDS [FIRST [BUILD]]]
#   SECONDS  of processor time (default 3600)
#   FIRST    the first seed (default 1)
#   BUILD    a build folder to keep; else a temporary one
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
seconds=${1:-3600}
seed=${2:-1}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
build=${3:-$work/build}
longest=60 # s of one command: what announces that it takes long is ended there
ticks=$(getconf CLK_TCK)
silent=20  # s of processor time without a word

if [ ! -f "$build/build.ninja" ]; then
    meson setup "$build" "$root" -Dtests=enabled -Dbuildtype=debugoptimized \
        -Db_sanitize=address,undefined -Db_lundef=false >/dev/null || exit 2
fi
ninja -C "$build" --quiet >/dev/null || exit 2
program=$build/src/cli/jointplay
maker=$build/tests/measure/random_command
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
export ASAN_OPTIONS=abort_on_error=0:exitcode=99:detect_leaks=1
export LSAN_OPTIONS=suppressions=$root/tests/support/lsan.supp:print_suppressions=0

# the options as the program itself tells them
for command in run report compare map tune study check paper help \
    'study merge' 'study status' 'study export' 'study plot' 'study slurm'; do
    # shellcheck disable=SC2086 # the words of a command
    "$program" $command --help | grep -oE '^ +(-[a-z], )?--[a-z-]+(=[A-Za-z0-9/|.=]+)?' |
        sed -E "s/^ +(-[a-z], )?/${command/ /-} /"
done | grep -v -- '--help' >"$work/options"

findings=0
commands=0
find_fault() {
    findings=$((findings + 1))
    echo "seed $seed: $1: jointplay $(printf '%q ' "${arguments[@]}")"
    tail -n 4 error | sed 's/^/    /'
}

# Processor time of the program under 'timeout', s: a machine that is shared must not make it a
# finding. One that waits uses none; 'timeout' ends it.
used_by_child() {
    local pid= fields=
    read -r pid _ <"/proc/$child/task/$child/children"
    read -r fields <"/proc/$pid/stat" # it may have ended by now
    awk -v ticks="$ticks" '{ used = $14 + $15 } END { print int(used / ticks) }' <<<"$fields"
} 2>/dev/null

# What a command is given and must leave as it was: what is there before it.
inputs() {
    cat -- "${given[@]}" 2>/dev/null | cksum
}

# The program in place of this shell, with descriptors closed and a limit for files as it is asked.
run_oddly() {
    ulimit -c 0
    [ -z "$limit" ] || ulimit -f "$limit"
    case $closed in *0*) exec 0<&- ;; esac
    case $closed in *1*) exec 1>&- ;; esac
    case $closed in *2*) exec 2>&- ;; esac
    exec timeout --kill-after=5 "$longest" "$program" "${arguments[@]}"
}

# Runs the program with the arguments, and looks at what it left behind.
run_step() {
    local status=0 before given
    given=(./*.yaml victim)
    before=$(inputs)
    commands=$((commands + 1))
    run_oddly >printed 2>error </dev/null &
    local child=$!
    while kill -0 "$child" 2>/dev/null && [ "$(used_by_child)" -lt "$silent" ]; do
        sleep 0.1
    done
    if kill -0 "$child" 2>/dev/null && [ ! -s error ] && [ ! -s printed ]; then
        # words go to a file here: none where that is closed, or may not grow
        case $closed:$limit in *2*:* | *:0) ;; *) find_fault "$silent s without a word" ;; esac
        kill "$child"
    fi
    wait "$child" || status=$?
    case $status in
    [0-5] | 124 | 130 | 143) ;;
    *) find_fault "status $status" ;;
    esac
    if grep -qE 'ERROR: (Address|Leak)Sanitizer|runtime error|Assertion' error; then
        find_fault "report of a sanitizer or an assertion"
    fi
    [ "$before" = "$(inputs)" ] || find_fault "an input was changed"
    [ ! -e harm ] || find_fault "a name was run"
    if LC_ALL=C grep -qP '[\x00-\x08\x0b-\x1f\x7f]|\xe2\x80\xae|\xe9' printed error; then
        find_fault "a name was printed as it is"
    fi
    # the comments of a program in C may speak of what is no number
    if [ "$status" = 0 ] &&
        grep -rlZwE --include='*.csv' --include='*.svg' --include='*.json' --include='*.txt' \
            --include=printed -- '-?(nan|inf|NaN|Infinity)' . 2>/dev/null |
        xargs -0 -r grep -LF '// A mechanism with play in its joints' | grep -q .; then
        find_fault "a number that is none, with status 0"
    fi
}

# The steps of one seed, in a folder of their own.
run_plan() {
    local kind line word
    while IFS= read -r kind; do
        arguments=()
        while IFS= read -r line && [ -n "$line" ]; do
            arguments+=("$line")
        done
        if [ "$kind" = damage ]; then
            "$maker" damage "$seed" "${arguments[0]}"
            continue
        fi
        closed=
        limit=
        for word in $kind; do
            case $word in
            closed=*) closed=${word#closed=} ;;
            limit=*) limit=${word#limit=} ;;
            esac
        done
        run_step
    done <plan
}

# Processor time of all finished children, s; 'times' counts them only in this very shell.
used() {
    times >"$work/times"
    used_s=$(awk 'NR == 2 { split($1, u, /[ms]/); split($2, s, /[ms]/)
                            print int(60 * (u[1] + s[1]) + u[2] + s[2]) }' "$work/times")
}

first=$seed
used
end_s=$((used_s + seconds)) # the build does not count
while [ "$used_s" -lt "$end_s" ]; do
    rm -rf "$work/place"
    mkdir -p "$work/place"
    cd "$work/place" || exit 2
    echo untouched >victim
    "$maker" plan "$seed" "$work/options" >plan || exit 2
    run_plan
    seed=$((seed + 1))
    used
done
echo "$commands commands of seeds $first to $((seed - 1)), $findings findings"
[ "$findings" = 0 ]
