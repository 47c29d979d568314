#!/usr/bin/python3
"""law_cost.py LAWS.json SHARES.csv COMMIT: joins what the two benchmarks measured to one table.

Ratios are to the linear elastic law of the same run, so that the machine hardly matters.
"""

import csv
import json
import sys

COLUMNS = ("measure", "case", "law_ns_per_particle", "ratio_to_elastic", "step_ns_per_particle",
           "share_of_step", "plastic_share", "settings", "commit")


def updates(path):
    """Median time of one update in nanoseconds, by case."""
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    medians = {b["run_name"].removesuffix("/manual_time"): b for b in report["benchmarks"]
               if b.get("aggregate_name") == "median"}
    if not medians:
        sys.exit(f"{path}: no medians; run law_bench with --benchmark_repetitions=9")
    return {case: 1e9 / b["items_per_second"] for case, b in medians.items()}, \
        next(iter(medians.values()))["repetitions"]


def update_rows(path):
    times, repetitions = updates(path)
    settings = f"4096 particles; CPU time; median of {repetitions} repetitions"
    for case, time in sorted(times.items()):
        yield {"measure": "update", "case": case, "law_ns_per_particle": f"{time:.1f}",
               "ratio_to_elastic": f"{time / times['elastic']:.1f}", "settings": settings}


def step_rows(path):
    settings = "20000 particles; 5000 cells; plane strain; 1 rank; CPU time; median of 9 times 30 steps"
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    elastic = next(float(r["law_ns_per_particle"]) for r in rows if r["law"] == "elastic")
    for row in rows:
        law, step = float(row["law_ns_per_particle"]), float(row["step_ns_per_particle"])
        yield {"measure": "step", "case": row["law"], "law_ns_per_particle": f"{law:.1f}",
               "ratio_to_elastic": f"{law / elastic:.1f}", "step_ns_per_particle": f"{step:.0f}",
               "share_of_step": f"{law / step:.2f}", "plastic_share": row["plastic_share"],
               "settings": settings}


def main():
    laws, shares, commit = sys.argv[1:]
    writer = csv.DictWriter(sys.stdout, COLUMNS, restval="", lineterminator="\n")
    writer.writeheader()
    for row in (*update_rows(laws), *step_rows(shares)):
        writer.writerow(row | {"commit": commit})


main()
