"""The stability map is that of the program, and default steps follow from it.

usage: stability_limits.py LAUNCHER PROGRAM
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

MAP = pathlib.Path(__file__).resolve().parents[2] / "docs/data/stability.csv"
METHOD = ("basis", "basis_boundary", "update", "transfer")
BODY = ("dimension", "particles_per_direction")
LIMITS = ("limit_interior", "limit_fixed_wall", "limit_filled_to_free_end", "limit_free_surface")
MEASURED_AGAIN = ("1", "2")  # dimension, particles per direction
TOLERANCE = 2e-3
ROUNDING = 0.03  # of the limits in the program below those of the map


def measure(command, row, directory):
    words = [word for key in METHOD for word in (f"-{key}", row[key])]
    words += ["-dimension", row["dimension"], "-particles_per_cell_direction",
              row["particles_per_direction"], "-output_dir", directory]
    subprocess.run(command + words, check=True, stdout=subprocess.DEVNULL, timeout=120)
    return json.loads((pathlib.Path(directory) / "summary.json").read_text(encoding="utf-8"))


def main():
    launcher, program = sys.argv[1:]
    command = [launcher, "1", program, "-scene", "stability"]
    with open(MAP, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    failed = 0
    for row in (row for row in rows if tuple(row[key] for key in BODY) == MEASURED_AGAIN):
        with tempfile.TemporaryDirectory() as directory:
            summary = measure(command, row, directory)
        method = tuple(row[key] for key in METHOD)
        differences = [abs(summary[key] - float(row[key])) for key in LIMITS]
        # usf has the limits of musl where both were measured.
        same = [other for other in rows if (other["basis"], other["basis_boundary"]) == method[:2]
                and other["transfer"] == method[3]
                and (other["update"] == "usl") == (method[2] == "usl")]
        lowest = min(float(other[key]) for other in same for key in LIMITS)
        holds = (max(differences) <= TOLERANCE
                 and lowest * (1 - ROUNDING) <= summary["stable_courant"] <= lowest + 1e-3)
        failed += not holds
        print(f"{'ok  ' if holds else 'FAIL'} {' '.join(method)}: {max(differences):.1e} off the "
              f"map, whose lowest limit {lowest:.3f} is {summary['stable_courant']} in the program")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
