"""fields.png of a scene put together by options: its ground at the start and at the end, with the
bodies where they are. In space it is a slice; on a line, profiles."""

from dataclasses import dataclass
from typing import Callable

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator

from . import custom_profiles, style
from .custom_bodies import AXES, bodies_at, dimension_of, domain_of
from .particle_field import triangulate
from .run import MissingData
from .scales import BULK, from_zero

GROUND = ["#E5C89A", "#A9C4D6", "#B7956B", "#9CBF9B", "#D9A193", "#B9A6CC", "#C9C9C9", "#DDD68C"]
HALO = [effects.withStroke(linewidth=2.0, foreground="white")]
LETTERS = "abcdefghij"


@dataclass
class Field:
    label: str
    colours: str
    needs: str
    values: Callable
    limits: Callable


def bulk(values):
    low, high = np.quantile(values, BULK)
    return (low, high) if high > low else (low - 1.0, high + 1.0)


PRESSURE = Field("Mean stress $p$, compression + (kPa)", "YlGnBu", "p",
                 lambda output: output.field("p") / 1e3, bulk)
DISPLACEMENT = Field("Displacement (m)", "viridis", "displacement",
                     lambda output: np.linalg.norm(output.field("displacement"), axis=1),
                     from_zero)
STRAIN = Field("Deviatoric strain", "magma_r", "deviatoric_strain",
               lambda output: output.field("deviatoric_strain"), from_zero)


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
        corners = self.output.field("material")[self.seen][self.mesh.triangles]
        return np.sort(corners, axis=1)[:, 1]

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
        width, height = self.upper - self.lower
        self.aspect = height / width

    def holds(self, point):
        return np.all((point > self.lower) & (point < self.upper))


def seen_whole(corners, lower, upper):
    """Whether a body is of the size of the domain, no plane that goes on beyond it."""
    return np.ptp(corners, axis=0).max() < 2 * np.linalg.norm(upper - lower)


def draw_bodies(axes, frame, view, named):
    for name, corners in frame.outlines.items():
        axes.fill(*corners.T, fc="0.88", ec="black", lw=0.9, zorder=3)
        clipped = np.clip(corners, view.lower, view.upper)
        middle = 0.5 * (clipped.min(axis=0) + clipped.max(axis=0))
        if named and view.holds(middle):
            axes.annotate(name, middle, ha="center", va="center", fontsize=6.5, zorder=4,
                          path_effects=HALO)


def dress(axes, frame, view, title, named=False):
    draw_bodies(axes, frame, view, named)
    axes.set(aspect="equal", xlim=(view.lower[0], view.upper[0]),
             ylim=(view.lower[1], view.upper[1]), xlabel="$x$ (m)", ylabel="$y$ (m)")
    axes.set_title(title)


def draw_ground(axes, frame, view, title):
    """Regions by colour."""
    names = frame.run.words("regions")
    colours = [GROUND[k % len(GROUND)] for k in range(len(names))]
    axes.tripcolor(frame.mesh, facecolors=frame.materials(), cmap=ListedColormap(colours),
                   vmin=-0.5, vmax=len(names) - 0.5, rasterized=True)
    dress(axes, frame, view, title, named=True)
    axes.legend(handles=[Patch(fc=c, label=name) for c, name in zip(colours, names)],
                loc="upper center", bbox_to_anchor=(0.5, -0.22), ncol=4, borderaxespad=0)


def ends_of(values, limits):
    """Which end of the colours has values beyond it."""
    below, above = values.min() < limits[0], values.max() > limits[1]
    return {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[(below, above)]


def draw_field(axes, frame, view, title, field, limits):
    values = frame.values(field)
    shown = axes.tripcolor(frame.mesh, values, shading="gouraud", cmap=field.colours,
                           vmin=limits[0], vmax=limits[1], rasterized=True)
    dress(axes, frame, view, title)
    axes.figure.colorbar(shown, ax=axes, location="bottom", label=field.label, aspect=28,
                         pad=0.02, extend=ends_of(values, limits), ticks=MaxNLocator(5))


def drawings(frames):
    """(caption, function of axes, frame, view and title, frame), pair by pair."""
    moments = ["first output", "last output"][-len(frames):]
    there = set.intersection(*(frame.output.names for frame in frames))
    made = [("Ground, " + moment, draw_ground, frame) for moment, frame in zip(moments, frames)]
    if "p" in there:
        limits = bulk(np.concatenate([frame.values(PRESSURE) for frame in frames]))
        made += [("Mean stress, " + moment, of_field(PRESSURE, limits), frame)
                 for moment, frame in zip(moments, frames)]
    for field, caption in ((DISPLACEMENT, "Displacement"), (STRAIN, "Deviatoric strain")):
        if field.needs in there:
            limits = field.limits(frames[-1].values(field))
            made.append((f"{caption}, last output", of_field(field, limits), frames[-1]))
    return made


def of_field(field, limits):
    return lambda axes, frame, view, title: draw_field(axes, frame, view, title, field, limits)


def sheet(view, count):
    """Figure and axes: pairs side by side, or above each other where the ground is high."""
    pairs = -(-count // 2)
    rows, columns = (pairs, 2) if view.aspect < 0.8 else (2, pairs)
    width = 8.4 if rows == pairs else 6.0
    height = min(width * view.aspect, 12.0)
    made, panels = style.figure(rows, columns, width * columns + 1, (height + 3.0) * rows)
    grid = np.array(panels, dtype=object).reshape(rows, columns)
    return made, list((grid if columns == 2 else grid.T).flat)


def draw_plane(run, outputs):
    z = middle_of(run, outputs[0])
    frames = [Frame(run, output, z) for output in outputs]
    view = View(run, frames)
    chosen = drawings(frames)
    made, panels = sheet(view, len(chosen))
    for panel in panels[len(chosen):]:
        panel.set_axis_off()
    for letter, panel, (caption, draw_it, frame) in zip(LETTERS, panels, chosen):
        draw_it(panel, frame, view, f"({letter}) {caption}, $t$ = {frame.output.time:.3g} s")
    if z is not None:
        made.suptitle(f"Slice at {AXES[2]} = {z + 0.5 * thickness(run):.4g} m", fontsize=9)
    return [style.save(made, run, "fields.png")]


def draw(run):
    outputs = run.outputs()
    if dimension_of(run) == 1:
        return custom_profiles.draw(run, outputs)
    return draw_plane(run, [outputs[0], outputs[-1]] if len(outputs) > 1 else outputs)
