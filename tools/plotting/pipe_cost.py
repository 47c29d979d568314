"""What the accuracy of the pipe's resistance costs: error against particle updates."""

import matplotlib.pyplot as plt

from . import style

COLOURS = {"pipe_velocity": style.RED, "pipe_cells_per_diameter": style.BLUE,
           "courant": style.GREEN, "domain": style.ORANGE, "basis": style.PURPLE,
           "particles_per_cell_direction": style.SKY, "pipe_far_cell_ratio": style.BLACK,
           "contact_detection": "0.5", "pipe_ramp_distance": "0.7",
           "particles_per_cell_near_pipe": "#7A5230"}
LABELS = {"pipe_velocity": "velocity, m/s", "pipe_cells_per_diameter": "cells per $D$",
          "courant": "Courant number", "domain": "domain, $D$", "basis": "basis",
          "particles_per_cell_direction": "particles per direction",
          "pipe_far_cell_ratio": "far over near cells", "contact_detection": "contact",
          "pipe_ramp_distance": "ramp, $D$",
          "particles_per_cell_near_pipe": "particles near the pipe"}
BAND = 3.0  # per cent


def group_of(job):
    return next((group for group in LABELS if job.startswith(group)), None)


def draw_panel(axes, rows, displacement):
    column = f"error_at_{displacement}"
    base = next(row for row in rows if row["job"] == "base")

    def point(row):
        return float(row["particle_updates"]), 100.0 * float(row[column])

    axes.axhspan(-BAND, BAND, color="0.92", zorder=0)
    for group, colour in COLOURS.items():
        members = [row for row in rows if group_of(row["job"]) == group]
        points = sorted([point(row) for row in members] + [point(base)])
        line = "none" if group == "basis" else "-"
        axes.plot(*zip(*points), linestyle=line, marker="o", ms=3, lw=1, color=colour,
                  label=LABELS[group])
        for row in members:
            axes.annotate(row["job"][len(group) + 1:].replace("_", " × "), point(row), fontsize=5,
                          color=colour, xytext=(2, 2), textcoords="offset points")
    for job, marker in (("base", "s"), ("reference", "*")):
        row = next(row for row in rows if row["job"] == job)
        axes.plot(*point(row), marker, ms=7, color="black", mfc="white", zorder=5, label=job)
    axes.set(xscale="log", xlabel="particle updates", ylabel="error of $N_d$ (%)")
    axes.set_yscale("symlog", linthresh=2 * BAND)
    axes.set_title(f"$u/D$ = {displacement}")


def draw(rows, path):
    rows = [row for row in rows if row["particle_updates"]]
    made, axes = style.figure(2, 2, 26, 20)
    for panel, displacement in zip(axes, ("0.05", "0.1", "0.2", "0.4")):
        draw_panel(panel, rows, displacement)
    style.legend_below(made, axes[0], columns=6)
    made.savefig(path)
    plt.close(made)
