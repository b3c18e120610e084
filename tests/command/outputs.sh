#!/bin/sh
# Does no output replace a file that it should not? Every option that writes a file, and every file
# that a command is given a name for, taken from the help of the commands, is pointed at every input
# of that command, under names that take turns among all that a file can have, and at files of other
# kinds: refused before anything runs, and not a byte changed. Then each is pointed at a new file, at its
# own again, and where nothing can be written.
# Prints TAP, a row of the table of pairs a line.
set -u
export MALLOC_PERTURB_=0 # see tests/support/program.h
program=$1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
mkdir "$work/in" && cd "$work/in" || exit 1
XDG_CACHE_HOME=$work/cache
export XDG_CACHE_HOME

cat >k.yaml <<'END'
bodies:
  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}
joints:
  hole: {between: [ground, pin], at: [0 mm, 0 mm], radial-clearance: 0.1 mm, pin: 10 mm, width: 15 mm}
contact: {stiffness: 6.6e10 N/m^1.5, restitution: 0.9}
run: {duration: 6 ms, samples: 100, step: 5 us, backends: [reference, ode]}
END
# JSON is YAML, too
cat >k.json <<'END'
{"bodies": {"pin": {"mass": "0.1 kg", "inertia": "2 kg mm^2", "at": ["0 mm", "0 mm"]}},
 "joints": {"hole": {"between": ["ground", "pin"], "at": ["0 mm", "0 mm"],
                     "radial-clearance": "0.1 mm", "pin": "10 mm", "width": "15 mm"}},
 "contact": {"stiffness": "6.6e10 N/m^1.5", "restitution": 0.9},
 "run": {"duration": "6 ms", "samples": 100, "step": "5 us", "backends": ["reference", "ode"]}}
END
cat >i.yaml <<'END'
bodies:
  arm: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [10 mm, 0 mm]}
joints:
  hinge: {between: [ground, arm], at: [0 mm, 0 mm]}
run: {duration: 6 ms, samples: 10, step: 100 us, backends: [reference, ode]}
END
cat >s.yaml <<'END'
title: A study
case: i.yaml
vary: {run.step: [100 us, 200 us]}
END
printf 'time,force\n0,1\n' >measured.csv
printf '<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg"></svg>\n' >drawing.svg
# what stays the same in every comparison, search and so on
compare='--schemes direct/plain/midpoint --steps 20us'
tune='--schemes direct/plain --error 0.3'
{
    "$program" study s.yaml --quiet && "$program" compare k.yaml $compare --store j.jsonl --quiet &&
        "$program" check i.yaml --bless --baselines b --quiet
} >"$work/log" 2>&1 || {
    sed 's/^/# /' "$work/log"
    echo "Bail out! the inputs cannot be made"
    exit 1
}

