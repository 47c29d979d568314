"""What each law costs, which share of a step it takes, and what empty cells cost, on one core.

Ratios are to the linear elastic law of the same run, so that the machine hardly matters.
"""

import json
import sys

from .common import BUILD, PROGRAMS, provenance, rows_of, run, run_on_ranks
from .tables import Table

TABLES = (Table("law_cost", ("measure", "case"), ("law_ns_per_particle", "step_ns_per_particle",
                                                  "share_of_step")),
          Table("empty_cells", ("cells", "cells_with_empty_ones"), ("time_ratio_median",)))

REPETITIONS = 9


def updates():
    """Median time of one update in nanoseconds, by case; interleaved, so that a disturbance does
    not hit one law only."""
    path = BUILD / "laws.json"
    run([PROGRAMS / "law_bench", f"--benchmark_repetitions={REPETITIONS}",
         "--benchmark_min_time=0.02", "--benchmark_enable_random_interleaving=true",
         "--benchmark_report_aggregates_only=true", f"--benchmark_out={path}",
         "--benchmark_out_format=json"])
    report = json.loads(path.read_text(encoding="utf-8"))
    times = {b["run_name"].removesuffix("/manual_time"): 1e9 / b["items_per_second"]
             for b in report["benchmarks"] if b.get("aggregate_name") == "median"}
    if not times:
        sys.exit(f"tools/bench: {path} has no medians")
    return times


def update_rows():
    times = updates()
    settings = f"4096 particles; CPU time; median of {REPETITIONS} repetitions"
    for case, time in sorted(times.items()):
        yield {"measure": "update", "case": case, "law_ns_per_particle": f"{time:.1f}",
               "ratio_to_elastic": f"{time / times['elastic']:.1f}"} | provenance(settings)


def step_rows():
    settings = ("20000 particles; 5000 cells; plane strain; 1 rank; CPU time; median of 9 times "
                "30 steps")
    rows = rows_of(run_on_ranks(1, [PROGRAMS / "step_share"]))
    elastic = next(float(r["law_ns_per_particle"]) for r in rows if r["law"] == "elastic")
    for row in rows:
        law, step = float(row["law_ns_per_particle"]), float(row["step_ns_per_particle"])
        yield {"measure": "step", "case": row["law"], "law_ns_per_particle": f"{law:.1f}",
               "ratio_to_elastic": f"{law / elastic:.1f}", "step_ns_per_particle": f"{step:.0f}",
               "share_of_step": f"{law / step:.2f}",
               "plastic_share": row["plastic_share"]} | provenance(settings)


def empty_cells_rows():
    rows = rows_of(run_on_ranks(1, [PROGRAMS / "empty_cells"]))
    return [row | provenance("40000 particles; 1 rank; CPU time; median of 15 times 10 steps")
            for row in rows]


def measure(_effort):
    return {"law_cost": [*update_rows(), *step_rows()], "empty_cells": empty_cells_rows()}
