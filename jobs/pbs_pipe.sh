#!/usr/bin/env bash
# qsub [-v CASE=FILE.opts,MINUTES=119,OPTIONS="option value ..."] jobs/pbs_pipe.sh, from the root of the
# checkout, with the program built in build/. qsub's own options override the lines below; with
# another walltime give MINUTES as well. Before these are over the run writes a checkpoint and stops
# with exit code 75; the same command once more goes on from it (docs/restart.md).
#PBS -N mpmsolve
#PBS -l select=1:ncpus=4:mpiprocs=4:mem=4gb
#PBS -l walltime=02:00:00
#PBS -j oe
set -euo pipefail

cd "${PBS_O_WORKDIR:-.}"
ranks=$(wc -l <"$PBS_NODEFILE")
read -ra options <<<"${OPTIONS:-}"

mpirun -np "$ranks" build/mpmsolve -options_file "${CASE:-input/pipe.opts}" -restart auto \
  -wall_time_limit "${MINUTES:-119}" "${options[@]}"
