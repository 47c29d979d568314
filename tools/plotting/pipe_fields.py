"""fields_*.png of the pipe: deviatoric strain, void ratio and displacement at three moments."""

from dataclasses import dataclass
from typing import Callable

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.ticker import MaxNLocator, MultipleLocator

from . import style
from .particle_field import triangulate
from .run import MissingData
from .scales import about_far_field, from_zero

LONGEST_SIDE = 7  # particle distances: under the pipe soil is drawn out sideways by as much

FIRST_MOMENT = 0.06  # the paper's first picture: the wedge
USUAL_THRESHOLD = 0.2
SPIRAL_ANGLES = {36: "--", 43: (0, (1, 1.5))}
HALO = [effects.withStroke(linewidth=2.2, foreground="white", alpha=0.8)]


class View:
    """The part of the soil worth seeing, in units of D, the same for all frames."""

    def __init__(self, pipe_depth):
        self.x = max(3.2, 0.75 * pipe_depth + 1.2) * np.array([-1, 1])
        self.y = np.array([-pipe_depth - 2.8, 1.2])

    def holds(self, points, margin=0.3):
        return ((points[:, 0] > self.x[0] - margin) & (points[:, 0] < self.x[1] + margin)
                & (points[:, 1] > self.y[0] - margin) & (points[:, 1] < self.y[1] + margin))


class Frame:
    """One output in units of D, the origin where the pipe's axis meets the initial ground surface."""

    def __init__(self, run, output, surface, view):
        self.output = output
        self.diameter = run.option("pipe_diameter")
        origin = np.array([output.attributes["pipe_x_m"], surface])
        self.pipe = np.array([0.0, (output.attributes["pipe_y_m"] - surface) / self.diameter])
        self.u_over_D = displacement_of(output) / self.diameter
        self.half = run.summary.get("symmetry", "half") == "half"
        points = (output.field("position")[:, :2] - origin) / self.diameter
        self.seen = view.holds(points)
        self.mesh = triangulate(self._with_mirror(points[self.seen], [-1, 1]), self._in_pipe,
                                LONGEST_SIDE)
        if self.mesh is None:
            raise MissingData(f"{output.path} has too few particles near the pipe for a picture")

    def values(self, field):
        return self._with_mirror(field.values(self)[self.seen], 1)

    def _in_pipe(self, centres):
        return np.linalg.norm(centres - self.pipe, axis=1) < 0.5

    def _with_mirror(self, values, signs):
        return np.concatenate([values, values * signs]) if self.half else values


@dataclass
class Field:
    file: str
    label: str
    colours: str
    needs: str
    values: Callable
    limits: Callable
    contours: bool = False
    spiral: bool = False
    one_scale: bool = False


FIELDS = [
    Field("fields_deviatoric_strain.png", "Deviatoric strain", "magma_r", "deviatoric_strain",
          lambda frame: frame.output.field("deviatoric_strain"), from_zero, spiral=True),
    Field("fields_void_ratio.png", "Void ratio", "RdYlBu_r", "void_ratio",
          lambda frame: frame.output.field("void_ratio"), about_far_field, one_scale=True),
    Field("fields_displacement.png", r"Displacement $|\mathbf{u}|/D$", "viridis", "displacement",
          lambda frame: np.linalg.norm(frame.output.field("displacement"), axis=1)
          / frame.diameter, from_zero, contours=True),
]


def displacement_of(output):
    if "displacement_m" not in output.attributes:
        raise MissingData(f"{output.path} does not say where the pipe is")
    return float(output.attributes["displacement_m"])


def moments(run, outputs):
    """The outputs nearest to the three moments of interest, each once."""
    u = np.array([displacement_of(output) for output in outputs]) / run.option("pipe_diameter")
    wanted = [FIRST_MOMENT, run.value("u_df_over_D") or USUAL_THRESHOLD, u[-1]]
    chosen = sorted({int(np.argmin(np.abs(u - w))) for w in wanted if w <= u[-1] + 0.05})
    moved = [k for k in chosen if u[k] > 0]
    return [outputs[k] for k in (moved or chosen)]