# The words of a command, and of its option where these differ, for an input; the place of a file
# without an option is marked by @. Nothing for a command that is not known here.
words_of() {
    case $1/$2 in
    run--series/k.json | run--contacts/k.json) echo "run k.json --backend ode" ;;
    run--series/* | run--contacts/*) echo "run k.yaml --backend ode" ;;
    run--*/k.json) echo "run k.json" ;;
    run--*) echo "run k.yaml" ;;
    compare--store/*) echo "compare k.yaml $compare" ;;
    compare--*/j.jsonl) echo "compare k.yaml $compare --store j.jsonl" ;;
    compare--*/k.json) echo "compare k.json $compare" ;;
    compare--*) echo "compare k.yaml $compare" ;;
    map--*/k.json) echo "map k.json --steps 20us --maps midpoint" ;;
    map--*) echo "map k.yaml --steps 20us --maps midpoint" ;;
    report--*/k.json) echo "report k.json --backend ode" ;;
    report--*) echo "report k.yaml --backend ode" ;;
    tune--*/k.json) echo "tune k.json $tune" ;;
    tune--*) echo "tune k.yaml $tune" ;;
    check--baselines/*) echo "check i.yaml --bless" ;;
    check--*) echo "check i.yaml --quick --baselines b" ;;
    study--*) echo "study s.yaml" ;;
    new@*) echo "new --force @" ;;
    "study export"*) echo "study export s.sqlite" ;;
    "study plot"*) echo "study plot s.sqlite --x step_s @" ;;
    "study merge"*) echo "study merge @ s.sqlite" ;;
    "study slurm"*) echo "study slurm s.yaml --shards 2" ;;
    esac
}

# Of an output that may go on with what is there, or replace it: the file that is its own.
own_of() {
    case $1 in
    study--store) echo s.sqlite ;;
    compare--store) echo j.jsonl ;;
    check--baselines) echo b/i.json ;;
    "study merge@") echo s.sqlite ;;
    esac
}

# What a command reads is tried under two names, what it does not under one.
inputs_of() {
    case $1 in
    run | map | tune | report) echo k.yaml k.json ;;
    compare) echo k.yaml k.json j.jsonl ;;
    check) echo i.yaml b/i.json ;;
    study | "study slurm") echo s.yaml i.yaml ;;
    *) echo s.sqlite ;;
    esac
}
files="k.yaml k.json i.yaml s.yaml s.sqlite j.jsonl b/i.json measured.csv drawing.svg"

# "command option kind" of every output, from the help: kind is FILE, FILE.csv or DIR, the option is
# @ where the file has none.
list_outputs() {
    for command in $("$program" help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
        list_command "$command"
    done
    for part in $("$program" help study |
        sed -n 's/^  or:  jointplay study \[OPTION...\] \([a-z][a-z]*\).*/\1/p' | sort -u); do
        list_command "study $part"
    done
}
list_command() {
    "$program" help $1 | awk -v command="$(echo "$1" | tr ' ' '_')" '
        /^(Usage:|  or:)/ && command != "study" {
            for (i = 1; i <= NF; i++) {
                gsub(/[][]/, "", $i)
                if ($i ~ /^(FILE\.[a-z]+|OUT\.[a-z]+)$/) { print command, "@", $i }
            }
        }
        match($0, /^ +(-[a-zA-Z], )?--[a-z-]+=(FILE[^ ]*|DIR)/) {
            option = substr($0, RSTART, RLENGTH)
            sub(/^ +(-[a-zA-Z], )?/, "", option)
            split(option, parts, "=")
            print command, parts[1], parts[2]
        }'
}

log=$work/log
. "$(dirname "$0")/../support/tap.sh"

# What changes as soon as anything is written to a file, or another put in its place: its number, its
# size, and when it was last changed.
list_files() {
    find . \( -type f -printf '%p %i %s %C@\n' \) -o \( -type l -print \)
}

# Runs words of a command with an output in place; its status.
run_with() {
    case $2 in
    @) set -- "$(echo "$1" | sed "s|@|$3|")" ;;
    *) set -- "$1 $2 $3" ;;
    esac
    "$program" $1 --quiet >"${sink:-$work/output}" 2>"$work/log"
}

is_in() {
    case $1 in
    *"$2"*) true ;;
    *) false ;;
    esac
}

# One pair under one name: the option, the name, and what the message has to name.
tried=0
refused=0
try() {
    tried=$((tried + 1))
    run_with "$1" "$2" "$3"
    status=$?
    message=""
    while IFS= read -r line; do message="$message$line"; done <"$work/log"
    if { [ $status = 2 ] || [ $status = 5 ]; } && [ ! -s "$work/output" ] &&
        is_in "$message" "$4" &&
        { [ "$2" = @ ] || is_in "$message" "$2" || is_in "$message" --bless; }; then
        refused=$((refused + 1))
    else
        echo "# jointplay $1 $2 $3: status $status"
        sed 's/^/#   /' "$work/log" | head -n 3
    fi
}

# Whether all is as it was before the tries; otherwise none of them counts as refused.
check_unchanged() {
    list_files >"$work/after"
    cmp -s "$work/before" "$work/after" || {
        refused=-1
        diff "$work/before" "$work/after" | sed 's/^/#   /'
    }
}

# A file in the place of one that is there, by two of its six names where it is read.
turn=0
try_file() {
    ending=$(echo "$3" | sed -n 's/^[A-Z]*\(\.[a-z]*\)$/\1/p')
    mkdir n
    ln -s . self
    ln -s "../$4" "n/soft$ending"
    ln "$4" "n/hard$ending"
    list_files >"$work/before"
    names="n/hard$ending"
    if [ "$5" = read ]; then
        turn=$((turn + 1))
        case $((turn % 3)) in
        0) names="$4 n/soft$ending" ;;
        1) names="./$4 n/hard$ending" ;;
        2) names="n/../$4 self/$4" ;;
        esac
    fi
    for name in $names; do
        try "$1" "$2" "$name" "$name"
    done
    check_unchanged
    rm -r n self
}

