"""Biaxial compression with the paper's four combinations of cells and particles."""

from . import readings, rows

CASES = {"C4": (0.125, 2), "M4": (0.1, 2), "M9": (0.1, 3), "F4": (0.0625, 2)}
STRAINS = {"stress_peak_kPa": "stress_peak_Pa", "stress_residual_kPa": "stress_residual_Pa"}


def paper_jobs(sand="stockton_paper"):
    for case, (cell, per_direction) in CASES.items():
        yield case, {"scene": "biaxial", "sand": sand, "cell_size": cell,
                     "particles_per_cell_direction": per_direction}


def house_jobs():
    """The same four cases with the house reading of the sand."""
    return paper_jobs("stockton")


def reading_jobs():
    """Case M4 under the readings of the law."""
    for reading, sand in readings.READINGS.items():
        yield reading, {"scene": "biaxial"} | sand


def numerics_jobs():
    """Case M4 of the paper's sand with other numerical choices, one at a time."""
    house = {"scene": "biaxial", "sand": "stockton_paper"}
    yield "house", house
    for flip_time in (1e9, 0.1, 0.003):
        yield f"flip_time{flip_time:g}", house | {"flip_time": flip_time}
    yield "open_knot", house | {"basis_boundary": "open_knot"}
    yield "quadratic", house | {"basis": "quadratic"}
    yield "linear", house | {"basis": "linear"}
    yield "velocity0.1", house | {"biaxial_velocity": 0.1}
    yield "courant0.3", house | {"courant": 0.3}
    yield "smooth_plate", house | {"contact_friction": 0}


def table_row(job, job_dir, options):
    summary = rows.read_json(job_dir / "summary.json")
    row = {"job": job}
    for name, key in STRAINS.items():
        row[name] = f"{summary[key] / 1e3:.5g}"
    row["strain_at_peak"] = f"{summary['strain_at_peak']:.4g}"
    row["stress_difference_rms"] = f"{summary['stress_difference_rms']:.3g}"
    return row | rows.cost(summary) | rows.provenance(options, summary)


STUDIES = {"biaxial": paper_jobs, "biaxial_house": house_jobs, "biaxial_readings": reading_jobs,
           "biaxial_numerics": numerics_jobs}
RANKS = 2
