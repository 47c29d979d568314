#!/usr/bin/env bash
# qsub [-v CASE=FILE.opts,OPTIONS="option value ..."] jobs/pbs_pipe.sh, from the root of the
# checkout, with the program built in build/. qsub's own options override the lines below.
#PBS -N mpmsolve
#PBS -l select=1:ncpus=4:mpiprocs=4:mem=4gb
#PBS -l walltime=02:00:00
#PBS -j oe
set -euo pipefail

cd "${PBS_O_WORKDIR:-.}"
ranks=$(wc -l <"$PBS_NODEFILE")
read -ra options <<<"${OPTIONS:-}"

mpirun -np "$ranks" build/mpmsolve -options_file "${CASE:-input/pipe.opts}" "${options[@]}"
