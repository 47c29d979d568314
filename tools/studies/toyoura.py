"""Toyoura sand: peaks of the triaxial tests that its constants come from, and of plane-strain
tests that they do not know.

Measured values are cited: F84 is Fukushima & Tatsuoka (1984), Soils and Foundations 24(4), 30-48
(Table 1, and averages of Fig. 17 corrected for the membrane below 20 kPa); T86 Tatsuoka, Sakamoto,
Kawamura & Fukushima (1986), ibid. 26(1), 65-84 (Figs. 9 and 22); L88 Lam & Tatsuoka (1988), ibid.
28(1), 89-106 (Figs. 4 and 8). Those of figures were digitised by others: 0.3 degrees, 0.1 % strain.
"""

import csv
import math

from plotting import toyoura as picture

from . import readings, rows

# kPa, void ratio, peak friction angle in degrees.
TRIAXIAL = {
    "F84": ((50.4, .693, 42.2), (50.3, .727, 40.3), (50.2, .788, 38.0), (50.2, .831, 36.1),
            (99.4, .653, 42.4), (99.5, .671, 42.3), (99.3, .730, 40.1), (99.3, .731, 39.7),
            (99.3, .764, 38.0), (99.3, .803, 36.4), (99.2, .811, 36.8), (99.2, .829, 35.5),
            (99.2, .878, 34.4), (197.3, .655, 41.5), (197.4, .713, 39.4), (197.4, .720, 39.7),
            (197.3, .781, 37.0), (197.2, .829, 35.3), (392, .679, 39.4), (392, .732, 37.9),
            (392, .782, 35.6), (392, .835, 34.7)),
    "F84_corrected": ((4.91, .70, 42.26), (9.8, .70, 42.17), (19.55, .70, 42.02),
                      (4.91, .85, 36.03), (9.8, .85, 35.94), (19.55, .85, 35.81)),
}
# The same and axial strain at the peak in per cent, None where it was not read.
PLANE_STRAIN = {
    "T86": ((4.9, .672, 49.9, None), (4.9, .674, 48.6, 1.14), (4.9, .755, 44.7, 2.04),
            (4.9, .800, 41.3, 2.66), (9.8, .672, 49.9, 1.38), (9.8, .708, 47.8, 2.05),
            (49, .717, 46.7, 2.14), (49, .740, 45.3, 2.16), (98, .653, 49.0, 2.26),
            (98, .692, 47.3, 2.59), (98, .747, 44.1, 2.96), (98, .774, 42.5, 3.34),
            (392, .674, 46.1, 3.61), (392, .713, 44.3, 3.92), (392, .820, 39.6, 5.43)),
    "L88": ((98, .640, 48.58, None), (98, .757, 41.74, None), (98, .799, 40.41, None),
            (98, .803, 39.2, None), (98, .821, 38.85, None), (98, .651, 47.43, None),
            (98, .818, 39.4, None)),
}
# sigma_1/sigma_3 at the strain (per cent) over that at the peak: kPa, void ratio, strain, share.
RESIDUAL = {"T86_fig4a": (4.9, .714, 9.5, .71), "T86_fig8": (4.9, .755, 12.5, .75),
            "T86_fig16a": (49, .716, 11.9, .67), "L88_fig9": (98, .652, 10.98, .75)}
LODE = {"b0": ("triaxial_compression", 41.9), "b1": ("triaxial_extension", 46.6)}
READINGS = {
    "house": {},
    "c0.706": {"sand_c": 0.706},  # equal critical angles in extension
    "c0.681": {"sand_c": 0.681},  # L88's own extension test
    "printed_D": {"sand_dilatancy": "printed"},
    "log_K": {"sand_bulk": "log", "sand_kappa": 0.012},
}
COMMON = {"scene": "material_point", "sand": "toyoura", "sand_cohesion": 0, "strain_end": 0.15,
          "increments": 600}


def tests():
    """Name, kind, pressure, void ratio and what was measured."""
    for source, all_of_it in TRIAXIAL.items():
        for k, (pressure, void_ratio, angle) in enumerate(all_of_it):
            yield f"{source}_{k + 1}", "triaxial_compression", pressure, void_ratio, {
                "measured_deg": angle}
    for source, all_of_it in PLANE_STRAIN.items():
        for k, (pressure, void_ratio, angle, strain) in enumerate(all_of_it):
            yield f"{source}_{k + 1}", "plane_strain", pressure, void_ratio, {
                "measured_deg": angle, "measured_strain_pct": strain}
    for name, (pressure, void_ratio, strain, share) in RESIDUAL.items():
        yield name, "plane_strain", pressure, void_ratio, {
            "residual_at_pct": strain, "measured_residual_share": share}
    for name, (kind, angle) in LODE.items():
        yield f"L88_{name}", kind, 98, 0.70, {"measured_deg": angle}


MEASURED = {name: measured for name, _, _, _, measured in tests()}


def jobs():
    for reading, options in READINGS.items():
        for name, kind, pressure, void_ratio, _ in tests():
            yield f"{reading}:{name}", COMMON | options | {
                "test": kind, "confining_pressure": 1000 * pressure, "sand_void_ratio": void_ratio}


def stress_ratio(row):
    """Largest over smallest principal stress."""
    stresses = [float(row[f"stress_{k}_Pa"]) for k in ("xx", "yy", "zz")]
    return max(stresses) / min(stresses)


def table_row(job, job_dir, options):
    reading, name = job.split(":")
    with open(job_dir / "history.csv", encoding="utf-8") as file:
        history = list(csv.DictReader(file))
    ratios = [stress_ratio(row) for row in history]
    strains = [-100.0 * math.expm1(-abs(float(row["axial_strain"]))) for row in history]
    peak = ratios.index(max(ratios))
    measured = MEASURED[name]
    summary = rows.read_json(job_dir / "summary.json")
    row = {"reading": reading, "test": name, "kind": options["test"],
           "pressure_kPa": options["confining_pressure"] / 1000,
           "void_ratio": options["sand_void_ratio"],
           "measured_deg": measured.get("measured_deg"),
           "computed_deg": f"{math.degrees(math.asin((ratios[peak] - 1) / (ratios[peak] + 1))):.2f}",
           "bolton_deg": f"{readings.bolton(summary, float(history[peak]['p_Pa']) / 1000)[1]:.2f}",
           "computed_dilatancy": f"{readings.dilatancy(history[peak - 1], history[peak + 1]):.3f}",
           "measured_strain_pct": measured.get("measured_strain_pct"),
           "computed_strain_pct": f"{strains[peak]:.2f}",
           "measured_residual_share": measured.get("measured_residual_share")}
    later = next((k for k, strain in enumerate(strains)
                  if strain >= measured.get("residual_at_pct", 10.0)), -1)
    row["computed_residual_share"] = f"{ratios[later] / ratios[peak]:.3f}"
    return row | rows.provenance(options, summary)


def draw(table, pictures):
    picture.draw(table, pictures / "toyoura.png")
    for reading in READINGS:
        print(picture.verdict([row for row in table if row["reading"] == reading]))


STUDIES = {"toyoura": jobs}
RANKS = 1
