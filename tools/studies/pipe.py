"""How the pipe's resistance depends on numerical choices: N_d at given u/D, settings, run time."""

import csv

from . import rows

DISPLACEMENTS = (0.05, 0.1, 0.2)

# What the committed tables were made with; N_d at rest is up to 30 % off with it.
ON_NODES = {"contact_detection": "gap", "geostatic_reaction_tolerance": 1}
# These studies are of numbers, not of the sand.
PAPER_SAND = ON_NODES | {"sand": "stockton_paper", "average_volume": "false", "flip_time": 0}
MEDIUM_500 = PAPER_SAND | {
    "scene": "pipe", "pipe_diameter": 0.5, "sand_void_ratio": 0.657, "pipe_velocity": 0.7,
    "pipe_end_displacement": 0.205, "pipe_far_cell_ratio": 4,
}
DENSE_37 = PAPER_SAND | {
    "scene": "pipe", "pipe_velocity": 0.2, "pipe_end_displacement": 0.205,
    "pipe_far_cell_ratio": 4}
AS_IN_INPUT = {  # the domain of input/pipe.opts, with the scene's own numerics
    "scene": "pipe", "pipe_domain_width": 20, "pipe_domain_depth_below": 14,
    "pipe_far_cell_ratio": 4}
DOMAIN = ON_NODES | AS_IN_INPUT
HOUSE = DENSE_37 | DOMAIN


def contact_jobs():
    """Resistance against cell size for both ways to find contact."""
    for detection, sizes in (("gap", (6, 8, 12, 16)), ("velocity", (6, 8, 12))):
        for cells in sizes:
            yield f"{detection}_{cells}", MEDIUM_500 | {
                "contact_detection": detection, "pipe_cells_per_diameter": cells}
    yield "velocity_gradient_8", MEDIUM_500 | {
        "contact_detection": "velocity", "contact_normal": "gradient",
        "pipe_cells_per_diameter": 8}


def domain_jobs():
    """Resistance against the size of the domain, cells growing to four times the near ones."""
    for width, depth in ((7, 8.5), (14, 6.5), (14, 8.5), (14, 14), (20, 14), (28, 14), (28, 20),
                         (40, 28)):
        yield f"width{width}_depth{depth}", DENSE_37 | {
            "pipe_cells_per_diameter": 6, "pipe_domain_width": width,
            "pipe_domain_depth_below": depth}
    yield "width14_depth8.5_uniform", DENSE_37 | {
        "pipe_cells_per_diameter": 6, "pipe_domain_width": 14, "pipe_domain_depth_below": 8.5,
        "pipe_far_cell_ratio": 1}


def velocity_jobs():
    """Resistance against the loading velocity."""
    for velocity in (0.05, 0.1, 0.2, 0.4):
        yield f"velocity{velocity}", HOUSE | {
            "pipe_cells_per_diameter": 6, "pipe_velocity": velocity}


def courant_jobs():
    """Resistance against the Courant number."""
    for courant in (0.3, 0.6, 0.9, 1.2):
        yield f"courant{courant}", HOUSE | {"pipe_cells_per_diameter": 6, "courant": courant}


def cell_jobs():
    """Resistance of input/pipe.opts against cell size, particles per cell and wall treatment."""
    for cells in (4, 6, 8, 12):
        yield f"cells{cells}", HOUSE | {"pipe_cells_per_diameter": cells}
    yield "cells6_particles3", HOUSE | {
        "pipe_cells_per_diameter": 6, "particles_per_cell_direction": 3}
    yield "cells6_open_knot", HOUSE | {
        "pipe_cells_per_diameter": 6, "basis_boundary": "open_knot",
        "geostatic_stress_tolerance": 0.05}


def savings_jobs():
    """What half a model and a graded far field save, and that they change nothing that counts."""
    coarse = HOUSE | {"pipe_cells_per_diameter": 6, "pipe_end_displacement": 0.205}
    yield "half", coarse
    yield "full", coarse | {"symmetry": "full"}
    yield "uniform", coarse | {"pipe_far_cell_ratio": 1}


def resistance_at(job_dir, displacement):
    """Mean of N_d over the 0.01 in u/D around the displacement."""
    u, N_d = (map(float, column(job_dir, name)) for name in ("u_over_D", "N_d"))
    return rows.mean_near(u, N_d, displacement)


def column(job_dir, name):
    """A column of the history, as text."""
    with open(job_dir / "history.csv", encoding="utf-8") as file:
        return [row[name] for row in csv.DictReader(file)]


def table_row(job, job_dir, options):
    summary = rows.read_json(job_dir / "summary.json")
    row = {"job": job} | {f"N_d_at_{u}": f"{resistance_at(job_dir, u):.4g}" for u in DISPLACEMENTS}
    if options.get("pipe_end_displacement", 0.0) > 0.5:  # far enough for a failure threshold
        row |= {"N_d_at_0.4": f"{resistance_at(job_dir, 0.4):.4g}"}
        row |= {key: summary[key] for key in ("N_df", "u_df_over_D")}
    row["reaction_difference_rms"] = f"{summary['reaction_difference_rms']:.3g}"
    return row | rows.cost(summary) | rows.provenance(options, summary)


STUDIES = {"contact": contact_jobs, "domain": domain_jobs, "velocity": velocity_jobs,
           "courant": courant_jobs, "cells": cell_jobs, "savings": savings_jobs}
RANKS = 2
