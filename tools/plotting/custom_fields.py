"""fields.png of a scene put together by options: its ground at the start and at the end, with the
bodies where they are. In space it is a slice; on a line, profiles."""

from dataclasses import dataclass
from functools import partial
from typing import Callable

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from . import custom_profiles, style
from .custom_bodies import bodies_at, dimension_of, domain_of
from .particle_field import triangulate
from .run import MissingData
from .scales import BULK, from_zero

GROUND = ["#E5C89A", "#A9C4D6", "#B7956B", "#9CBF9B", "#D9A193", "#B9A6CC", "#C9C9C9", "#DDD68C"]
HALO = [effects.withStroke(linewidth=2.0, foreground="white")]
HIGHEST, AROUND = 12.0, 3.4  # cm, of axes and of their title, labels and colours
STEPS = [1, 2, 5, 10]  # between ticks
LETTERS = "abcdefghij"


@dataclass
class Field:
    label: str
    units: list  # (size from which on it is used, divisor, name), largest first
    colours: str
    needs: str
    values: Callable
    limits: Callable

    def unit(self, values):
        """Divisor and label that suit the values."""
        size = np.abs(self.limits(values)).max()
        _, divisor, name = next(unit for unit in self.units if size >= unit[0])
        return divisor, self.label + name


def bulk(values):
    low, high = np.quantile(values, BULK)
    return (low, high) if high > low else (low - 1.0, high + 1.0)


FIELDS = [
    Field("Mean pressure $p$", [(1e6, 1e6, " (MPa)"), (0, 1e3, " (kPa)")], "YlGnBu",
          "p", lambda output: output.field("p"), bulk),
    Field("Displacement", [(0.1, 1, " (m)"), (0, 1e-3, " (mm)")], "viridis", "displacement",
          lambda output: np.linalg.norm(output.field("displacement"), axis=1), from_zero),
    Field("Deviatoric strain", [(0.1, 1, ""), (0, 0.01, " (%)")], "magma_r", "deviatoric_strain",
          lambda output: output.field("deviatoric_strain"), from_zero),
]


class Frame:
    """What one output shows in the plane."""

    def __init__(self, run, output, z):
        self.output, self.run = output, run
        position = output.field("position")
        self.seen = slab(run, position, z)
        self.points = position[self.seen, :2]
        shapes = [(body, body.outline(z)) for body in bodies_at(run, output.attributes)]
        self.outlines = {body.name: corners for body, corners in shapes if corners is not None}
        self.mesh = triangulate(self.points, self._in_bodies)
        if self.mesh is None:
            raise MissingData(f"{output.path} has too few particles for a picture")

    def values(self, field):
        return field.values(self.output)[self.seen]

    def materials(self):
        """Of the triangles: that of two of their corners or of the one in the middle."""
        corners = self.output.field("material")[self.seen][self.mesh.get_masked_triangles()]
        return np.sort(corners, axis=1)[:, 1]

    def mesh_of_triangles(self):
        """With corners of their own, so that each has one colour without seams between them."""
        corners = self.points[self.mesh.get_masked_triangles()].reshape(-1, 2)
        return Triangulation(*corners.T, np.arange(len(corners)).reshape(-1, 3))

    def _in_bodies(self, centres):
        inside = np.zeros(len(centres), dtype=bool)
        for corners in self.outlines.values():
            inside |= Path(corners).contains_points(centres)
        return inside


def slab(run, position, z):
    """Particles of the slice: one layer of them as they stood at the start."""
    if z is None:
        return np.ones(len(position), dtype=bool)
    height = thickness(run)
    return (position[:, 2] >= z) & (position[:, 2] < z + height)


def thickness(run):
    lower, upper = domain_of(run)
    try:
        cell = run.option("cell_size")
    except MissingData:
        cell = (upper - lower)[2] / 20
    return cell / run.option("particles_per_cell_direction")


def middle_of(run, output):
    """Height of the slice in space: of the first body's middle, else of the ground's; or None."""
    if dimension_of(run) < 3:
        return None
    bodies = bodies_at(run, output.attributes)
    z = output.field("position")[:, 2]
    middle = bodies[0].position[2] if bodies else 0.5 * (z.min() + z.max())
    return float(np.clip(middle, z.min() - 1e-9, z.max() - thickness(run)))


class View:
    """The ground and the bodies in it, whatever a few particles do."""

    def __init__(self, run, frames):
        points = [np.quantile(frame.points, [0.001, 0.999], axis=0) for frame in frames]
        corners = [c for frame in frames for c in frame.outlines.values()]
        lower, upper = (side[:2] for side in domain_of(run))
        near = np.clip(np.concatenate(points + [c for c in corners if seen_whole(c, lower, upper)]),
                       lower, upper)
        margin = 0.03 * np.ptp(near, axis=0).max()
        self.lower, self.upper = near.min(axis=0) - margin, near.max(axis=0) + margin
        self.width, self.height = self.upper - self.lower
        self.aspect = self.height / self.width
        self.is_high = self.aspect > 0.8
        self.panel_width = 6.0 if self.is_high else 8.4  # cm
        self.axes_width = min(self.panel_width - 1.5, HIGHEST / self.aspect)


def seen_whole(corners, lower, upper):
    """Whether a body is of the size of the domain, no plane that goes on beyond it."""
    return np.ptp(corners, axis=0).max() < 2 * np.linalg.norm(upper - lower)


def draw_bodies(axes, frame, view, named):
    for k, (name, corners) in enumerate(frame.outlines.items()):
        axes.fill(*corners.T, fc="0.88", ec="black", lw=0.9, zorder=3)
        seen = np.clip(corners, view.lower, view.upper)
        if named and np.ptp(seen, axis=0).min() > 0:
            axes.annotate(name, **place_of_name(name, seen, view, k), fontsize=6.5, zorder=4,
                          path_effects=HALO)


