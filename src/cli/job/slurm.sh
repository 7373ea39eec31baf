#!/bin/bash
# «title» in «parts» tasks of a Slurm array, and a job that joins them. Save this as FILE, in a folder that all nodes share.
#   bash FILE [OPTIONS OF sbatch]   submits the array, and the joining job for when all tasks have succeeded
#   sbatch FILE                     submits the array alone
#   bash FILE merge                 joins the frames now
#SBATCH --job-name=«name»
#SBATCH --array=1-«parts»
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=4
#SBATCH --time=08:00:00
#SBATCH --signal=B:USR1@120
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail

# A task whose program is killed, or fails for a reason that may pass, is queued again, so many times at most; and so is one
# that is out of time. It goes on after the frames that are done.
restarts=5

case "${1:-${SLURM_ARRAY_TASK_ID:+render}}" in
render)
    mkdir -p «folder»
    code=0
    sweeplight «render» --shard auto «threads» \
        --report «prefix»."$SLURM_ARRAY_TASK_ID"-of-«parts».report.json &
    trap 'kill "$!" && wait "$!" || true' USR1
    wait "$!" || code=$?
    case $code in
    # Done; or wrong usage, scenes that cannot be rendered, light that does not converge; or somebody ended it.
    0 | 2 | 4 | 5 | 8 | 130 | 143) exit "$code" ;;
    esac
    if [ "${SLURM_RESTART_COUNT:-0}" -ge "$restarts" ]; then exit "$code"; fi
    echo "sweeplight ended with $code: task $SLURM_ARRAY_TASK_ID is queued again"
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
    # Slurm ends this script when it has heard.
    sleep 60
    exit "$code"
    ;;
merge)
    sweeplight «merge» «reports»
    ;;
*)
    array=$(sbatch --parsable "$@" "$0")
    array=${array%%;*}
    joins=$(sbatch --parsable "$@" --job-name=«name»-merge --dependency="afterok:$array" \
        --kill-on-invalid-dep=yes --wrap="bash $(printf %q "$(realpath "$0")") merge")
    echo "array $array, and job ${joins%%;*} to join its frames"
    ;;
esac
