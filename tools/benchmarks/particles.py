"""Time and memory of a step against the number of particles, on one core.

All sizes take turns, so that a machine that gets slower or faster does not bend the curve.
"""

import math

from .common import median_of, provenance, step_cost
from .tables import Table

TABLES = (Table("step_cost", ("particles",),
                ("ns_per_particle", "exponent", "memory_bytes_per_particle")),)

CELLS = (50, 87, 158, 274, 500, 1000)  # 4 particles each
ROUNDS = 3
SECONDS = 0.4
BIG = 1_000_000  # from here on one repetition a round does


def slope(points):
    """Of the line through points by least squares."""
    mean_x, mean_y = (sum(values) / len(points) for values in zip(*points))
    return (sum((x - mean_x) * (y - mean_y) for x, y in points)
            / sum((x - mean_x) ** 2 for x, _ in points))


def measure_rounds(effort):
    """All measurements of each size."""
    sizes = [cells for cells in CELLS if 4 * cells * cells <= effort.largest]
    measured = {cells: [] for cells in sizes}
    for _ in range(min(ROUNDS, effort.rounds)):
        for cells in sizes:
            repetitions = 1 if 4 * cells * cells >= BIG else 3
            measured[cells].append(step_cost(1, 2, cells, 2, repetitions, SECONDS))
    return measured.values()


def measure(effort):
    measured = [{key: median_of(rows, key) for key in ("particles", "step_s", "memory_bytes")}
                for rows in measure_rounds(effort)]
    settings = (f"elastic block in 2D; cubic; MUSL; 2 particles per direction; 1 rank; median of "
                f"{min(ROUNDS, effort.rounds)} turns")
    rows = [{
        "particles": f"{row['particles']:.0f}", "step_ms": f"{1e3 * row['step_s']:.4g}",
        "ns_per_particle": f"{1e9 * row['step_s'] / row['particles']:.1f}", "exponent": "",
        "memory_bytes_per_particle": f"{row['memory_bytes'] / row['particles']:.0f}",
    } for row in measured]
    exponent = slope([(math.log(row["particles"]), math.log(row["step_s"])) for row in measured])
    memory = slope([(row["particles"], row["memory_bytes"]) for row in measured[-2:]])
    rows.append({"particles": "slope", "exponent": f"{exponent:.3f}",
                 "memory_bytes_per_particle": f"{memory:.0f}"})
    return {"step_cost": [row | provenance(settings) for row in rows]}
