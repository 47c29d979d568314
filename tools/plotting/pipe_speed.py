"""What the speed of pushing does to the pipe's resistance, and what it costs."""

import matplotlib.pyplot as plt

from . import style
from .pipe_sand import points

COLOURS = (style.BLACK, style.BLUE, style.SKY, style.GREEN, style.ORANGE)


def is_paced(row):
    return row["pushed"].startswith("auto")


def label(row):
    if is_paced(row):
        return f"tolerance {row['pushed'].removeprefix('auto')}"
    return f"{row['pushed']} m/s"


def draw_curves(axes, rows):
    constant = [row for row in rows if not is_paced(row)]
    paced = [row for row in rows if is_paced(row)]
    for kind, dashes in ((constant, "-"), (paced, "--")):
        for row, colour in zip(kind, COLOURS[-len(kind):]):
            axes.plot(*zip((0, 0), *points(row)), dashes, color=colour, lw=1.2, label=label(row))
    axes.set(xlim=(0, 0.3), ylim=(0, None), xlabel="$u/D$", ylabel="$N_d$",
             title=f"$D$ = {rows[0]['diameter_mm']} mm, dense")
    axes.legend(fontsize=7)


def draw_cost(axes, rows):
    for kind, colour, name in ((False, style.BLUE, "constant velocity"),
                               (True, style.ORANGE, "-pipe_velocity auto")):
        costs = [(float(row["steps_to_0.29"]), 100 * float(row["difference_rms_to_0.29"]))
                 for row in rows if is_paced(row) == kind
                 and float(row["difference_rms_to_0.29"]) > 0]
        axes.plot(*zip(*sorted(costs)), "o-", color=colour, label=name)
    axes.set(xscale="log", yscale="log", xlabel="steps to $u/D$ = 0.29",
             ylabel="rms difference from the slowest, %")
    axes.legend(fontsize=7)


def draw(rows, path):
    """Curves above, difference against cost below; a column each size."""
    made, axes = style.figure(2, 2, 22, 17)
    sizes = dict.fromkeys(row["diameter_mm"] for row in rows)
    for column, size in enumerate(sizes):
        chosen = [row for row in rows if row["diameter_mm"] == size]
        draw_curves(axes[column], chosen)
        draw_cost(axes[column + 2], chosen)
    made.savefig(path)
    plt.close(made)
