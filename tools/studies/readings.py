"""Strength of the sand under the readings of its equations, next to Bolton's correlation.

Bolton (1986): phi = phi_c + 3 I_R in triaxial compression and + 5 I_R in plane strain, with
I_R = D_r (10 - ln p') - 1 between 0 and 4, p' in kPa at the peak, and -deps_v/deps_1 = 0.3 I_R.
"""

import csv
import math

from .rows import provenance, read_json

PAPER = {"sand": "stockton_paper"}
READINGS = {
    "normalized": PAPER,
    "plain": PAPER | {"sand_softening": "plain"},
    "explicit": PAPER | {"sand_softening": "explicit"},
    "lode": PAPER | {"sand_dilatancy": "lode", "sand_c": 0.7075},
    "house": {"sand": "stockton"},
}
PACKINGS = {"dense": 0.524, "medium": 0.657}
TESTS = ("triaxial_compression", "plane_strain")
PRESSURES = (2, 5, 10, 20, 50, 100, 200, 400, 800)  # kPa
LOW_PRESSURES = (2, 5, 10)  # kPa, where the pipes' cohesion matters
ANGLE_FACTOR = {"triaxial_compression": 3.0, "triaxial_extension": 3.0, "plane_strain": 5.0}
COMMON = {"scene": "material_point", "strain_end": 2, "increments": 2000}


def jobs():
    for reading, sand in READINGS.items():
        for test in TESTS:
            for packing, void_ratio in PACKINGS.items():
                for cohesion, pressures in ((0, PRESSURES), (1000, LOW_PRESSURES)):
                    for pressure in pressures:
                        yield f"{reading}_{test}_{packing}_{pressure}kPa_c{cohesion}", COMMON | {
                            "test": test} | sand | {
                            "sand_void_ratio": void_ratio, "sand_cohesion": cohesion,
                            "confining_pressure": 1000 * pressure}


def friction_angle(row, shift):
    """Degrees, from the in-plane principal stresses moved by `shift`, Pa."""
    major, minor = float(row["stress_yy_Pa"]) + shift, float(row["stress_xx_Pa"]) + shift
    return math.degrees(math.asin((major - minor) / (major + minor)))


def critical_ratio(row, summary):
    """M at the Lode angle of the row, Eq. 16."""
    c = summary["option_sand_c"]
    sin3theta = math.sin(math.radians(3 * float(row["lode_angle_deg"])))
    root = math.sqrt((1 + c * c) ** 2 + 4 * c * (1 - c * c) * sin3theta)
    return summary["option_sand_Mc"] * 2 * c * (1 + c) / (root + 1 + c * c)


def state(row, summary, shift):
    """q/p* over M, and the state parameter."""
    p_star = float(row["p_Pa"]) + shift
    critical = summary["option_sand_e_Gamma"] - summary["option_sand_lambda_c"] * math.log(
        p_star / 1000)
    return (float(row["q_Pa"]) / p_star / critical_ratio(row, summary),
            float(row["void_ratio"]) - critical)


def bolton(summary, p_kPa):
    """I_R and the peak angle in degrees."""
    Mc = summary["option_sand_Mc"]
    e_max, e_min = summary["option_sand_e_max"], summary["option_sand_e_min"]
    density = (e_max - summary["option_sand_void_ratio"]) / (e_max - e_min)
    index = min(max(density * (10 - math.log(p_kPa)) - 1, 0.0), 4.0)
    phi_c = math.degrees(math.asin(3 * Mc / (6 + Mc)))
    return index, phi_c + ANGLE_FACTOR[summary["option_test"]] * index


def dilatancy(before, after):
    """-deps_v/deps_1."""
    volume = float(after["volumetric_strain"]) - float(before["volumetric_strain"])
    return -volume / (float(after["axial_strain"]) - float(before["axial_strain"]))


def residual_share(rows, peak, shift, strain=0.15):
    """sigma_1/sigma_3 at an axial strain over that at the peak."""
    ratios = [(float(row["stress_yy_Pa"]) + shift) / (float(row["stress_xx_Pa"]) + shift)
              for row in rows]
    later = next(k for k, row in enumerate(rows) if float(row["axial_strain"]) >= strain - 1e-9)
    return ratios[later] / ratios[peak]


def table_row(job, job_dir, options):
    summary = read_json(job_dir / "summary.json")
    with open(job_dir / "history.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    shift = summary["option_sand_cohesion"]
    peak = max(range(1, len(rows) - 1), key=lambda k: friction_angle(rows[k], shift))
    at_peak, at_30, end = rows[peak], rows[len(rows) * 3 // 20], rows[-1]
    index, correlation = bolton(summary, float(at_peak["p_Pa"]) / 1000)
    ratio_30, psi_30 = state(at_30, summary, shift)
    ratio_end, psi_end = state(end, summary, shift)
    return {
        "reading": job.split("_", 1)[0], "test": summary["option_test"],
        "void_ratio": summary["option_sand_void_ratio"],
        "cohesion_Pa": f"{shift:g}",
        "confining_pressure_kPa": f"{summary['option_confining_pressure'] / 1000:g}",
        "peak_angle_deg": f"{friction_angle(at_peak, shift):.2f}",
        "peak_angle_of_total_stress_deg": f"{friction_angle(at_peak, 0.0):.2f}",
        "bolton_angle_deg": f"{correlation:.2f}",
        "residual_share": f"{residual_share(rows, peak, shift):.3f}",
        "strain_at_peak": f"{float(at_peak['axial_strain']):.4f}",
        "p_at_peak_kPa": f"{float(at_peak['p_Pa']) / 1000:.4g}",
        "dilatancy_at_peak": f"{dilatancy(rows[peak - 1], rows[peak + 1]):.3f}",
        "bolton_dilatancy": f"{0.3 * index:.3f}",
        "stress_ratio_over_M_at_0.3": f"{ratio_30:.4f}", "psi_at_0.3": f"{psi_30:.4f}",
        "stress_ratio_over_M_at_2": f"{ratio_end:.5f}", "psi_at_2": f"{psi_end:.5f}",
    } | provenance(options, summary)


STUDIES = {"readings": jobs}
RANKS = 1
