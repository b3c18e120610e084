#!/bin/bash
# One shard of a study: a task of a job array. Written by 'jointplay study slurm'.
#SBATCH --job-name=@name@
#SBATCH --cpus-per-task=@cpus@
@asked@#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --array=1-@shards@
#SBATCH --signal=B:TERM@60
#SBATCH --output=@name@.%a-of-@shards@.log

set -u
program=@program@
folder=@folder@
shards=@shards@
study=@study@
stem=@stem@
requeues=@requeues@
drivers=(@drivers@)

# By its place in the array: one of the tasks has the number of the whole array.
task=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
restarts=${SLURM_RESTART_COUNT:-0}
say() { printf '%s %s: %s\n' "$(date '+%F %T')" "$task" "$*"; }

# Slurm tells this shell alone, a minute before the time limit; the study ends in good
# order when it is told.
child=
is_told=
tell() { is_told=yes; [ -z "$child" ] || kill -TERM "$child" 2>/dev/null; }
trap tell TERM

cd "$folder" || exit 5
say "shard $SLURM_ARRAY_TASK_ID of $shards on ${SLURMD_NODENAME:-?}, try $((restarts + 1))"
"$program" study "$study" "${drivers[@]}" --shard "$SLURM_ARRAY_TASK_ID/$shards" \
    --store "./$stem.$SLURM_ARRAY_TASK_ID-of-$shards.sqlite" --jobs "$SLURM_CPUS_PER_TASK" &
child=$!
[ -z "$is_told" ] || tell
# a signal ends the wait, but not yet the study
while kill -0 "$child" 2>/dev/null; do wait "$child"; done
wait "$child"
status=$?
[ "$status" != 0 ] || { say complete; exit 0; }
# nothing to be tried again: the gather job says what is missing, if anything is
[ "$status" != 4 ] || { say 'over, but no run went well'; exit 4; }

if [ -n "$is_told" ]; then
    reason='told to end'
elif [ "$status" -gt 128 ]; then
    reason="killed (status $status)"
elif [ "$status" = 5 ] && [ "$restarts" -gt 0 ]; then
    reason='could not use its store, which an earlier try may still hold'
else
    say "failed with status $status; another try would end the same"
    exit "$status"
fi
# whoever is cancelled or put back already is no longer running: that is left as it is
if [ "$(squeue --noheader --jobs="$task" --format=%T)" != RUNNING ]; then
    say "$reason"
    exit "$status"
fi
if [ "$restarts" -ge "$requeues" ]; then
    say "$reason after $restarts requeues, the most; submit the study again to go on"
    exit "$status"
fi
say "$reason; back in the queue"
scontrol requeue "$task"
exit "$status"
