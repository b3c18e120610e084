#!/usr/bin/env bash
# Is anything lost, made twice or left half-written by a command that is killed at any moment? Kills
# study, merge, compare, check --bless and run by SIGKILL at random moments of their whole lives, every
# second time where older outputs stand, and gives the same command again. A finding is an output that
# is neither the old one nor the new one, a finished run that is not there any more or is made again, a
# command that does not end with status 0 the second time, a file too many, or a result that is not the
# one of a command that nobody killed. Prints each finding with its number, and ends with status 1 where
# there was one.
#
# tests/measure/kills.sh [KILLS [SEED [PROGRAM]]]
#   KILLS    of each of the five commands (default 60)
#   SEED     of the moments (default 1)
#   PROGRAM  (default build/src/cli/jointplay)
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
kills=${1:-60}
RANDOM=${2:-1}
program=$(realpath "${3:-$root/build/src/cli/jointplay}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
findings=0

# The inputs, and older outputs where asked for: of the same commands, with other values.
write_case() { # samples of the run
    sed "s/samples: 3600, step: 10 us/samples: $1, step: 100 us/" \
        "$root/cases/paper/ideal-nominal.yaml" >k.yaml
}
RUNS=12 # of the study that is killed
write_study() { # runs, truth
    cat >s.yaml <<END
title: A study to be killed
case: k.yaml
vary:
  drive.speed: {from: 500 rpm, to: 1500 rpm, count: $(($1 / 2))}
  scheme: [direct/plain, direct/staggered]
truth: $2
END
}

# For each command: what it needs, its words, the numbers of its result that do not depend on the clock,
# what it had finished when it was killed, and whether all of that is there in the end.
prepare_study() { write_case 36 && write_study $RUNS true; }
words_study=(study s.yaml --json -q --jobs 2)
result_study() { rows s.sqlite; }
held_study() { rows s.sqlite 2>error || grep -q 'is not the store of a study\|No such file' error; }
kept_study() {
    local made
    made=$(sed -n 's/.*"made": \([0-9]*\).*/\1/p' output)
    # without the line of names
    [ "$((made + $(grep -c '^[0-9]' held)))" = $RUNS ] && ! grep -vxFf result held
}
rows() { "$program" study export "$1" | sed 's/,[^,]*$//'; }

prepare_merge() {
    cp "$work/shards/"* .
}
words_merge=(study merge m.sqlite a.sqlite b.sqlite c.sqlite)
result_merge() { "$program" study export m.sqlite; }
held_merge() { "$program" study export m.sqlite 2>error || grep -q 'is not the store of a study\|No such file' error; }
# all of it or nothing
kept_merge() { [ ! -s held ] || [ "$(wc -l <held)" = 1 ] || cmp -s held result; }

prepare_compare() { write_case 36; }
words_compare=(compare k.yaml --store c.jsonl --schemes direct/plain --steps '100 us, 50 us'
    --csv c.csv --plot c.svg -q)
result_compare() { cut -d, -f1-11 c.csv; }
held_compare() { [ ! -f c.jsonl ] || sed -n '/}$/p' c.jsonl; }
kept_compare() {
    head -n "$(wc -l <held)" c.jsonl | cmp -s - held && [ "$(wc -l <c.jsonl)" = 26 ] &&
        [ -z "$(sed 's/"wall_s":[^,}]*//; s/,"checksum".*//' c.jsonl | sort | uniq -d)" ]
}

prepare_bless() { write_case 36 && mkdir b; }
words_bless=(check k.yaml --bless --baselines b)
result_bless() { cat b/k.json; }
held_bless() { [ ! -f b/k.json.partial ] || grep '^{"metrics".*}$' b/k.json.partial || true; }
kept_bless() {
    local count
    count=$(wc -l <held)
    [ "$count" = 0 ] || grep -q "^k.yaml: $count measured starts are kept" error
}

prepare_run() { write_case 36; }
words_run=(run k.yaml --out out --plot p.svg --series s.csv -q)
result_run() { for name in out/* p.svg s-*.csv; do echo "$name"; timeless "$name"; done; }
held_run() { :; }
kept_run() { :; }

# An output without its times.
timeless() {
    case $1 in
    *.json) sed -E '/"(wall_s|us_per_step|real_time_factor)":/d' "$1" ;;
    *.txt) sed '/^  Time: /d; /^Cost$/,/^Kinematics/d' "$1" ;;
    *compare.csv | c.csv) cut -d, -f1-11 "$1" ;;
    c.svg) tail -n 1 "$1" ;;
    *) cat "$1" ;;
    esac
}
outputs() { find . -name '*.json' -o -name '*.txt' -o -name '*.csv' -o -name '*.svg' | sort; }

find_fault() {
    findings=$((findings + 1))
    echo "$command, kill $killed, after $moment s: $1"
    tail -n 3 error | sed 's/^/    /'
}

# Every output is the old one or the new one.
check_outputs() {
    local name
    for name in $(outputs); do
        timeless "${name#./}" >"$work/now"
        cmp -s "$work/now" <(cd "$work/$command-truth" && timeless "${name#./}") ||
            cmp -s "$name" "$work/$command-older/$name" || find_fault "$name is half-written"
    done
}

list_files() { find . ! -name output ! -name error ! -name held ! -name result | sort; }

# Kills the command once at a moment; false where it ended before.
kill_once() {
    local is_older=$1
    rm -rf "$work/place"
    mkdir "$work/place"
    cd "$work/place" || exit 2
    "prepare_$command"
    if [ "$is_older" = 1 ]; then
        (cd "$work/$command-older" && outputs | xargs -r cp --parents -t "$work/place")
    fi
    "$program" "${words[@]}" >output 2>error </dev/null &
    local child=$!
    sleep "$moment"
    kill -KILL "$child" 2>/dev/null
    wait "$child" 2>/dev/null
    [ $? = 137 ]
}

check_after() {
    "held_$command" >held || find_fault 'what was finished cannot be read'
    check_outputs
    "$program" "${words[@]}" >output 2>error </dev/null || find_fault "status $? the second time"
    "result_$command" >result 2>&1
    cmp -s result "$work/$command-result" || find_fault 'the result is another one'
    "kept_$command" >/dev/null || find_fault 'a finished run was lost or made twice'
    list_files | cmp -s - "$work/$command-files" || find_fault "files: $(list_files | tr '\n' ' ')"
}

# What the command makes undisturbed, what it made of other values, and how long it takes.
find_truth() {
    local i begun
    for i in older truth; do
        mkdir "$work/$command-$i"
        cd "$work/$command-$i" || exit 2
        "prepare_$command"
        [ "$i" = truth ] || write_case 40
        begun=$(date +%s%N)
        "$program" "${words[@]}" >output 2>error </dev/null || {
            cat error
            exit 2
        }
        life_us=$((($(date +%s%N) - begun) / 1000))
    done
    "result_$command" >"$work/$command-result"
    list_files >"$work/$command-files"
}

make_shards() {
    mkdir "$work/shards"
    cd "$work/shards" || exit 2
    write_case 36
    write_study 60 false
    local i=0 name
    for name in a b c; do
        i=$((i + 1))
        "$program" study s.yaml --shard "$i/3" --store "$name.sqlite" -q >/dev/null || exit 2
    done
    rm s.yaml k.yaml
}

make_shards
for command in study merge compare bless run; do
    declare -n words=words_$command
    find_truth
    killed=0
    tries=0
    while [ "$killed" -lt "$kills" ] && [ "$tries" -lt $((20 * kills)) ]; do
        tries=$((tries + 1))
        # 30 random bits, over the whole life
        moment=$(awk -v r="$((RANDOM * 32768 + RANDOM))" -v l="$life_us" \
            'BEGIN { printf "%.6f", r / 1073741824 * l * 1e-6 }')
        if kill_once $((tries % 2)); then
            killed=$((killed + 1))
            check_after
        fi
    done
    echo "$command: $killed kills within $((life_us / 1000)) ms, $findings findings so far"
    [ "$killed" = "$kills" ] || findings=$((findings + 1))
done
[ "$findings" = 0 ]
