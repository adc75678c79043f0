#!/usr/bin/env bash
# One shard of a study per array task:
#
#   jobs=$(sbatch --parsable --array=1-32 deploy/slurm/study.sh scenarios/studies/detection.toml /shared/detection)
#   sbatch --dependency="afterok:$jobs" deploy/slurm/merge.sh /shared/detection
#
# The array must count from 1 without gaps; the folder must be seen by all nodes. A task that was
# cut off (time limit, preemption) goes on where it was when it is queued again.
#SBATCH --job-name=armtwin-study
#SBATCH --cpus-per-task=4
#SBATCH --mem-per-cpu=500M
#SBATCH --time=04:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail

if [ $# -ne 2 ]; then
    echo "usage: sbatch --array=1-N study.sh STUDY.toml FOLDER" >&2
    exit 2
fi
study=$1
folder=$2
shard=${SLURM_ARRAY_TASK_ID:?start this with sbatch --array=1-N}
shards=${SLURM_ARRAY_TASK_COUNT:?start this with sbatch --array=1-N}
if [ "${SLURM_ARRAY_TASK_MIN:-1}" -ne 1 ] || [ "${SLURM_ARRAY_TASK_MAX:-$shards}" -ne "$shards" ]; then
    echo "the array must be 1-N without gaps" >&2
    exit 2
fi

exec "${ARMTWIN:-armtwin}" study "$study" --out "$folder/shards/$shard-of-$shards" \
    --shard "$shard/$shards" --jobs "${SLURM_CPUS_PER_TASK:-1}"
