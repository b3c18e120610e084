#!/bin/bash
# Does a study come out of a real Slurm as it does of one process, whatever happens to its jobs?
# Prints TAP. Arguments: the program, the folder of cases.
set -u
program=$(realpath "$1")
cases=$2
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=tests/cluster/daemons.sh
. "$here/daemons.sh"
# shellcheck source=tests/cluster/rows.sh
. "$here/rows.sh"

# names that scripts have to quote
work=$(mktemp -d "${TMPDIR:-/tmp}/jointplay's slurm.XXXXXX")
# Slurm's own files have names without quotes; a socket's is short
cluster=$(mktemp -d "${TMPDIR:-/tmp}/jointplay-slurm.XXXXXX")
leave() {
    cluster_end
    rm -rf "$work" "$cluster"
}
trap leave EXIT
trap 'exit 1' INT TERM HUP

JOB_WAIT=240  # s for an array and what gathers it: some 30 s on two free cores
SPEEDS_CALM=2 # of a study whose shards are left alone
SPEEDS_HIT=6  # of one whose shards take longer than it takes to hit them
DRAWS=12      # a speed: runs of some 0.2 s each
number=0

# A sentence, and whether it is true: the status of the command behind it.
check() {
    local sentence=$1
    shift
    number=$((number + 1))
    if "$@" >"$work/said" 2>&1; then
        echo "ok $number - $sentence"
    else
        echo "not ok $number - $sentence"
        sed 's/^/# /' "$work/said"
    fi
}

# A folder of its own for a study, of a number of speeds.
write_study() {
    mkdir "$work/$1"
    cat >"$work/$1/two words.yaml" <<STUDY
title: Speed and length
case: "$cases/paper/ideal-nominal.yaml"
set: {run.step: 1 us}
vary:
  drive.speed: {from: 300 rpm, to: 1500 rpm, count: $2}
draw:
  count: $DRAWS
  method: random
  seed: 1
  keys:
    four-bar.coupler.length: {uniform: [278.9 mm, 279.9 mm]}
STUDY
}

rows() {
    study_rows "$program" "$1"
}

# The study whole, in one process: whether it has all of its runs.
make_whole() {
    "$program" study "$work/$1/two words.yaml" --store "$work/$1/whole.sqlite" >/dev/null 2>&1
    rows "$work/$1/whole.sqlite" >"$work/$1/whole.csv"
    [ "$(wc -l <"$work/$1/whole.csv")" = $(($2 * DRAWS + 1)) ]
}

# The scripts for four shards, beside their study.
make_scripts() {
    (cd "$work/$1" && "$program" study slurm "two words.yaml" --shards 4 --mem 100M --time 60)
}

# What each shard and the gather job said, for whoever looks for what went wrong.
show_logs() {
    grep -E "^[0-9]{4}-|^Made|error|runs" "$work/$1"/*.log
}

equals_unsharded() {
    if ! rows "$work/$1/two words.sqlite" >"$work/$1/gathered.csv" ||
        ! [ -s "$work/$1/whole.csv" ] ||
        ! cmp "$work/$1/whole.csv" "$work/$1/gathered.csv"; then
        show_logs "$1"
        return 1
    fi
}

tries_of() {
    grep -c 'try' "$work/$1/two_words.$2-of-4.log"
}

listens_here_alone() {
    sed -n 's/.*Port=\([0-9]*\).*/\1/p' "$SLURM_CONF" | while read -r port; do
        grep -qi "0100007F:$(printf %04X "$port") 00000000:0000 0A" /proc/net/tcp || return 1
    done
}

# Until a shard has rows and is at work on more.
await_rows() {
    local end=$((SECONDS + JOB_WAIT))
    until [ "$(rows "$work/$1/two words.$2-of-4.sqlite" 2>/dev/null | wc -l)" -gt 3 ]; do
        [ $SECONDS -lt $end ] || return 1
        sleep 0.1
    done
}

