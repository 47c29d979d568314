"""The pipe's resistance and the sand: how far the readings of the law spread, and what cells do to
the house reading. Columns up to u/D = 0.9, so that the curves can be drawn from the table."""

import numpy as np

from plotting import pipe_sand as picture
from plotting.run import Run

from . import cell_wave, pipe, pressure, rows

DISPLACEMENTS = [round(0.05 * k, 2) for k in range(1, 18)] + [0.89]
NUMERICS = {"average_volume": "true", "flip_time": 0.001}  # calm pressures, docs/methods.md
SIZES = {  # D in mm: settings
    "37.5": {"pipe_cells_per_diameter": 6, "pipe_velocity": 0.15},
    "500": {"pipe_diameter": 0.5, "pipe_cells_per_diameter": 8, "pipe_velocity": 0.6},
}
PACKINGS = {"dense": 0.524, "medium": 0.657}
# One reading exchanged after the other, from the paper's to the house reading and on.
PAPER = {"sand": "stockton_paper"}
LODE = PAPER | {"sand_dilatancy": "lode"}
EQUAL_ANGLES = LODE | {"sand_c": 0.7075}
READINGS = {
    "paper": PAPER,
    "paper_explicit": PAPER | {"sand_softening": "explicit"},
    "lode_c0.75": LODE,
    "lode_log": EQUAL_ANGLES,
    "lode_power0.3": EQUAL_ANGLES | {"sand_bulk": "power", "sand_bulk_xi": 0.3},
    "lode_power0.7": EQUAL_ANGLES | {"sand_bulk": "power", "sand_bulk_xi": 0.7},
    "lode_poisson0.2": EQUAL_ANGLES | {"sand_bulk": "poisson", "sand_poisson": 0.2},
    "house": {"sand": "stockton"},
}


def base(size, packing):
    return pipe.DOMAIN | NUMERICS | SIZES[size] | {
        "sand_void_ratio": PACKINGS[packing], "pipe_end_displacement": 0.9}


def readings_jobs():
    """Resistance to 0.9 D under each reading."""
    for size in SIZES:
        for packing in PACKINGS:
            for name, reading in READINGS.items():
                yield f"{size}mm_{packing}_{name}", base(size, packing) | reading


def cells_jobs():
    """Resistance to 0.9 D of the scene as it is on finer and finer cells."""
    for cells in (6, 8, 12, 16):
        for size in SIZES:
            for packing in PACKINGS if cells < 16 else ("dense",):
                yield f"{size}mm_{packing}_cells{cells}", pipe.AS_IN_INPUT | SIZES[size] | {
                    "sand_void_ratio": PACKINGS[packing], "pipe_end_displacement": 0.9,
                    "pipe_cells_per_diameter": cells}


def quality(job_dir, options, summary):
    """How calm the answer is: reaction at rest over that of the soil in the pipe's place, wave of
    the cells, scatter of pressures, particles in the pipe."""
    u, N_d = (np.array(pipe.column(job_dir, name), float) for name in ("u_over_D", "N_d"))
    begun = u > 0.025
    at_cells, beside = cell_wave.amplitude(
        u[begun], N_d[begun], 1.0 / options["pipe_cells_per_diameter"])
    run = Run(str(job_dir))
    diameter = run.option("pipe_diameter")
    at_rest = summary["geostatic_N_d"] / summary["geostatic_N_d_expected"]
    row = {"reaction_at_rest_over_exact": f"{at_rest:.4f}", "cell_wave": f"{at_cells:.4f}",
           "waves_beside": f"{beside:.4f}"}
    for displacement in (0.2, 0.9):
        output = pressure.output_at(run, displacement, diameter)
        row[f"scatter_at_{displacement}"] = f"{pressure.scatter(output, diameter):.3g}"
    return row | {"particles_in_pipe_most": summary["particles_in_pipe_most"]}


def table_row(job, job_dir, options):
    summary = rows.read_json(job_dir / "summary.json")
    size, packing, case = job.split("_", 2)
    row = {"diameter_mm": size.removesuffix("mm"), "packing": packing, "case": case}
    row |= {f"N_d_at_{u}": f"{pipe.resistance_at(job_dir, u):.4g}" for u in DISPLACEMENTS}
    row |= {key: summary[key] for key in ("N_df", "u_df_over_D", "u_df_over_D_low",
                                          "u_df_over_D_high") if key in summary}
    row["reaction_difference_rms"] = f"{summary['reaction_difference_rms']:.3g}"
    if case.startswith("cells"):
        row |= quality(job_dir, options, summary)
    row["particles_at_limits_end"] = pipe.column(job_dir, "particles_at_limits")[-1]
    return row | rows.cost(summary) | rows.provenance(options, summary)


def draw(table, pictures):
    """One picture a study: of the readings, or of the cells."""
    name = "pipe_cells" if table[0]["case"].startswith("cells") else "pipe_readings"
    picture.draw(table, pictures / f"{name}.png")


STUDIES = {"pipe_readings": readings_jobs, "pipe_cells": cells_jobs}
RANKS = 2
