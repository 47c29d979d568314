"""What the parts share: running programs, this machine, and statistics."""

import csv
import functools
import io
import json
import os
import pathlib
import statistics
import subprocess
import sys
import typing

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build-bench"
PROGRAMS = BUILD / "tests/bench"
RESULTS = BUILD / "results"

CELLS_2D, CELLS_3D = 106, 19  # 44,944 and 54,872 particles at two per direction


class Effort(typing.NamedTuple):
    """How long is measured."""
    rounds: int     # of interleaved runs
    seconds: float  # of a run's step loop
    largest: int    # particles


FULL = Effort(rounds=5, seconds=3.5, largest=4_000_000)
QUICK = Effort(rounds=1, seconds=0.3, largest=100_000)


def run(command, directory=ROOT):
    """Output of a program, whose failure ends everything with what it said."""
    done = subprocess.run([str(word) for word in command], cwd=directory, text=True,
                          capture_output=True, check=False)
    if done.returncode:
        sys.exit(f"tools/bench: {' '.join(map(str, command))} failed with exit code "
                 f"{done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def run_on_ranks(ranks, command, directory=ROOT):
    return run([ROOT / "tools/mpi", ranks, *command], directory)


def rows_of(text):
    return list(csv.DictReader(io.StringIO(text)))


def simulate(ranks, options, more=(), log=None):
    """summary.json of a run of the program, and the log of PETSc's events where wanted."""
    directory = BUILD / "runs"
    directory.mkdir(exist_ok=True)
    command = [BUILD / "mpmsolve", *options, *more, "-progress", "off", "-output_dir", "run"]
    if log:
        command += ["-log_view", f":{log}:ascii_csv"]
    run_on_ranks(ranks, command, directory)
    return json.loads((directory / "run/summary.json").read_text(encoding="utf-8"))


def step_cost(ranks, dimension, cells, per_direction, repetitions, seconds):
    """What step_cost measured, as numbers."""
    text = run_on_ranks(ranks, [PROGRAMS / "step_cost", dimension, cells, per_direction,
                                repetitions, seconds])
    return {key: float(value) for key, value in rows_of(text)[0].items()}


def median_of(rows, key):
    return statistics.median(row[key] for row in rows)


@functools.cache
def commit():
    describe = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--abbrev=12"]
    done = subprocess.run(describe, text=True, capture_output=True, check=False)
    return done.stdout.strip() or "unknown"


@functools.cache
def machine():
    """Processor and cores, without the name of the host."""
    done = subprocess.run(["lscpu"], text=True, capture_output=True, check=False,
                          env=os.environ | {"LC_ALL": "C"})
    fields = dict(line.split(":", 1) for line in done.stdout.splitlines() if ":" in line)
    model = fields.get("Model name", "unknown processor").strip()
    return f"{model}; {os.cpu_count()} cores"


def provenance(settings):
    return {"settings": f"{settings}; {machine()}", "commit": commit()}
