#!/bin/bash
# When does the script of a shard put it back in the queue? Slurm and the study are stand-ins here, so
# that every end can be had at will. Prints TAP. Arguments: the program, the folder of cases.
set -u
program=$(realpath "$1")
cases=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

cat >two.yaml <<STUDY
title: Two runs
case: "$cases/paper/ideal-nominal.yaml"
vary:
  drive.speed: [300 rpm, 600 rpm]
STUDY
"$program" study slurm two.yaml --shards 2 --requeues 3 --quiet >/dev/null || exit 1
sed -i "s|^program=.*|program='$work/program'|" two.array.sh

# what the script calls: the study ends as told, the queue answers as told, and who is put back is kept
mkdir bin
# shellcheck disable=SC2016 # for the stand-in to expand
printf '#!/bin/bash\necho "$STATE"\n' >bin/squeue
printf '#!/bin/bash\necho "$*" >>"%s/asked"\n' "$work" >bin/scontrol
cat >program <<'STUDY'
#!/bin/bash
[ "$END" != wait ] || { trap 'exit 143' TERM; touch started; sleep 20 & wait; }
[ "$END" != killed ] || kill -9 $$
exit "$END"
STUDY
chmod +x bin/* program

# Runs the script: how the study ends, which restart it is, what the queue says of the task.
run_script() {
    rm -f asked started
    END=$1 STATE=$3 SLURM_RESTART_COUNT=$2 SLURM_ARRAY_JOB_ID=70 SLURM_ARRAY_TASK_ID=2 \
        SLURM_CPUS_PER_TASK=1 PATH="$work/bin:$PATH" ./two.array.sh >log 2>&1
}

number=0
check() {
    local sentence=$1
    shift
    number=$((number + 1))
    if "$@"; then
        echo "ok $number - $sentence"
    else
        echo "not ok $number - $sentence"
        sed 's/^/# /' log
    fi
}

# Whether a run of the script with these words puts the task, and it alone, back in the queue.
goes_back() {
    run_script "$@"
    [ "$(cat asked 2>/dev/null)" = 'requeue 70_2' ]
}

# Whether it leaves the queue alone, and with which status it ends.
ends_with() {
    local status=$1
    shift
    run_script "$@"
    [ $? = "$status" ] && [ ! -e asked ]
}

goes_back_when_told() {
    local script tries=0
    rm -f asked started
    END=wait STATE=RUNNING SLURM_RESTART_COUNT=1 SLURM_ARRAY_JOB_ID=70 SLURM_ARRAY_TASK_ID=2 \
        SLURM_CPUS_PER_TASK=1 PATH="$work/bin:$PATH" ./two.array.sh >log 2>&1 &
    script=$!
    until [ -e started ] || [ $((tries++)) = 100 ]; do sleep 0.1; done
    kill -TERM $script
    wait $script
    [ "$(cat asked 2>/dev/null)" = 'requeue 70_2' ]
}

echo 1..12
check "a study that is complete ends well" ends_with 0 0 0 RUNNING
check "one that is killed goes back in the queue" goes_back killed 0 RUNNING
check "one that is told to end goes back in the queue" goes_back_when_told
check "one that was put back as often as allowed does not" ends_with 137 killed 3 RUNNING
check "one that was cancelled does not" ends_with 137 killed 0 COMPLETING
check "one that has left the queue does not" ends_with 137 killed 0 ''
check "a bad study fails at once" ends_with 3 3 0 RUNNING
check "so does a solver that fails" ends_with 4 4 2 RUNNING
check "so does a store that cannot be used" ends_with 5 5 0 RUNNING
check "but not where an earlier try may hold it" goes_back 5 1 RUNNING

# the paths of drivers hold wherever a task begins; one that is not there is refused
touch 'an engine'
"$program" study slurm two.yaml --shards 2 --dry-run --driver 'toy=an engine' |
    grep -qxF "drivers=(--driver 'toy=$(pwd -P)/an engine')"
check "a driver's path is whole" [ $? = 0 ]
! "$program" study slurm two.yaml --shards 2 --dry-run --driver toy=none >log 2>&1 && grep -q "cannot find none" log
check "a driver that is not there is refused" [ $? = 0 ]
