"""Steps on many ranks as the model has them: parallel efficiency, and what a step is made of."""

import matplotlib.pyplot as plt

from . import style

COLOURS = (style.BLUE, style.SKY, style.GREEN, style.ORANGE, style.PURPLE)
PARTS = {"particles_us": ("particles", style.BLUE), "nodes_us": ("nodes", style.SKY),
         "imbalance_us": ("imbalance", style.ORANGE), "halo_us": ("halos", style.RED),
         "allreduce_us": ("all ranks agree", style.PURPLE)}
HALF = 0.5


def columns(rows, case, *names):
    chosen = [row for row in rows if row["case"] == case]
    return [[float(row[name]) for row in chosen] for name in names]


def scale_of_ranks(axes):
    axes.set_xscale("log", base=2)
    axes.set_xticks([1, 4, 16, 64, 256, 1024], ["1", "4", "16", "64", "256", "1024"])
    axes.set_xlabel("ranks")


def draw_efficiency(axes, rows):
    for case, colour in zip(dict.fromkeys(row["case"] for row in rows), COLOURS):
        axes.plot(*columns(rows, case, "ranks", "efficiency"), marker="o", ms=3, color=colour,
                  label=case)
    axes.axhline(HALF, color="0.8", lw=0.8, zorder=0)
    axes.set(ylim=(0.0, 1.05), ylabel="parallel efficiency")
    axes.legend(loc="lower left")
    scale_of_ranks(axes)


def draw_parts(axes, rows, case):
    for name, (label, colour) in PARTS.items():
        ranks, times = columns(rows, case, "ranks", name)
        shown = [(n, time) for n, time in zip(ranks, times) if time > 0.0]
        if shown:
            axes.plot(*zip(*shown), marker="o", ms=3, color=colour, label=label)
    axes.plot(*columns(rows, case, "ranks", "step_us"), color=style.BLACK, lw=2, label="step")
    axes.set(yscale="log", ylabel="time of a step (µs)")
    axes.set_title(case)
    axes.legend(loc="upper right", ncol=2)
    scale_of_ranks(axes)


def draw(rows, path):
    made, (left, right) = style.figure(1, 2, 24, 9)
    draw_efficiency(left, rows)
    draw_parts(right, rows, rows[0]["case"])
    made.savefig(path)
    plt.close(made)
