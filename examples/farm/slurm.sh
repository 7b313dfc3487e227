#!/usr/bin/env bash
# Bakes assets/ to baked/ in 8 parts, on nodes that share the working folder:
#
#   mkdir -p reports
#   roughcast plan assets -o baked --json > plan.json
#   sbatch --wait slurm.sh
#   roughcast plan merge plan.json reports/*.json --rest rest.json
#
#SBATCH --job-name=roughcast
#SBATCH --array=0-7
#SBATCH --cpus-per-task=4
#SBATCH --output=reports/%a.log
set -u
cache=${ROUGHCAST_CACHE:-.cache/roughcast}
# Exit code 4 is retried. `--shard /8` takes its index from the array, which has as many tasks as there are parts.
for pause in 5 30 120; do
    roughcast bake --plan plan.json --shard /8 --report "reports/$SLURM_ARRAY_TASK_ID.json" \
        --cache "$cache" --threads "${SLURM_CPUS_PER_TASK:-0}" --quiet
    code=$?
    [ "$code" -eq 4 ] || exit "$code"
    sleep "$pause"
done
exit 4