def log_spiral(friction_angle):
    """Slip surface of Prandtl under a footing of width 1 whose right corner is (0.5, 0): from the
    wedge's tip, r = r0 exp(psi tan phi), psi from 0 to 90 degrees (Fig. 14)."""
    phi = np.radians(friction_angle)
    r0 = 0.5 / np.cos(np.pi / 4 + phi / 2)
    psi = np.linspace(0, np.pi / 2, 91)
    direction = np.pi + np.pi / 4 + phi / 2 + psi
    r = r0 * np.exp(psi * np.tan(phi))
    return 0.5 + r * np.cos(direction), r * np.sin(direction)


def draw_spirals(axes, frame):
    for angle, dashes in SPIRAL_ANGLES.items():
        x, y = log_spiral(angle)
        for side in (1, -1):
            # From the springline along the wedge to its tip, then the spiral.
            axes.plot(frame.pipe[0] + side * np.r_[0.5, x], frame.pipe[1] + np.r_[0.0, y],
                      color=style.BLUE, ls=dashes, lw=1.1, path_effects=HALO,
                      label=rf"log-spiral, $\phi = {angle}°$" if side > 0 else None)


def draw_pipe(axes, frame):
    turn = np.linspace(0, 2 * np.pi, 181)
    axes.fill(frame.pipe[0] + 0.5 * np.cos(turn), frame.pipe[1] + 0.5 * np.sin(turn),
              fc="0.92", ec="black", lw=1.0, zorder=3)


def draw_panel(axes, frame, field, limits):
    values = frame.values(field)
    shown = axes.tripcolor(frame.mesh, values, shading="gouraud", cmap=field.colours,
                           vmin=limits[0], vmax=limits[1], rasterized=True)
    levels = np.linspace(*limits, 11)[1:-1]
    if field.contours and values.max() > levels[0]:
        axes.tricontour(frame.mesh, values, levels=levels, colors="white", linewidths=0.5,
                        alpha=0.8)
    draw_pipe(axes, frame)
    if field.spiral:
        draw_spirals(axes, frame)
    axes.set_title(rf"$u/D$ = {frame.u_over_D:.2f}")
    axes.set(aspect="equal", xlabel=r"$x/D$")
    axes.xaxis.set_major_locator(MultipleLocator(2))
    axes.figure.colorbar(shown, ax=axes, location="bottom", label=field.label, aspect=25,
                         pad=0.02, extend="max" if limits[0] == 0.0 else "both",
                         ticks=MaxNLocator(5))


def draw_field(run, frames, view, field):
    values = [frame.values(field) for frame in frames]
    if field.one_scale:
        values = [np.concatenate(values)] * len(frames)
    height = 5.6 * np.ptp(view.y) / np.ptp(view.x) + 2.9
    made, panels = style.figure(1, len(frames), 5.9 * len(frames) + 0.8, height, sharey=True)
    for panel, frame, scale in zip(panels, frames, values):
        draw_panel(panel, frame, field, field.limits(scale))
        panel.set(xlim=view.x, ylim=view.y)
    panels[0].set_ylabel(r"$y/D$ from the initial surface")
    if field.spiral:
        panels[0].legend(loc="upper right", fontsize=6.5, handlelength=2.2, borderpad=0.2,
                          borderaxespad=0.1, labelspacing=0.2)
    return style.save(made, run, field.file)


def draw(run):
    outputs = run.outputs()
    chosen = moments(run, outputs)
    diameter = run.option("pipe_diameter")
    embedment = run.option("pipe_embedment_ratio") * diameter
    start = outputs[0]
    surface = float(start.attributes["pipe_y_m"]) + displacement_of(start) + embedment
    view = View((surface - float(chosen[-1].attributes["pipe_y_m"])) / diameter)
    frames = [Frame(run, output, surface, view) for output in chosen]
    there = set.intersection(*(output.names for output in chosen))
    return [draw_field(run, frames, view, field) for field in FIELDS if field.needs in there]
