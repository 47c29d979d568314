"""What the accuracy of the pipe's resistance costs: one numerical choice at a time around a coarse
base, cell size at the speed of input/pipe.opts, and all of them together in a reference."""

from . import pipe, rows

DISPLACEMENTS = (0.05, 0.1, 0.2, 0.4)
BASE = pipe.HOUSE | {"pipe_end_displacement": 0.405, "pipe_cells_per_diameter": 6, "courant": 0.9}
REFERENCE = BASE | {"pipe_cells_per_diameter": 12, "pipe_velocity": 0.1,
                    "pipe_domain_width": 28, "pipe_domain_depth_below": 20}

# Values besides that of the base: 6 cells per D, velocity 0.2 m/s, ramp 0.02 D, Courant number 0.9,
# 2 particles per direction, far cells 4 times the near ones, cubic splines, gap contact.
VARIATIONS = {
    "pipe_velocity": (0.05, 0.1, 0.15, 0.4, 0.8),
    "pipe_ramp_distance": (0.005, 0.08),
    "courant": (0.3, 0.6, 1.2, 1.5),
    "pipe_cells_per_diameter": (4, 8, 12, 16),
    "particles_per_cell_direction": (1, 3),
    "particles_per_cell_near_pipe": (3,),
    "pipe_far_cell_ratio": (1, 2, 8),
    "basis": ("linear", "gimp", "ddmp", "quadratic"),
    "contact_detection": ("velocity",),
}
DOMAINS = ((7, 6), (14, 8.5), (28, 20))  # width, depth below the invert, in D


def jobs():
    yield "base", BASE
    for option, values in VARIATIONS.items():
        for value in values:
            yield f"{option}_{value}", BASE | {option: value}
    for width, depth in DOMAINS:
        yield f"domain_{width}_{depth}", BASE | {
            "pipe_domain_width": width, "pipe_domain_depth_below": depth}
    yield "reference", REFERENCE


def table_row(job, job_dir, options):
    summary = rows.read_json(job_dir / "summary.json")
    row = {"job": job}
    for u in DISPLACEMENTS:
        row[f"N_d_at_{u}"] = f"{pipe.resistance_at(job_dir, u):.5g}"
    row["particle_updates"] = f"{summary['particles'] * summary['steps']:.4g}"
    return row | rows.cost(summary, "step_loop_s") | rows.provenance(options, summary)


def resistances(rows_of_table, job):
    row = next(row for row in rows_of_table if row["job"] == job)
    return [float(row[f"N_d_at_{u}"]) for u in DISPLACEMENTS]


def reference(rows_of_table):
    """N_d of the reference, each multiplied by the ratio N_d(h -> 0)/N_d(D/12) at the base's speed
    and domain: from D/12 and D/16, as if errors were proportional to h^2. Proportional to h the
    limit would be 2.8 % higher at u/D = 0.05, the same at 0.1 and 1.4 % lower at 0.2."""
    coarse, fine, slow = (resistances(rows_of_table, job) for job in (
        "pipe_cells_per_diameter_12", "pipe_cells_per_diameter_16", "reference"))
    return [c * (b + (b - a) / ((16 / 12) ** 2 - 1)) / a for a, b, c in zip(coarse, fine, slow)]


def finish(rows_of_table):
    """Adds the errors against the reference and a row of the reference itself."""
    limit = reference(rows_of_table)
    for row in rows_of_table:
        for u, exact in zip(DISPLACEMENTS, limit):
            row[f"error_at_{u}"] = f"{float(row[f'N_d_at_{u}']) / exact - 1.0:.4f}"
    extrapolated = dict.fromkeys(rows_of_table[0], "") | {"job": "reference_extrapolated"}
    extrapolated |= {f"N_d_at_{u}": f"{N_d:.5g}" for u, N_d in zip(DISPLACEMENTS, limit)}
    return rows_of_table + [extrapolated]


def draw(rows_of_table, directory):
    from plotting import pipe_cost

    pipe_cost.draw(rows_of_table, directory / "pipe_cost.png")


STUDIES = {"pipe_cost": jobs}
RANKS = 2
