#!/bin/bash
# Submits a study to Slurm: its shards, and what gathers them. Written by 'jointplay study slurm'.
set -eu
folder=@folder@
stem=@stem@
shards=@shards@

# Options given here go to both jobs. Runs that are there already are not made again, so that
# whatever is missing is made by submitting once more.
cd "$folder"
array=$(sbatch --parsable "$@" "./$stem.array.sh")
array=${array%%;*}
if ! gather=$(sbatch --parsable --dependency="afterany:$array" "$@" "./$stem.gather.sh"); then
    scancel "$array"
    exit 1
fi
echo "array $array of $shards shards, then gather ${gather%%;*}"
