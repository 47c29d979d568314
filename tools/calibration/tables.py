"""The two files of tools/calibrate: measured tests and their curves."""

import csv
import dataclasses
import math
import re

import numpy as np

MODES = ("triaxial_compression", "triaxial_extension", "plane_strain")
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
# Columns: whether they are needed, lowest and highest value, what is allowed in words.
TESTS = {
    "test": (True, None),
    "mode": (True, None),
    "sigma3_kPa": (True, (0.05, 1e5, "a number from 0.05 to 100000 (kPa)")),
    "void_ratio": (True, (0.2, 2.0, "a number from 0.2 to 2")),
    "phi_peak_deg": (True, (1.0, 85.0, "a number from 1 to 85 (degrees), or nothing")),
    "strain_at_peak": (False, (1e-4, 1.0, "a fraction from 0.0001 to 1, its size, or nothing")),
    "phi_sd_deg": (False, (1e-3, 45.0, "a number from 0.001 to 45 (degrees), or nothing")),
}
CURVES = {
    "test": (True, None),
    "axial_strain": (True, (-0.9, 0.9, "a fraction from -0.9 to 0.9, compression positive")),
    "stress_ratio": (True, (1.0, 1e3, "sigma1/sigma3, at least 1, or nothing")),
    "volumetric_strain": (True, (-0.9, 0.9, "a fraction from -0.9 to 0.9, compression positive, "
                                            "or nothing")),
}
MAY_BE_EMPTY = ("phi_peak_deg", "strain_at_peak", "phi_sd_deg", "stress_ratio",
                "volumetric_strain")


class BadInput(Exception):
    """What the user gave cannot be used; the message says what is allowed."""


@dataclasses.dataclass
class Test:
    """Pressures in Pa, strains logarithmic and compression positive; None where not measured."""

    name: str
    mode: str
    sigma3: float
    void_ratio: float
    phi_peak: float | None
    strain_at_peak: float | None
    phi_sd: float | None
    ratio_curve: np.ndarray  # rows of strain and stress ratio
    volume_curve: np.ndarray  # rows of strain and volumetric strain

    @property
    def direction(self):
        return -1.0 if self.mode == "triaxial_extension" else 1.0

    @property
    def last_strain(self):
        """Size of the largest axial strain at which something was measured."""
        peak = 1.5 * (self.strain_at_peak or 0.0)
        curves = [np.abs(curve[:, 0]).max() for curve in (self.ratio_curve, self.volume_curve)
                  if len(curve)]
        return max([peak] + curves)


class Place:
    """A line of a file, for messages."""

    def __init__(self, path, line):
        self.path, self.line = path, line

    def refuse(self, column, text, allowed):
        raise BadInput(f"{self.path}, line {self.line}, column {column}: '{text}' cannot be used; "
                       f"allowed: {allowed}")

    def number(self, row, column, limits):
        text = (row.get(column) or "").strip()
        if not text and column in MAY_BE_EMPTY:
            return None
        low, high, allowed = limits
        try:
            value = float(text)
        except ValueError:
            self.refuse(column, text, allowed)
        if not low <= value <= high:
            self.refuse(column, text, allowed)
        return value


def read_rows(path, columns):
    """Pairs of place and row; numbers are numbers or None."""
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            lines = [(number, line) for number, line in enumerate(file, 1)
                     if line.strip() and not line.lstrip().startswith("#")]
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{path} cannot be read: {error}") from error
    if len(lines) < 2:
        raise BadInput(f"{path} has no rows; needed is a header with the columns "
                       f"{', '.join(columns)} and at least one row")
    header = [name.strip() for name in next(csv.reader([lines[0][1]]))]
    check_header(Place(path, lines[0][0]), header, columns)
    return [read_row(Place(path, number), header, line, columns) for number, line in lines[1:]]


def check_header(place, header, columns):
    for name in header:
        if name not in columns:
            place.refuse(name, name, "the columns " + ", ".join(columns))
    for name, (needed, _) in columns.items():
        if needed and name not in header:
            raise BadInput(f"{place.path}, line {place.line}: there is no column {name}; needed "
                           f"are {', '.join(key for key in columns if columns[key][0])}")


def read_row(place, header, line, columns):
    cells = next(csv.reader([line]))
    if len(cells) > len(header):
        raise BadInput(f"{place.path}, line {place.line}: {len(cells)} cells for "
                       f"{len(header)} columns")
    row = dict(zip(header, (cell.strip() for cell in cells)))
    for name, (_, limits) in columns.items():
        row[name] = place.number(row, name, limits) if limits else row.get(name, "")
    return place, row


def logarithmic(strain, kind):
    return -math.log1p(-strain) if kind == "engineering" else strain


def read_tests(path, kind):
    """Tests by name, without curves; `kind` of strains is engineering or logarithmic."""
    tests = {}
    for place, row in read_rows(path, TESTS):
        check_names(place, row, tests)
        sign = -1.0 if row["mode"] == "triaxial_extension" else 1.0
        peak = row["strain_at_peak"]
        tests[row["test"]] = Test(
            row["test"], row["mode"], 1000.0 * row["sigma3_kPa"], row["void_ratio"],
            row["phi_peak_deg"], peak and abs(logarithmic(sign * peak, kind)), row["phi_sd_deg"],
            np.empty((0, 2)), np.empty((0, 2)))
    return tests


def check_names(place, row, tests):
    if not NAME.fullmatch(row["test"]):
        place.refuse("test", row["test"], "letters, digits, '.', '_' and '-'")
    if row["test"] in tests:
        place.refuse("test", row["test"], "a name of its own for each test")
    if row["mode"] not in MODES:
        place.refuse("mode", row["mode"], ", ".join(MODES))


def read_curves(path, tests, kind):
    """Gives the tests their curves."""
    ratios, volumes = ({name: [] for name in tests} for _ in range(2))
    for place, row in read_rows(path, CURVES):
        if row["test"] not in tests:
            place.refuse("test", row["test"], "the tests " + ", ".join(tests))
        if row["axial_strain"] * tests[row["test"]].direction < 0.0:
            place.refuse("axial_strain", row["axial_strain"],
                         "the sign of the test: negative in extension, else positive")
        strain = logarithmic(row["axial_strain"], kind)
        if row["stress_ratio"] is not None:
            ratios[row["test"]].append((strain, row["stress_ratio"]))
        if row["volumetric_strain"] is not None:
            volumes[row["test"]].append((strain, logarithmic(row["volumetric_strain"], kind)))
    for name, test in tests.items():
        test.ratio_curve, test.volume_curve = after_start(ratios[name]), after_start(volumes[name])


def after_start(readings):
    """The state at the start is given, not a reading."""
    return np.array([reading for reading in readings if reading[0] != 0.0]).reshape(-1, 2)


def check_measured(tests, path):
    for test in tests.values():
        if test.phi_peak is None and not len(test.ratio_curve) and not len(test.volume_curve):
            raise BadInput(f"{path}: test {test.name} has neither a peak angle nor a curve")
