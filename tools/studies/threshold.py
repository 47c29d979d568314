"""How often the interval of the failure threshold holds the truth, on curves that are known.

The program draws curves, puts scatter on them and reads them with the code that reads the runs;
this only passes its tables on. Coverage and widths are means over the curves of a row.
"""

import csv
import subprocess

CURVES = 120
PROGRAM = "threshold_coverage"
STUDIES = {"threshold_coverage": dict}


def table(build, argument):
    run = subprocess.run([str(build / "tests" / PROGRAM), str(argument)], check=True,
                         capture_output=True, text=True)
    return list(csv.DictReader(run.stdout.splitlines()))


def make_rows(build):
    return table(build, CURVES)


def draw(_, pictures):
    from plotting import threshold  # needs Matplotlib, which the table does not
    threshold.draw(table(pictures.parents[1] / "build", "examples"),
                   pictures / "threshold_reading.png")