# The files of a folder in the place of one that is there.
try_folder() {
    for member in $3; do
        mkdir n
        ln "$4" "n/$member"
        list_files >"$work/before"
        try "$1" "$2" n "$member"
        check_unchanged
        if [ "$5" = read ]; then
            ln -sf "../$4" "n/$member"
            list_files >"$work/before"
            try "$1" "$2" n "$member"
            check_unchanged
        fi
        rm -r n
    done
    member=$(basename "$4")
    case " $3 " in
    *" $member "*)
        list_files >"$work/before"
        try "$1" "$2" "$(dirname "$4")" "$member"
        check_unchanged
        ;;
    esac
}

# The control: the same words with a new file, or folder, and with its own again.
try_fresh() {
    rm -rf "$work/fresh"
    target=$work/fresh/x$(echo "$3" | sed -n 's/^[A-Z]*\(\.[a-z]*\)$/\1/p')
    mkdir "$work/fresh"
    members=""
    for round in 1 2; do
        run_with "$1" "$2" "$target"
        status=$?
        # several runs have a name for each
        if [ $status != 0 ] || [ -z "$(find "$work/fresh" -type f -size +0)" ]; then
            return 1
        fi
    done
    members=$(find "$target" -mindepth 1 -printf '%f ' 2>/dev/null)
}

# Where nothing can be written: a full disk behind a link, a folder in place of the file, a folder that
# is not there, a file in place of a folder, and files that may not grow, which a full disk is to a new
# file. Never done, and nothing of it is left.
try_unwritable() {
    ending=$(echo "$3" | sed -n 's/^[A-Z]*\(\.[a-z]*\)$/\1/p')
    ways="full folder missing limit"
    [ "$3" != DIR ] || ways="file limit"
    : >"$work/misses"
    for way in $ways; do
        rm -rf "$work/fresh"
        mkdir "$work/fresh"
        target=$work/fresh/x$ending
        case $way in
        full) ln -s /dev/full "$target" ;;
        folder) mkdir "$target" ;;
        missing) target=$work/fresh/nowhere/x$ending ;;
        file) : >"$target" ;;
        esac
        case $way in
        # what it prints could not grow either
        limit) (sink=/dev/null && ulimit -f 0 && run_with "$1" "$2" "$target" && exit 0) 2>/dev/null ;;
        *) run_with "$1" "$2" "$target" ;;
        esac
        status=$?
        { [ $status = 2 ] || [ $status = 5 ]; } && [ -z "$(find "$work/fresh" -type f -size +0)" ] ||
            echo "jointplay $1 $2 ($way): status $status" >>"$work/misses"
    done
    mv "$work/misses" "$log"
    [ ! -s "$log" ]
}

list_outputs >"$work/outputs"
while read -r command option kind; do
    command=$(echo "$command" | tr _ ' ')
    key=$command$option
    base=$(words_of "$key" "")
    if [ -z "$base" ]; then
        echo "add its words to words_of in outputs.sh" >"$work/log"
        report "$command $option has inputs that are known here" 1
        continue
    fi
    try_fresh "$base" "$option" "$kind"
    report "$command $option: a new $kind, and then its own" $?
    try_unwritable "$base" "$option" "$kind"
    report "$command $option: nothing half-written where nothing can be written" $?
    rm -rf "$work/cache"
    for input in $files; do
        [ "$(own_of "$key")" != "$input" ] || continue
        tried=0
        refused=0
        use=other
        case " $(inputs_of "$command") " in
        *" $input "*) use=read ;;
        esac
        if [ "$kind" = DIR ]; then
            try_folder "$(words_of "$key" "$input")" "$option" "$members" "$input" $use
        else
            try_file "$(words_of "$key" "$input")" "$option" "$kind" "$input" $use
        fi >"$work/misses"
        mv "$work/misses" "$work/log"
        [ $tried = $refused ]
        report "$(printf '%-13s %-11s in the place of %-12s (%s): %2d of %2d refused' \
            "$command" "$option" "$input" $use $refused $tried)" $?
    done
done <"$work/outputs"
[ $number -ge 100 ]
report "the help names outputs" $?
echo 1..$number
