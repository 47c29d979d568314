"""Work and precision: errors against exact solutions, what they cost, by method and resolution.

Every method runs at half its own stability limit (docs/data/stability.csv) and at one common
Courant number. A run that fails is a row without an error.
"""

import csv
import pathlib

from . import rows

COMMON_COURANT = 0.2
LIMITS = pathlib.Path(__file__).resolve().parents[2] / "docs/data/stability.csv"

# Scene, options, cells per unit length or per body, the answer that is the error.
CASES = {
    "mms1d": ({"scene": "mms1d", "amplitude": 0.05}, (16, 32, 64, 128), "error_displacement_rms"),
    "mms1d_small": ({"scene": "mms1d", "amplitude": 0.001}, (16, 32, 64, 128),
                    "error_displacement_rms"),
    "vortex": ({"scene": "vortex", "amplitude": 0.2}, (16, 32, 64), "error_displacement_rms"),
}

# Basis, end treatment, update, transfer.
METHODS = {
    "linear": ("linear", "mirror", "musl", "flip"),
    "gimp": ("gimp", "mirror", "musl", "flip"),
    "ddmp": ("ddmp", "mirror", "musl", "flip"),
    "quadratic": ("quadratic", "mirror", "musl", "flip"),
    "cubic": ("cubic", "mirror", "musl", "flip"),
    "cubic_open": ("cubic", "open_knot", "musl", "flip"),
    "cubic_usl": ("cubic", "mirror", "usl", "flip"),
    "cubic_usf": ("cubic", "mirror", "usf", "flip"),
    "cubic_pic": ("cubic", "mirror", "musl", "pic"),
    "cubic_apic": ("cubic", "mirror", "musl", "apic"),
    "quadratic_apic": ("quadratic", "mirror", "musl", "apic"),
    "gimp_apic": ("gimp", "mirror", "musl", "apic"),
}
KEYS = ("basis", "basis_boundary", "update", "transfer")


def stable_courant(method):
    """The lowest measured limit of a method."""
    with open(LIMITS, encoding="utf-8") as file:
        return min(float(row[limit]) for row in csv.DictReader(file)
                   if tuple(row[key] for key in KEYS) == METHODS[method]
                   for limit in row if limit.startswith("limit_"))


def jobs():
    for case, (options, resolutions, _) in CASES.items():
        for method, words in METHODS.items():
            courants = {"own": round(0.5 * stable_courant(method), 3), "common": COMMON_COURANT}
            for step, courant in courants.items():
                for cells in resolutions:
                    yield f"{case}-{method}-{step}-{cells}", options | dict(zip(KEYS, words)) | {
                        "cells": cells, "courant": courant, "progress": "off"}


def table_row(job, job_dir, options):
    case, method, step, cells = job.split("-")
    summary, failure = (rows.read_json(path) if path.exists() else {}
                        for path in (job_dir / "summary.json", job_dir / "failure.json"))
    row = {"case": case, "method": method, "step": step, "cells": cells,
           "courant": options["courant"], "error": "", "particles": "",
           "steps": failure.get("last_good_step", ""), "step_loop_s": "",
           "failure": failure.get("message", "")}
    if summary:
        row |= {"error": f"{summary[CASES[case][2]]:.4g}", "particles": summary["particles"],
                "steps": summary["steps"], "step_loop_s": f"{summary['step_loop_s']:.3g}"}
    return row | rows.provenance(options, {"git_hash": summary.get("git_hash", "")})


def finish(rows_of_table):
    """Failed runs had as many particles as others of their case and cells."""
    particles = {(row["case"], row["cells"]): row["particles"]
                 for row in rows_of_table if row["particles"]}
    for row in rows_of_table:
        row["particles"] = particles[row["case"], row["cells"]]
    return rows_of_table


STUDIES = {"accuracy": jobs}
RANKS = 1
FAILURES_ARE_ROWS = True


def draw(rows_of_table, directory):
    from plotting import accuracy

    accuracy.draw(rows_of_table, directory / "accuracy.png")