def place_of_name(name, seen, view, k):
    """In a body that has room; by turns over and under those that are small."""
    low, high = seen.min(axis=0), seen.max(axis=0)
    middle, size = 0.5 * (low + high), (high - low) * view.axes_width / view.width
    aligned = {"ha": "left" if middle[0] < view.lower[0] + 0.08 * view.width else "center"}
    if size[0] > 0.1 * len(name) and size[1] > 0.3:
        return {"xy": middle, "va": "center", "ha": "center"}
    over = k % 2 == 0 and high[1] < view.upper[1] - 0.08 * view.height
    return {"xy": (middle[0], high[1] if over else low[1]), "va": "bottom" if over else "top",
            "xytext": (0, 2 if over else -2), "textcoords": "offset points", **aligned}


def mark_watched(axes, frame, particles):
    ids = frame.output.field("id")
    for number, particle in enumerate(particles, 1):
        place = frame.output.field("position")[ids == particle, :2]
        if not len(place):
            continue
        axes.plot(*place[0], "o", ms=3.5, mfc="white", mec="black", mew=0.8, zorder=4)
        axes.annotate(str(number), place[0], xytext=(3, 2), textcoords="offset points",
                      fontsize=6.5, path_effects=HALO, zorder=4)


def watched_particles(run, output):
    """Ids of those nearest to the points at the start; none in space, where a slice misses them."""
    dimension = dimension_of(run)
    points = run.numbers("watch").reshape(-1, dimension) if dimension == 2 else []
    position, ids = output.field("position")[:, :dimension], output.field("id")
    return [ids[np.argmin(np.linalg.norm(position - point, axis=1))] for point in points]


def dress(axes, frame, view, shown, label, **colours):
    axes.set(aspect="equal", xlim=(view.lower[0], view.upper[0]),
             ylim=(view.lower[1], view.upper[1]), xlabel="$x$ (m)", ylabel="$y$ (m)")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(6, steps=STEPS))
    return axes.figure.colorbar(shown, ax=axes, location="bottom", label=label, aspect=28,
                                pad=0.02, **colours)


def draw_ground(axes, frame, view, watched):
    """Regions by colour."""
    names = frame.run.words("regions")
    colours = ListedColormap([GROUND[k % len(GROUND)] for k in range(len(names))])
    apart = frame.mesh_of_triangles()
    shown = axes.tripcolor(apart, np.repeat(frame.materials(), 3), shading="gouraud", cmap=colours,
                           vmin=-0.5, vmax=len(names) - 0.5, rasterized=True)
    draw_bodies(axes, frame, view, named=True)
    mark_watched(axes, frame, watched)
    bar = dress(axes, frame, view, shown, "Region", ticks=range(len(names)))
    bar.ax.set_xticklabels(names, rotation=0 if len(names) < 6 else 30)
    bar.ax.tick_params(length=0)


def ends_of(values, limits):
    """Which end of the colours has values beyond it."""
    below, above = values.min() < limits[0], values.max() > limits[1]
    return {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[(below, above)]


def draw_field(axes, frame, view, field, together):
    """`together` are values whose colours it shares."""
    divisor, label = field.unit(together)
    limits = field.limits(together / divisor)
    shown = axes.tripcolor(frame.mesh, frame.values(field) / divisor, shading="gouraud",
                           cmap=field.colours, vmin=limits[0], vmax=limits[1], rasterized=True)
    draw_bodies(axes, frame, view, named=False)
    dress(axes, frame, view, shown, label, extend=ends_of(together / divisor, limits),
          ticks=MaxNLocator(5, steps=STEPS))


def drawings(frames, view):
    """(frame, function of axes), pair by pair: ground and stress at the start and at the end, what
    has come of it at the end only."""
    watched = watched_particles(frames[0].run, frames[0].output)
    made = [(frame, partial(draw_ground, frame=frame, view=view, watched=watched))
            for frame in frames]
    for field in FIELDS:
        shown = frames if field.needs == "p" else frames[-1:]
        if all(field.needs in frame.output.names for frame in shown):
            together = np.concatenate([frame.values(field) for frame in shown])
            made += [(frame, partial(draw_field, frame=frame, view=view, field=field,
                                     together=together)) for frame in shown]
    return made


def sheet(view, count):
    """Figure and axes: pairs side by side, or above each other where the ground is high."""
    pairs = -(-count // 2)
    rows, columns = (2, pairs) if view.is_high else (pairs, 2)
    height = view.axes_width * view.aspect + AROUND
    made, panels = style.figure(rows, columns, view.panel_width * columns + 1, height * rows)
    grid = np.array(panels, dtype=object).reshape(rows, columns)
    return made, list((grid.T if view.is_high else grid).flat)


def draw_plane(run, outputs):
    z = middle_of(run, outputs[0])
    frames = [Frame(run, output, z) for output in outputs]
    view = View(run, frames)
    chosen = drawings(frames, view)
    made, panels = sheet(view, len(chosen))
    for panel in panels[len(chosen):]:
        panel.set_axis_off()
    for letter, panel, (frame, draw_panel) in zip(LETTERS, panels, chosen):
        draw_panel(panel)
        panel.set_title(f"({letter}) $t$ = {frame.output.time:.3g} s")
    if z is not None:
        made.suptitle(f"Slice at $z$ = {z + 0.5 * thickness(run):.4g} m", fontsize=9)
    return [style.save(made, run, "fields.png")]


def draw(run):
    outputs = run.outputs()
    if dimension_of(run) == 1:
        return custom_profiles.draw(run, outputs)
    return draw_plane(run, [outputs[0], outputs[-1]] if len(outputs) > 1 else outputs)
