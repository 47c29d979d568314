"""The scenes with an exact answer, run by the program itself.

usage: exact_scenes.py LAUNCHER PROGRAM RANKS

Bounds are the targets of docs/verification/README.md but for the column's mean error and for hertz,
which has eight times fewer particles here.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROUND_OFF = 1e-12

# Scene, its options, and the largest size of each answer, or the range in which it lies.
BOUNDS = [
    ("patch", {"wall": "roller"}, {"residual_max": ROUND_OFF}),
    ("patch", {"wall": "fixed", "particles_per_cell_direction": 3}, {"residual_max": ROUND_OFF}),
    ("patch", {"grading": 1.2, "placement": "gauss"}, {"residual_max": ROUND_OFF}),
    ("column", {}, {"error_stress_peak": 3e-3, "error_stress_mean": 3e-4}),
    ("rotation", {}, {"error_stress_norm": ROUND_OFF, "error_volume_ratio": ROUND_OFF,
                      "error_angle_rad": 5e-5}),
    ("incline", {}, {"error_slide": 1e-3}),
    ("incline", {"body": "disc", "cells": 20, "elastic_youngs_modulus": 2e7},
     {"error_slide": 1e-2}),
    ("incline", {"body": "disc", "cells": 10, "elastic_youngs_modulus": 5e6,
                 "contact_friction": 0.1}, {"error_slide": 1e-2}),
    *(("gap", {"body": body, "offset": offset, "basis": basis}, {"error_gap_cells": 0.05})
      for body, basis in (("block", "cubic"), ("circle", "cubic"), ("block", "linear"))
      for offset in (0.0, 0.3, 0.55, 0.9)),
    ("hertz", {"cells": 24, "rest_tolerance": 0.02},
     {"error_contact_pressure": 6e-2, "error_contact_half_width": 0.12}),
    ("footing", {"footing_velocity": 0.04}, {"error_bearing_capacity": 3e-2, "plateau_rise": 5e-3}),
    ("mms1d", {"cells": 64}, {"error_displacement_rms": 3e-3}),
    ("vortex", {}, {"error_displacement_rms": 2.1e-2}),
    ("bar", {}, {"energy_ratio": (0.99, 1.01), "error_phase": 5e-3}),
    ("discs", {"courant": 0.9}, {"energy_ratio": (0.95, 1.0), "total_energy_ratio": (0.98, 1.02),
                                 "error_momentum": ROUND_OFF}),
    ("rotation", {"turn": "free"}, {"energy_ratio": (0.98, 1.02), "error_volume_ratio": 1e-4}),
    *(("traction", {"basis": basis},
       {"error_stress_mean": 1e-4, "traction_share_kept": (0.9999, 1.0001)})
      for basis in ("linear", "quadratic", "cubic")),
    *(("reversal", {"cycles": 2, "confining_pressure": 20e3, "amplitude": 0.005,
                    "strain_rate": 0.05, **options},
       {"error_surface": 1e-6, "error_loop_work": 0.01, "error_volume": ROUND_OFF,
        "stress_in_gap_max": ROUND_OFF})
      for options in ({"update": "musl"}, {"update": "usf"},
                      {"sand_cohesion": 700.0, "sand_gap_opening": 1.5e-3})),
    ("collapse", {"cells": 10, "flip_time": 0.1}, {"error_run_out": 0.1}),
]
# A free surface at every tenth of a cell.
CUT_CELL = {"offsets": 10, "increments": 2000}
# One cell, which fits on one rank only.
TRIAXIAL = {"error_q": 2e-4, "error_volumetric_strain": 1e-5, "stress_spread_max": ROUND_OFF,
            "kinetic_energy_over_work_max": 1e-4}
BOUNDS_ON_ONE_RANK = [
    ("triaxial", {"confining_pressure": pressure, "sand_void_ratio": void_ratio}, TRIAXIAL)
    for pressure, void_ratios in ((150e3, (0.551, 0.64, 0.72)), (500e3, (0.574, 0.64, 0.72)))
    for void_ratio in void_ratios
]
SMALLEST_ORDER = 1.9
CELLS_FOR_ORDER = {"mms1d": (32, 64), "vortex": (16, 32)}


class Runs:
    def __init__(self, launcher, program, ranks, base):
        self.command = [launcher, ranks, program, "-progress", "off"]
        self.ranks = int(ranks)
        self.base = pathlib.Path(base)
        self.count = 0

    def summary(self, scene, options):
        self.count += 1
        directory = self.base / str(self.count)
        command = self.command + ["-scene", scene, "-output_dir", str(directory)]
        for name, value in options.items():
            command += [f"-{name}", str(value)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=120)
        return json.loads((directory / "summary.json").read_text(encoding="utf-8"))


class Checks:
    failed = 0

    def check(self, claim, holds, figure):
        print(f"{'ok  ' if holds else 'FAIL'} {claim}: {figure:.3g}")
        self.failed += not holds


def check_bounds(runs, checks):
    for scene, options, bounds in BOUNDS + (BOUNDS_ON_ONE_RANK if runs.ranks == 1 else []):
        summary = runs.summary(scene, options)
        title = " ".join([scene, *(f"-{name} {value}" for name, value in options.items())])
        for answer, bound in bounds.items():
            smallest, largest = bound if isinstance(bound, tuple) else (-bound, bound)
            figure = summary[answer]
            checks.check(f"{title}: {smallest:g} <= {answer} <= {largest:g}",
                         smallest <= figure <= largest, figure)
        checks.check(f"{title}: ranks as asked", summary["ranks"] == runs.ranks, summary["ranks"])
        checks.check(f"{title}: mass stays", abs(summary["mass_change_share"]) <= ROUND_OFF,
                     summary["mass_change_share"])


def check_order(runs, checks):
    for scene, grids in CELLS_FOR_ORDER.items():
        coarse, fine = (runs.summary(scene, {"cells": cells})["error_displacement_rms"]
                        for cells in grids)
        order = math.log2(coarse / fine)
        checks.check(f"{scene}: order >= {SMALLEST_ORDER}", order >= SMALLEST_ORDER, order)


def check_cut_cells(runs, checks):
    """Stable wherever the surface stands, but for the scheme that is known not to be."""
    for options in ({}, {"particles_per_cell_direction": 4}, {"dimension": 2, "cells": 3}):
        summary = runs.summary("cut_cell", {**CUT_CELL, **options})
        checks.check(f"cut_cell {options}: stable everywhere",
                     summary["stable"] == 1 and summary["energy_growth"] < 1.6,
                     summary["energy_growth"])
    summary = runs.summary("cut_cell", {**CUT_CELL, "basis": "linear", "update": "usl",
                                        "courant": 0.9})
    checks.check("cut_cell -basis linear -update usl -courant 0.9: stable nowhere",
                 summary["stable_offsets"] == 0, summary["stable_offsets"])
    # A particle 0.01 cells beyond a line: the limit is close to sqrt(0.02).
    for courant, stable in ((0.12, 1), (0.16, 0)):
        summary = runs.summary("cut_cell", {"basis": "linear", "update": "usl", "offset": 0.26,
                                            "amplitude": 1e-7, "courant": courant})
        checks.check(f"cut_cell -basis linear -update usl -courant {courant}: stable {stable}",
                     summary["stable"] == stable, summary["energy_growth"])


def check_open_knots(runs, checks):
    """The known defect: its residual is there, and the mirrored splines are free of it."""
    figure = runs.summary("patch", {"basis_boundary": "open_knot"})["residual_max"]
    checks.check("patch -basis_boundary open_knot: residual_max >= 0.01", figure >= 0.01, figure)


def main():
    launcher, program, ranks = sys.argv[1:]
    checks = Checks()
    with tempfile.TemporaryDirectory() as base:
        runs = Runs(launcher, program, ranks, base)
        check_bounds(runs, checks)
        check_order(runs, checks)
        check_open_knots(runs, checks)
        check_cut_cells(runs, checks)
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
