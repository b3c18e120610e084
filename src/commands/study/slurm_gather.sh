#!/bin/bash
# Gathers the shards of a study. Written by 'jointplay study slurm'.
#SBATCH --job-name=@name@.gather
#SBATCH --cpus-per-task=1
@asked@#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=@name@.gather.log

set -u
program=@program@
folder=@folder@
shards=@shards@
stem=@stem@

cd "$folder" || exit 5
stores=()
for ((i = 1; i <= shards; i++)); do
    store=./$stem.$i-of-$shards.sqlite
    if [ -e "$store" ]; then stores+=("$store"); else echo "there is no $store"; fi
done
words=$("$program" study merge "./$stem.sqlite" "${stores[@]}" 2>&1)
status=$?
printf '%s\n' "$words"
[ $status = 0 ] || exit $status
"$program" study status "./$stem.sqlite" || exit
[[ $words =~ holds\ ([0-9]+)\ of\ ([0-9]+) ]]
if [ "${BASH_REMATCH[1]-0}" != "${BASH_REMATCH[2]-all}" ]; then
    echo "runs are missing; the logs of the shards say why, and ./$stem.submit.sh once more "\
        "makes them"
    exit 1
fi
