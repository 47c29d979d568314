"""curves.png of a scene put together by options: forces on bodies and watched points."""

import numpy as np
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation

from . import style
from .custom_bodies import AXES, cuts, dimension_of
from .run import MissingData

UNITS = {"N_per_m2": "kPa", "N_per_m": "kN/m", "N": "kN"}
WAYS = [("", "impulse", "-"), ("contour_", "contour", "--")]  # by which the force is measured
MAIN = [style.BLACK, style.ORANGE]
COMPONENTS = [[style.BLUE, style.SKY], [style.RED, style.PURPLE], [style.GREEN, "0.5"]]
PLACES = [style.BLUE, style.RED, style.GREEN, style.PURPLE, style.ORANGE, style.SKY, style.BLACK]
SMALLEST = 1e-9  # share of the size of things, below which nothing has moved

LEGEND_BELOW = 0.47  # inches, under the label of the axis


class History:
    """Columns of a run, those of vectors side by side."""

    def __init__(self, run):
        self.columns = run.table("history.csv")
        self.dimension = dimension_of(run)
        self.time, self.restarts = running_on(self.columns["time_s"])
        self.force_unit = next((unit for unit in UNITS for name in self.columns
                                if name.endswith(f"_force_x_{unit}")), "N")

    def vector(self, prefix, unit):
        names = [f"{prefix}_{axis}_{unit}" for axis in AXES[:self.dimension]]
        if any(name not in self.columns for name in names):
            raise MissingData(f"history.csv has no columns {', '.join(names)}")
        return np.column_stack([self.columns[name] for name in names])

    def position(self, name):
        return self.vector(name, "m")

    def force(self, body, way=""):
        """In thousands."""
        return self.vector(f"{body}_{way}force", self.force_unit) / 1e3

    def angle(self, body):
        """Degrees."""
        return np.degrees(self.columns.get(f"{body}_angle_rad", np.zeros_like(self.time)))


def running_on(time):
    """Time that goes on where the clock begins anew, and when it did."""
    steps = np.diff(time)
    anew = steps <= 0
    steps = np.where(anew, time[1:], steps)
    whole = time[0] + np.concatenate([[0.0], np.cumsum(steps)])
    return whole, whole[:-1][anew]


def in_unit(metres):
    """Lengths and their unit, in millimetres where they are small."""
    return (metres, "m") if np.abs(metres).max(initial=0.0) >= 0.1 else (1e3 * metres, "mm")


def way_of(position):
    """Direction to the place farthest from the first, and displacements along it; None for the
    direction where it stands still or its way is curved."""
    moved = position - position[0]
    distance = np.linalg.norm(moved, axis=1)
    farthest = np.argmax(distance)
    if distance[farthest] <= SMALLEST * max(1.0, np.abs(position).max()):
        return None, np.zeros_like(distance)
    direction = moved[farthest] / distance[farthest]
    along = moved @ direction
    straight = np.abs(moved - np.outer(along, direction)).max() < 0.01 * distance[farthest]
    return (direction, along) if straight else (None, distance)


def decorate(axes):
    axes.axhline(0, color="0.75", lw=0.8, zorder=0)
    axes.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    if not axes.get_xlabel().startswith("Time"):
        axes.margins(x=0)
    below = axes.transAxes + ScaledTranslation(0, -LEGEND_BELOW, axes.figure.dpi_scale_trans)
    columns = 2 if len(axes.get_legend_handles_labels()[0]) > 6 else 1
    axes.legend(loc="upper left", bbox_to_anchor=(0, 0), bbox_transform=below, ncol=columns,
                handlelength=2.0, borderaxespad=0, columnspacing=1.2, labelspacing=0.35)


def part_of(run, history, name):
    shares = ["", " (modelled half)", " (modelled quarter)", " (modelled eighth)"]
    return shares[len(cuts(run, history.position(name)[0]))]


def components_to_draw(run, history, name, direction):
    """Directions square to the way; those across a wall of symmetry say nothing of the body."""
    cut = cuts(run, history.position(name)[0])
    return [d for d in range(history.dimension)
            if d not in cut and (direction is None or abs(direction[d]) < 1e-6)]


