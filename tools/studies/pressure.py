"""How much the particles' pressures scatter under the pipe, and what cures it at what cost."""

import numpy as np

from plotting.run import Run

from . import pipe, rows

DISPLACEMENTS = (0.1, 0.2, 0.4, 0.9)
NEIGHBOURHOOD = 0.3  # D, over which the smooth field is fitted
BASE = pipe.HOUSE | {"pipe_cells_per_diameter": 6, "pipe_end_displacement": 0.9}


def jobs():
    yield "none", BASE
    yield "flip_time0.01", BASE | {"flip_time": 0.01}
    yield "flip_time0.001", BASE | {"flip_time": 0.001}
    yield "average_volume", BASE | {"average_volume": "true"}
    yield "both0.01", BASE | {"average_volume": "true", "flip_time": 0.01}
    yield "both0.001", BASE | {"average_volume": "true", "flip_time": 0.001}
    yield "particles3", BASE | {"particles_per_cell_direction": 3}
    yield "quadratic", BASE | {"basis": "quadratic"}
    yield "apic", BASE | {"transfer": "apic"}


def smooth_value(offsets, values):
    """At the origin of a quadratic fitted to the neighbours."""
    x, y = offsets.T
    terms = np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y])
    return np.linalg.lstsq(terms, values, rcond=None)[0][0]


def scatter(output, diameter):
    """Rms of p about the smooth field over its mean, within the wedge: closer than 0.75 D to the
    pipe, below its axis, no farther than 0.5 D to the side."""
    position, p = output.field("position")[:, :2], output.field("p")
    axis = float(output.attributes["pipe_y_m"])
    distance = np.hypot(position[:, 0], position[:, 1] - axis) - 0.5 * diameter
    wedge = (distance < 0.75 * diameter) & (position[:, 1] < axis) & (
        np.abs(position[:, 0]) < 0.5 * diameter)
    everywhere = np.concatenate([position, position * [-1, 1]])  # with the mirrored half
    values = np.concatenate([p, p])
    smooth = []
    for x in position[wedge]:
        offsets = (everywhere - x) / (NEIGHBOURHOOD * diameter)
        near = np.hypot(*offsets.T) < 1.0
        smooth.append(smooth_value(offsets[near], values[near]))
    return np.sqrt(np.mean((p[wedge] - smooth) ** 2)) / np.mean(smooth)


def output_at(run, displacement, diameter):
    return min(run.outputs(), key=lambda output: abs(
        float(output.attributes["displacement_m"]) / diameter - displacement))


def table_row(job, job_dir, options):
    summary = rows.read_json(job_dir / "summary.json")
    run = Run(str(job_dir))
    diameter = run.option("pipe_diameter")
    row = {"job": job}
    for u in DISPLACEMENTS:
        row[f"scatter_at_{u}"] = f"{scatter(output_at(run, u, diameter), diameter):.3g}"
    for u in (0.05, 0.1, 0.2, 0.4):
        row[f"N_d_at_{u}"] = f"{pipe.resistance_at(job_dir, u):.4g}"
    row["N_d_end"] = f"{summary['N_d_end']:.4g}"
    return row | rows.cost(summary, "step_loop_s") | rows.provenance(options, summary)


STUDIES = {"pressure_scatter": jobs}
RANKS = 2