# The study itself that is at work on a shard, and not the runs that it has started.
study_of() {
    local process parent
    for process in $(pgrep -f -- " --shard $2/4 "); do
        parent=$(cluster_parent "$process")
        [ "$(readlink "/proc/$process/cwd")" = "$work/$1" ] &&
            [ "$(ps -o comm= -p "${parent:-0}")" = slurm_script ] && echo "$process"
    done
}

node_of() {
    squeue --noheader --jobs="$1" --format=%N
}

# Each shard is hit once while it is at work, each by something else.
hit_shards() {
    local array=$1 node
    await_rows hit 1 && await_rows hit 2 || return 1
    kill -9 "$(study_of hit 1)" || return 1
    # all processes on the node of the second shard end, and the operator is told
    node=$(node_of "${array}_2")
    [ -n "$node" ] && cluster_node_kill "$node" || return 1
    scontrol update nodename="$node" state=down reason=dead || return 1
    # as a minute before the time limit
    await_rows hit 3 && scancel --signal=TERM --batch "${array}_3" || return 1
    # as when the node is wanted for something else
    await_rows hit 4 && scontrol requeue "${array}_4" || return 1
    cluster_node_begin "$node"
}

# At least twice: where Slurm notices late that a node died, it ends what it has just put back there.
was_tried_again() {
    local shard
    for shard in 1 2 3 4; do
        [ "$(tries_of hit $shard)" -ge 2 ] || { show_logs hit; return 1; }
    done
}

# The second try made what the first had not: some of the runs of a shard, and not all.
went_on() {
    local shard made
    for shard in 1 2 3 4; do
        made=$(sed -n 's/^Made \([0-9]*\) runs .*/\1/p' "$work/hit/two_words.$shard-of-4.log")
        [ -n "$made" ] && [ "$made" -lt $((SPEEDS_HIT * DRAWS / 4)) ] || { show_logs hit; return 1; }
    done
}

# Submits the scripts of a folder; the number of the array is in $array then.
submit() {
    array=$("$work/$1/two words.submit.sh" | sed 's/^array \([0-9]*\) .*/\1/')
    [ -n "$array" ]
}

# A task that its owner has cancelled is not put back by its own script.
stays_cancelled() {
    write_study cancelled $SPEEDS_HIT && make_scripts cancelled && submit cancelled && await_rows cancelled 1 || return 1
    scancel "${array}_1" && scancel "$array" && cluster_await_jobs $JOB_WAIT || return 1
    [ "$(tries_of cancelled 1)" = 1 ]
}

gaps_are_told() {
    grep -q 'runs are missing' "$work/cancelled/two_words.gather.log" ||
        { show_logs cancelled; return 1; }
}

nothing_is_left() {
    cluster_end
    ! pgrep -af "$(basename "$cluster")"
}

echo 1..14
write_study calm $SPEEDS_CALM
write_study hit $SPEEDS_HIT
check "a Slurm of two nodes begins" cluster_begin "$cluster"
check "it listens on this machine alone" listens_here_alone
check "the studies are made whole in one process" \
    eval "make_whole calm $SPEEDS_CALM && make_whole hit $SPEEDS_HIT"

check "scripts are written and submitted" eval 'make_scripts calm && submit calm'
check "the array and the gather job end" cluster_await_jobs $JOB_WAIT
check "four shards gathered equal the whole, row for row" equals_unsharded calm

check "they are written and submitted once more" eval 'make_scripts hit && submit hit'
check "shards are killed, cut off, told to end and put back at work" hit_shards "$array"
cluster_await_jobs $JOB_WAIT
check "each of them was tried again" was_tried_again
check "and went on where it stood" went_on
check "nothing is lost and nothing twice" equals_unsharded hit
check "a cancelled shard stays cancelled" stays_cancelled
check "what is gathered of it is said to have gaps" gaps_are_told
check "no process is left" nothing_is_left
