"""Biaxial compression of the house sand on finer and finer cells, with each particle's own volume
change (the scene's default) and with averaged ones: curves and bands."""

from plotting.run import Run

from . import bands, rows
from .biaxial import CASES
from .regularisation import STRAINS, stress_at

FINER = CASES | {"FF4": (0.05, 2)}  # beyond the paper's four
PACKINGS = {"dense": (0.581, FINER),  # the paper's; it has no other of this test
            "medium": (0.657, ("C4", "M4", "F4"))}
AVERAGED = {"average_volume": "true", "average_volume_share": 0.9}
NUMERICS = {"own": {}, "averaged": AVERAGED}  # -flip_time 0.01 s: 60 to 150 steps
BANDS_AT = (0.075, 0.1)


def job(packing, case, numerics):
    cell, per_direction = FINER[case]
    return {"scene": "biaxial", "sand": "stockton", "sand_void_ratio": PACKINGS[packing][0],
            "cell_size": cell, "particles_per_cell_direction": per_direction} | numerics


def jobs():
    for packing, (_, cases) in PACKINGS.items():
        for case in cases:
            for name, numerics in NUMERICS.items():
                yield f"{packing}_{case}_{name}", job(packing, case, numerics)
    for case in ("M4", "F4"):
        yield f"dense_{case}_averaged-flip0.005", job("dense", case, AVERAGED | {"flip_time": 0.005})


def band_columns(run, strain, cell):
    output = min(run.outputs(), key=lambda output: abs(output.attributes["axial_strain"] - strain))
    angle, thickness = bands.measure(output)
    return {f"band_angle_deg_at_{strain}": f"{angle:.1f}",
            f"band_thickness_m_at_{strain}": f"{thickness:.3f}",
            f"band_thickness_cells_at_{strain}": f"{thickness / cell:.2f}"}


def table_row(name, job_dir, options):
    summary = rows.read_json(job_dir / "summary.json")
    row = dict(zip(("packing", "case", "numerics"), name.split("_")))
    row["stress_peak_kPa"] = f"{summary['stress_peak_Pa'] / 1e3:.5g}"
    row["strain_at_peak"] = f"{summary['strain_at_peak']:.4g}"
    row["stress_residual_kPa"] = f"{summary['stress_residual_Pa'] / 1e3:.5g}"
    row |= {f"stress_kPa_at_{strain}": f"{stress_at(job_dir, strain):.5g}" for strain in STRAINS}
    for strain in BANDS_AT:
        row |= band_columns(Run(str(job_dir)), strain, options["cell_size"])
    row["stress_difference_rms"] = f"{summary['stress_difference_rms']:.3g}"
    return row | rows.cost(summary) | rows.provenance(options, summary)


STUDIES = {"biaxial_cells": jobs}
RANKS = 1
