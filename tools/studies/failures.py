"""Scenes with an exact answer, or a sharp property, by every method: where each fails.

Default steps, half of each method's limit. A run that stops is a row with its reason.
"""

import math

from . import rows
from .accuracy import KEYS, METHODS as CHARTED

METHODS = CHARTED | {
    "linear_usl": ("linear", "mirror", "usl", "flip"),
    "linear_apic": ("linear", "mirror", "musl", "apic"),
    "quadratic_usl": ("quadratic", "mirror", "usl", "flip"),
}

# Options and the answer that is looked at.
SCENES = {
    "patch": ({}, "residual_max"),
    "mms1d": ({"cells": 64}, "error_displacement_rms"),
    "column": ({"cells": 32, "geostatic_tolerance": 1e-6, "max_steps": 200_000},
               "error_stress_mean"),
    "vortex": ({"cells": 32, "amplitude": 0.2}, "error_displacement_rms"),
    "bar": ({}, "energy_ratio"),
    "rotation": ({"turn": "free", "cells": 16}, "error_angular_momentum"),
    "traction": ({}, "error_stress_mean"),
    "discs": ({"cells": 20}, "energy_ratio"),
    "gap": ({}, "error_gap_cells"),
    "footing": ({"cells": 5}, "error_bearing_capacity"),
    "collapse": ({"cells": 10, "max_steps": 200_000}, "error_run_out"),
    "cut_cell": ({}, "energy_growth"),
}


def jobs():
    for scene, (options, _) in SCENES.items():
        for method, words in METHODS.items():
            yield f"{scene}-{method}", {"scene": scene} | options | dict(zip(KEYS, words)) | {
                "progress": "off"}


def table_row(job, job_dir, options):
    scene, method = job.split("-")
    key = SCENES[scene][1]
    row = {"scene": scene, "method": method, "answer": key}
    summary = {"git_hash": ""}
    if (job_dir / "summary.json").exists():
        summary = rows.read_json(job_dir / "summary.json")
        cut = summary.get("steps", 0) >= options.get("max_steps", math.inf)
        row |= {"value": f"{summary[key]:.4g}", "courant": f"{summary.get('courant', 0):.3g}",
                "failure": f"no end in {summary['steps']} steps" if cut else ""}
    else:
        failure = rows.read_json(job_dir / "failure.json")
        row |= {"value": "", "courant": "", "failure": failure.get("message", "stopped")}
    return row | rows.provenance(options, summary)


STUDIES = {"failures": jobs}
RANKS = 1
FAILURES_ARE_ROWS = True
