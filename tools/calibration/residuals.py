"""Differences between computed and measured tests, each over its standard deviation."""

import dataclasses
import math

import numpy as np

from .element import Failed

FAILED = 1e3  # residual of a test without an answer: the fit turns back


@dataclasses.dataclass(frozen=True)
class Deviations:
    """What one reading can be off by, the law's own shortcomings included."""

    phi: float = 0.5  # degrees
    strain: float = 0.25  # of the logarithm of the strain at the peak
    ratio: float = 0.05  # of the logarithm of the stress ratio
    volume: float = 0.003
    per_curve: int = 8  # readings of a curve are neighbours: it counts like so many


def weight(readings, deviations):
    return math.sqrt(min(1.0, deviations.per_curve / max(readings, 1)))


def of_test(test, response, deviations):
    """Residuals by kind; empty where nothing was measured."""
    if isinstance(response, Failed):
        return {kind: np.full(count, FAILED) for kind, count in counts(test).items()}
    phi, strain = response.peak()
    found = {"phi": [], "strain": [], "ratio": [], "volume": []}
    if test.phi_peak is not None:
        found["phi"] = [(phi - test.phi_peak) / (test.phi_sd or deviations.phi)]
    if test.strain_at_peak is not None:
        found["strain"] = [math.log(strain / test.strain_at_peak) / deviations.strain]
    found["ratio"] = of_ratio(test.ratio_curve, response, deviations)
    found["volume"] = of_volume(test.volume_curve, response, deviations)
    return found


def of_ratio(curve, response, deviations):
    computed = response.at(curve[:, 0], response.ratio)
    return np.log(computed / curve[:, 1]) / deviations.ratio * weight(len(curve), deviations)


def of_volume(curve, response, deviations):
    computed = response.at(curve[:, 0], response.volume)
    return (computed - curve[:, 1]) / deviations.volume * weight(len(curve), deviations)


def counts(test):
    return {"phi": int(test.phi_peak is not None), "strain": int(test.strain_at_peak is not None),
            "ratio": len(test.ratio_curve), "volume": len(test.volume_curve)}


def of_all(tests, responses, deviations):
    parts = [part for test, response in zip(tests, responses)
             for part in of_test(test, response, deviations).values()]
    return np.concatenate([np.asarray(part, dtype=float) for part in parts])


def effective_number(tests, deviations):
    """Readings, those of a curve counted as `per_curve` at most."""
    number = 0
    for test in tests:
        count = counts(test)
        number += count["phi"] + count["strain"]
        number += sum(min(count[kind], deviations.per_curve) for kind in ("ratio", "volume"))
    return number


def rms(values):
    values = [value for value in values if value is not None]
    return math.sqrt(sum(value * value for value in values) / len(values)) if values else None


def comparison(test, response):
    """One test, measured and computed, for tables; None where there is nothing."""
    row = {"test": test.name, "mode": test.mode, "sigma3_kPa": test.sigma3 / 1000.0,
           "void_ratio": test.void_ratio, "phi_measured_deg": test.phi_peak,
           "strain_measured": test.strain_at_peak}
    none = ("phi_computed_deg", "phi_error_deg", "strain_computed", "strain_over_measured",
            "rms_of_ln_stress_ratio", "rms_of_volumetric_strain")
    row |= dict.fromkeys(none) | {"failure": None}
    if isinstance(response, Failed):
        return row | {"failure": str(response)}
    row["phi_computed_deg"], row["strain_computed"] = response.peak()
    if test.phi_peak is not None:
        row["phi_error_deg"] = row["phi_computed_deg"] - test.phi_peak
    if test.strain_at_peak is not None:
        row["strain_over_measured"] = row["strain_computed"] / test.strain_at_peak
    plain = Deviations(ratio=1.0, volume=1.0, per_curve=10**9)
    row["rms_of_ln_stress_ratio"] = rms(of_ratio(test.ratio_curve, response, plain))
    row["rms_of_volumetric_strain"] = rms(of_volume(test.volume_curve, response, plain))
    return row


def overall(rows):
    """Errors over all tests of a group."""
    angles = [row["phi_error_deg"] for row in rows if row["phi_error_deg"] is not None]
    factors = [math.log(row["strain_over_measured"]) for row in rows
               if row["strain_over_measured"]]
    return {
        "tests": len(rows), "failed": sum(row["failure"] is not None for row in rows),
        "phi_rms_deg": rms(angles),
        "phi_mean_error_deg": sum(angles) / len(angles) if angles else None,
        "strain_at_peak_mean_factor": math.exp(sum(factors) / len(factors)) if factors else None,
        "strain_at_peak_largest_factor":
            math.exp(max(abs(factor) for factor in factors)) if factors else None,
        "rms_of_ln_stress_ratio": rms(row["rms_of_ln_stress_ratio"] for row in rows),
        "rms_of_volumetric_strain": rms(row["rms_of_volumetric_strain"] for row in rows),
    }
