"""python3 -m plotting.turned UPRIGHT TURNED PICTURE: deviatoric strain around a pipe in ground that
stands upright and turned against the grid, two runs of tools/study pipe_turned, turned back."""

import sys

import matplotlib.pyplot as plt
import numpy as np

from . import style
from .run import Run

REACH = 4.0  # D from the pipe's first place
MOMENTS = (0.3, 1.0)  # of the way
LARGEST = (0.3, 1.5)  # strain at the end of the colours


def upright(run, output):
    """Positions and pipe in D, turned so that gravity acts downward."""
    diameter = 2.0 * run.numbers("body_pipe_ball")[2]
    angle = np.radians(run.option("gravity_angle"))
    back = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    pipe = np.array([float(output.attributes[f"pipe_{axis}_m"]) for axis in "xy"])
    return (output.field("position")[:, :2] @ back.T / diameter, back @ pipe / diameter)


def draw_panel(axes, run, output, largest):
    position, pipe = upright(run, output)
    near = np.abs(position).max(axis=1) < REACH
    points = axes.scatter(*position[near].T, c=output.field("deviatoric_strain")[near], s=6,
                          marker="s", lw=0, vmin=0, vmax=largest, cmap="magma_r")
    axes.add_patch(plt.Circle(pipe, 0.5, fc="0.9", ec="0"))
    axes.set(aspect="equal", xlim=(-REACH, REACH), ylim=(-REACH, REACH))
    return points


def nearest(run, share):
    outputs = list(run.outputs())
    last = outputs[-1].time
    return min(outputs, key=lambda output: abs(output.time - share * last))


def draw(directories, path):
    made, axes = style.figure(2, 2, 18, 17)
    for row, (share, largest) in enumerate(zip(MOMENTS, LARGEST)):
        for column, (directory, name) in enumerate(zip(directories, ("upright", "turned by 20°"))):
            run = Run(directory)
            panel = axes[2 * row + column]
            points = draw_panel(panel, run, nearest(run, share), largest)
            panel.set_title(name)
        made.colorbar(points, ax=axes[2 * row + 1], label="Deviatoric strain", extend="max")
    for panel in axes[2:]:
        panel.set_xlabel("$x/D$")
    for panel in axes[::2]:
        panel.set_ylabel("$y/D$ from the pipe's first axis")
    made.savefig(path)
    plt.close(made)


if __name__ == "__main__":
    draw(sys.argv[1:3], sys.argv[3])