def draw_components(axes, history, name, abscissa, components):
    for d in components:
        for (way, label, dashes), colour in zip(WAYS, COMPONENTS[d]):
            axes.plot(abscissa, history.force(name, way)[:, d], dashes, color=colour, lw=1.0,
                      label=f"$F_{AXES[d]}$ on the body, {label}")


def draw_moving(axes, run, history, name):
    direction, way = way_of(history.position(name))
    way, unit = in_unit(way)
    if direction is not None:
        for (kind, label, dashes), colour in zip(WAYS, MAIN):
            axes.plot(way, -history.force(name, kind) @ direction, dashes, color=colour,
                      label=f"against the motion, {label}")
    draw_components(axes, history, name, way,
                    components_to_draw(run, history, name, direction))
    axes.set(xlabel=f"Displacement of the body ({unit})",
             ylabel=f"Force of the ground ({UNITS[history.force_unit]})")
    decorate(axes)


def draw_turning(axes, _, history, name):
    for (kind, label, dashes), colour in zip(WAYS, MAIN):
        moment = history.columns[f"{name}_{kind}moment_N_m_per_m"] / 1e3
        axes.plot(history.angle(name), moment, dashes, color=colour,
                  label=f"anticlockwise +, {label}")
    axes.set(xlabel="Angle of the body, anticlockwise + (°)",
             ylabel="Moment of the ground (kN m/m)")
    decorate(axes)
    if history.angle(name).sum() < 0:
        axes.invert_xaxis()


def draw_standing(axes, run, history, name):
    draw_components(axes, history, name, history.time,
                    components_to_draw(run, history, name, None))
    mark_restarts(axes, history)
    axes.set(xlabel="Time (s)", xlim=(0, history.time[-1]),
             ylabel=f"Force of the ground ({UNITS[history.force_unit]})")
    decorate(axes)


def mark_restarts(axes, history):
    for time in history.restarts:
        axes.axvline(time, color="0.6", lw=0.8, ls=":", zorder=0)


def watched(history):
    count = 1
    while f"watch{count}_x_m" in history.columns:
        count += 1
    return [f"watch{k}" for k in range(1, count)]


def draw_watched(axes, _, history, names):
    moved = [history.vector(f"{name}_displacement", "m") for name in names]
    values, unit = in_unit(np.array(moved))
    for k, (name, value) in enumerate(zip(names, values)):
        for d, dashes in zip(range(history.dimension), ("-", "--", ":")):
            axes.plot(history.time, value[:, d], dashes, color=PLACES[k % len(PLACES)], lw=1.1,
                      label=f"{name.replace('watch', 'point ')}, $u_{AXES[d]}$")
    mark_restarts(axes, history)
    axes.set(xlabel="Time (s)", xlim=(0, history.time[-1]), ylabel=f"Displacement ({unit})")
    decorate(axes)


def panels_of(run, history):
    """(title, function that draws it, whose)."""
    panels = []
    for name in run.words("bodies"):
        title = f"{name}{part_of(run, history, name)}"
        moves = np.ptp(history.position(name), axis=0).max() > SMALLEST
        turns = np.ptp(history.angle(name)) > SMALLEST
        panels += [(title, draw_moving, name)] if moves else []
        panels += [(f"{title}: moment", draw_turning, name)] if turns else []
        panels += [] if moves or turns else [(f"{title}, stands still", draw_standing, name)]
    names = watched(history)
    return panels + ([("Watched points", draw_watched, names)] if names else [])


def draw(run):
    history = History(run)
    chosen = panels_of(run, history)
    if not chosen:
        raise MissingData("no curves.png: the scene has neither bodies nor watched points")
    columns = min(3, len(chosen))
    rows = -(-len(chosen) // columns)
    made, panels = style.figure(rows, columns, 8.4 * columns, 9.0 * rows)
    for panel in panels[len(chosen):]:
        panel.set_axis_off()
    for panel, (title, draw_panel, whose) in zip(panels, chosen):
        draw_panel(panel, run, history, whose)
        panel.set_title(title)
    return [style.save(made, run, "curves.png")]
