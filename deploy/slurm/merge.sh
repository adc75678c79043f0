#!/usr/bin/env bash
# Joins the shards that study.sh left in FOLDER/shards to the tables of the whole study in FOLDER.
#SBATCH --job-name=armtwin-merge
#SBATCH --cpus-per-task=1
#SBATCH --mem=4G
#SBATCH --time=01:00:00
set -euo pipefail

if [ $# -ne 1 ]; then
    echo "usage: sbatch merge.sh FOLDER" >&2
    exit 2
fi
exec "${ARMTWIN:-armtwin}" study merge "$1"/shards/*-of-* --out "$1"
