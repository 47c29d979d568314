"""Strong and weak scaling from one to two ranks, and what two ranks pay to exchange."""

import statistics
import typing

from .common import (CELLS_2D, CELLS_3D, PROGRAMS, median_of, provenance, rows_of, run_on_ranks,
                     step_cost)
from .tables import Table

TABLES = (Table("scaling", ("measure", "dimension", "ranks", "particles"),
                ("ns_per_particle_and_core", "efficiency")),
          Table("exchange", ("measure", "bytes"), ("microseconds",)))


ROUNDS, REPETITIONS = 3, 3


class Job(typing.NamedTuple):
    measure: str
    dimension: int
    ranks: int
    cells: int
    per_direction: int = 2


# Each job on two ranks follows the one on one rank that it is held against. Those named density
# tell the cost of a particle from that of a node.
JOBS = (
    Job("strong", 2, 1, CELLS_2D), Job("strong", 2, 2, CELLS_2D),
    Job("strong", 2, 1, 500), Job("strong", 2, 2, 500),
    Job("strong", 3, 1, CELLS_3D), Job("strong", 3, 2, CELLS_3D),
    Job("weak", 2, 1, 75), Job("weak", 2, 2, CELLS_2D),
    Job("weak", 3, 1, 15), Job("weak", 3, 2, CELLS_3D),
    Job("density", 2, 1, CELLS_2D, 4), Job("density", 3, 1, CELLS_3D, 3),
)


def core_seconds(row):
    """Of all ranks for one particle in one step."""
    return row["step_s"] * row["ranks"] / row["particles"]


def row_of(k, measured):
    """Efficiency is that of two ranks against one, per particle and core."""
    job, rows = JOBS[k], measured[k]
    ns = 1e9 * statistics.median(core_seconds(row) for row in rows)
    efficiency = ""
    if job.ranks == 2:
        pairs = zip(measured[k - 1], rows)
        efficiency = f"{statistics.median(core_seconds(a) / core_seconds(b) for a, b in pairs):.3f}"
    return {"measure": job.measure, "dimension": str(job.dimension), "ranks": str(job.ranks),
            "particles_per_direction": str(job.per_direction),
            "particles": f"{rows[0]['particles']:.0f}",
            "cells_per_side": str(job.cells),
            "step_ms": f"{1e3 * median_of(rows, 'step_s'):.4g}",
            "ns_per_particle_and_core": f"{ns:.1f}", "efficiency": efficiency}


def measure_steps(effort):
    rounds = min(ROUNDS, effort.rounds)
    measured = [[] for _ in JOBS]
    for _ in range(rounds):
        for job, rows in zip(JOBS, measured):
            rows.append(step_cost(job.ranks, job.dimension, job.cells, job.per_direction,
                                  REPETITIONS, effort.seconds / 10))
    settings = f"elastic block; cubic; MUSL; median of {rounds} runs in turns"
    return [row_of(k, measured) | provenance(settings) for k in range(len(JOBS))]


def measure_exchange():
    rows = rows_of(run_on_ranks(2, [PROGRAMS / "exchange"]))
    settings = ("2 ranks in shared memory; median of 25; message one way; halos of "
                f"{CELLS_2D} and 500 cells per side in 2D and {CELLS_3D} in 3D")
    return [row | provenance(settings) for row in rows]


def measure(effort):
    return {"scaling": measure_steps(effort), "exchange": measure_exchange()}
