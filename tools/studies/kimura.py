"""Strip footings on Toyoura sand in a centrifuge, predicted: nothing is fitted to them.

Measured: Kimura, Kusakabe & Saitoh (1985), Geotechnique 35(1), 33-45, Fig. 9, B = 30 mm at 30 g;
digitised by others, q to 5 kPa (30 kPa against a second reading), s/B to 0.0007. A test is a
letter and its relative density in per cent: V is loaded across the beds, H along them. The law is
isotropic, so that V are the targets.
"""

from plotting import kimura as picture

from . import pipe, rows

# Peak: q in kPa and s/B.
PEAKS = {"V85.6": (1953, 0.0906), "V64.6": (814, 0.0821), "H76.5": (1161, 0.1307),
         "H61.0": (792, 0.2004)}
HALF_WIDTH = 0.015
COMMON = {
    "scene": "custom", "dimension": 2, "domain": "0,-0.3,0.25,0.03",
    "fine_box": "0,-0.06,0.12,0.03", "far_cell_ratio": 4,
    "walls": "symmetry,roller,fixed,free", "gravity": 294.3,
    "average_volume": "true", "flip_time": 0.00016,  # as the pipe's: 0.016 sqrt(B/g)
    "regions": "ground", "region_ground_box": "0,-0.3,0.25,0", "region_ground_material": "sand",
    "region_ground_sand": "toyoura", "region_ground_sand_cohesion": 0, "region_ground_K0": 0.5,
    "bodies": "footing", "body_footing_box": "-0.015,0,0.015,0.03",
    "body_footing_velocity": "0,-0.1", "body_footing_ramp": 0.0003,
    "stages": "push", "stage_push_until": "footing:0.0075",
}
NOT_AVERAGED = {"average_volume": "false"}
LENGTH = {"regularisation_length": 0.005}
BASES = {"rough": {"body_footing_friction_law": "rough"}, "smooth": {"body_footing_friction": 0}}


def case(test, base, cells):
    density = float(test[1:]) / 100.0
    return COMMON | BASES[base] | {"region_ground_sand_relative_density": f"{density:.3f}",
                                   "cell_size": 0.03 / cells}


def jobs():
    for cells in (6, 12):
        for test in ("V85.6", "V64.6"):
            for base in BASES:
                yield f"{test}_{base}_{cells}", case(test, base, cells)
    coarse, fine, finest = (case("V85.6", "rough", cells) for cells in (6, 12, 24))
    yield "V85.6_rough_24", finest
    yield "V85.6_rough_6_slow", coarse | {"body_footing_velocity": "0,-0.05"}
    yield "V85.6_rough_12_slow", fine | {"body_footing_velocity": "0,-0.05"}
    yield "V85.6_rough_6_not averaged", coarse | NOT_AVERAGED
    yield "V85.6_rough_12_not averaged", fine | NOT_AVERAGED
    yield "V85.6_rough_12_length", fine | LENGTH


def curve(job_dir):
    """s/B and q in kPa, which are means since the row before."""
    y, force = ([float(value) for value in pipe.column(job_dir, name)]
                for name in ("footing_y_m", "footing_force_y_N_per_m"))
    return [((y[0] - y_now) / (2 * HALF_WIDTH), force_now / HALF_WIDTH / 1000)
            for y_now, force_now in zip(y, force)]


def table_row(job, job_dir, options):
    test, base, cells, variant = (job + "_").split("_")[:4]
    points = curve(job_dir)
    settlement, peak = max(points, key=lambda point: point[1])
    measured, measured_settlement = PEAKS[test]
    summary = rows.read_json(job_dir / "summary.json")
    row = {"test": test, "base": base, "cells_per_B": cells, "variant": variant,
           "peak_kPa": f"{peak:.0f}", "s_over_B_at_peak": f"{settlement:.3f}",
           "measured_peak_kPa": measured, "measured_s_over_B": measured_settlement,
           "error_pct": f"{100 * (peak / measured - 1):+.0f}"}
    row |= {f"q_kPa_at_{s:.2f}": f"{rows.mean_near(*zip(*points), s):.0f}"
            for s in picture.SETTLEMENTS}
    return row | rows.cost(summary) | rows.provenance(options, summary)


def draw(table, pictures):
    picture.draw(table, pictures / "kimura.png")


STUDIES = {"kimura": jobs}
RANKS = 1
