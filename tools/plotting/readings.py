"""Peak friction angle against confining pressure under the readings of the sand law, with Bolton's
correlation. usage: python3 -m plotting.readings TABLE PICTURE   (in tools/; docs/data/readings.csv)
"""

import csv
import sys

import matplotlib.pyplot as plt

from . import style

COLOURS = {"normalized": style.RED, "explicit": style.GREEN, "plain": style.ORANGE,
           "lode": style.SKY, "house": style.BLUE}
LABELS = {"normalized": "stockton_paper: $f=x\\,e^{1-x}$, $D$ as printed",
          "explicit": "$D$ without $q$ (explicit)", "plain": r"$f=x\,e^{-x}$ (plain)",
          "lode": "$gD$, $c$ = 0.7075", "house": "stockton: $gD$, $c$ = 0.65, stiffer $K$"}
PACKINGS = {"0.524": "dense", "0.657": "medium"}
TESTS = {"triaxial_compression": "triaxial compression", "plane_strain": "plane strain"}
TICKS = [2, 5, 10, 20, 50, 100, 200, 400, 800]


def read(table):
    with open(table, encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if float(row["cohesion_Pa"]) == 0.0]


def curve(rows, column, **wanted):
    points = sorted((float(row["confining_pressure_kPa"]), float(row[column])) for row in rows
                    if all(row[key] == value for key, value in wanted.items()))
    return zip(*points)


def draw_panel(axes, rows, test, void_ratio, letter):
    for reading, colour in COLOURS.items():
        wanted = {"test": test, "void_ratio": void_ratio, "reading": reading}
        axes.plot(*curve(rows, "peak_angle_deg", **wanted), "o-", ms=3, color=colour,
                  label=LABELS[reading])
    bounds = [list(curve(rows, "bolton_angle_deg", test=test, void_ratio=void_ratio,
                         reading=reading)) for reading in COLOURS]
    pressures = bounds[0][0]
    angles = list(zip(*(bound[1] for bound in bounds)))
    axes.fill_between(pressures, [min(a) for a in angles], [max(a) for a in angles], color="0.8",
                      lw=0.8, zorder=0, label="Bolton, at the $p$ of the peaks")
    axes.set(xscale="log")
    axes.set_xticks(TICKS, [str(tick) for tick in TICKS])
    axes.minorticks_off()
    axes.set_title(f"({letter}) {PACKINGS[void_ratio].capitalize()}, {TESTS[test]}")


def main(arguments):
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    rows = read(arguments[0])
    made, panels = style.figure(2, 2, 17, 15.5, sharex=True, sharey="row")
    letters = iter("abcd")
    for k, void_ratio in enumerate(PACKINGS):
        for j, test in enumerate(TESTS):
            draw_panel(panels[2 * k + j], rows, test, void_ratio, next(letters))
    for panel in panels[2:]:
        panel.set_xlabel("Confining pressure (kPa)")
    for panel in panels[::2]:
        panel.set_ylabel("Peak friction angle (°)")
    style.legend_below(made, panels[0], columns=2, room=0.11)
    made.savefig(arguments[1])
    plt.close(made)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
