"""Curves past the peak on finer and finer cells, with softening local and averaged over a length."""

import csv

from . import pipe, rows
from .pipe_sand import NUMERICS

CELLS = (0.125, 0.1, 0.0625, 0.05)  # m, of the biaxial specimen
LENGTHS = (0.125, 0.25, 0.5)  # m; half, one and two times a length
STRAINS = (0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.08, 0.1, 0.12, 0.145)
PER_DIAMETER = (6, 8, 12)
DISPLACEMENTS = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.59)
PIPES = {  # D in m, velocity in m/s, lengths in m
    "500mm": (0.5, 0.6, (0.0625, 0.125, 0.25)),
    "37.5mm": (0.0375, 0.15, (0.004, 0.008, 0.01875)),
}
FEWEST_CELLS = 2  # in a length
TO_THE_PEAK = [round(0.01 * k, 2) for k in range(2, 22)]  # u/D


def fits(length, cell):
    return length >= FEWEST_CELLS * cell * (1 - 1e-9)


def biaxial_jobs():
    """Biaxial compression of the house sand."""
    for cell in CELLS:
        base = {"scene": "biaxial", "sand": "stockton", "cell_size": cell,
                "rest_tolerance": 0.01} | NUMERICS
        yield f"cell{cell}_local", base
        for length in LENGTHS:
            if fits(length, cell):
                yield f"cell{cell}_length{length}", base | {"regularisation_length": length}


def pipe_jobs():
    """The pipe in dense house sand."""
    for name, (diameter, velocity, lengths) in PIPES.items():
        for cells in PER_DIAMETER:
            base = pipe.DOMAIN | NUMERICS | {
                "sand": "stockton", "pipe_diameter": diameter, "pipe_velocity": velocity,
                "sand_void_ratio": 0.524, "pipe_cells_per_diameter": cells,
                "pipe_end_displacement": 0.6}
            yield f"{name}_cells{cells}_local", base
            # A third of D is the shortest that all three grids can carry.
            for length in sorted({*lengths, diameter / 3}):
                if fits(length, diameter / cells):
                    yield f"{name}_cells{cells}_length{length:.4g}", base | {
                        "regularisation_length": length}


def peak_jobs():
    """The small pipe in dense sand around its peak, with the scene's own numerics: lengths, and a
    push at half the speed."""
    base = pipe.AS_IN_INPUT | {"sand_void_ratio": 0.524, "pipe_end_displacement": 0.22}
    for cells in (8, 12, 16):
        for velocity in (0.15, 0.075):
            yield f"cells{cells}_velocity{velocity}_local", base | {
                "pipe_cells_per_diameter": cells, "pipe_velocity": velocity}
        for parts in (4, 2) if cells < 16 else (4,):
            yield f"cells{cells}_velocity0.15_lengthD{parts}", base | {
                "pipe_cells_per_diameter": cells, "pipe_velocity": 0.15,
                "regularisation_length": 0.0375 / parts}


def stress_at(job_dir, strain):
    """Mean of the stress on the plate over 0.005 of axial strain around this one, kPa."""
    with open(job_dir / "history.csv", encoding="utf-8") as file:
        near = [float(row["vertical_stress_Pa"]) / 1e3 for row in csv.DictReader(file)
                if abs(float(row["axial_strain"]) - strain) <= 0.0025 + 1e-9]
    return sum(near) / len(near)


def resistances(job_dir, end):
    places = TO_THE_PEAK if end < DISPLACEMENTS[-1] else DISPLACEMENTS
    return {f"N_d_at_{u}": f"{pipe.resistance_at(job_dir, u):.4g}" for u in places}


def table_row(job, job_dir, options):
    summary = rows.read_json(job_dir / "summary.json")
    row = {"job": job, "length_m": options.get("regularisation_length", 0)}
    if options["scene"] == "biaxial":
        row |= {f"stress_kPa_at_{s}": f"{stress_at(job_dir, s):.5g}" for s in STRAINS}
        row["stress_peak_kPa"] = f"{summary['stress_peak_Pa'] / 1e3:.5g}"
        row["strain_at_peak"] = f"{summary['strain_at_peak']:.4g}"
    else:
        row |= resistances(job_dir, options["pipe_end_displacement"])
    return row | rows.cost(summary) | rows.provenance(options, summary)


STUDIES = {"regularisation_biaxial": biaxial_jobs, "regularisation": pipe_jobs,
           "regularisation_peak": peak_jobs}
RANKS = 1
