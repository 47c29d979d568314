#!/usr/bin/env bash
# sbatch jobs/slurm_pipe.sh [FILE.opts [option value ...]], from the root of the checkout, with the
# program built in build/. Resources are the lines below; sbatch's own options override them.
# Two minutes before the limit the run writes a checkpoint and stops with exit code 75; the same
# command once more goes on from it (docs/restart.md).
#SBATCH --job-name=mpmsolve
#SBATCH --nodes=1
#SBATCH --ntasks=4
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=1G
#SBATCH --time=02:00:00
#SBATCH --signal=B:USR2@120
#SBATCH --output=%x-%j.log
set -euo pipefail

cd "${SLURM_SUBMIT_DIR:-.}"
case=${1:-input/pipe.opts}
[[ $# -eq 0 ]] || shift

# In place of the shell, which would keep the signal to itself.
exec mpirun -np "$SLURM_NTASKS" build/mpmsolve -options_file "$case" -restart auto "$@"
