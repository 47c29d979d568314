"""python3 -m plotting.biaxial_cells STUDY PICTURE: biaxial compression on finer and finer cells, runs
of tools/study biaxial_cells; the dense specimen with its particles' own volume change and with
averaged ones."""

import pathlib
import sys

import matplotlib.pyplot as plt

from . import biaxial, style
from .run import Run

CASES = ("C4", "M4", "M9", "F4", "FF4")
SHOWN = ("C4", "M4", "F4", "FF4")  # fields
NUMERICS = {"own": "own volume change", "averaged": "averaged volume change"}
AT = 0.1  # axial strain of the fields
LARGEST = 1.0  # deviatoric strain at the end of the colours


def run_of(study, case, numerics):
    return Run(str(study / f"dense_{case}_{numerics}"))


def draw_curves(axes, runs, title):
    biaxial.draw_curves(axes, runs)
    axes.set(ylim=(1000, 1950), xlim=(0, 15), title=title)
    axes.legend(loc="upper right", fontsize=7)


def draw_field(axes, run):
    output = min(run.outputs(), key=lambda output: abs(output.attributes["axial_strain"] - AT))
    shown = biaxial.draw_panel(axes, run, output, "deviatoric_strain", (0.0, LARGEST))
    axes.set_title(f"$h$ = {run.option('cell_size'):g} m", fontsize=7)
    axes.label_outer()
    return shown


def draw(study, path):
    made = plt.figure(figsize=(18.5 * style.CENTIMETRE, 22 * style.CENTIMETRE),
                      layout="constrained")
    rows = made.add_gridspec(3, 1)
    curves = rows[0].subgridspec(1, 2)
    for row, (numerics, title) in enumerate(NUMERICS.items()):
        draw_curves(made.add_subplot(curves[row]),
                    [run_of(study, case, numerics) for case in CASES], title)
        places = rows[row + 1].subgridspec(1, len(SHOWN))
        panels = [made.add_subplot(place) for place in places]
        for panel, case in zip(panels, SHOWN):
            shown = draw_field(panel, run_of(study, case, numerics))
        panels[0].set_ylabel(f"{title}\n$y$ (m)")
        made.colorbar(shown, ax=panels, label="Deviatoric strain", pad=0.01, aspect=25)
    made.savefig(path)
    plt.close(made)


if __name__ == "__main__":
    draw(pathlib.Path(sys.argv[1]), sys.argv[2])
