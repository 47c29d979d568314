"""Pictures of any scene: its history over time and its particles at the last output."""

import numpy as np

from . import style
from .particle_field import triangulate
from .run import MissingData

NOT_CURVES = {"time_s", "step"}
FIELDS = ["displacement", "velocity", "p", "q", "deviatoric_strain", "void_ratio"]
LABELS = {
    "displacement": "Displacement (m)",
    "velocity": "Velocity (m/s)",
    "p": "p (Pa)",
    "q": "q (Pa)",
    "deviatoric_strain": "Deviatoric strain",
    "void_ratio": "Void ratio",
}


def draw_history(run):
    history = run.table("history.csv")
    abscissa = "time_s" if "time_s" in history else next(iter(history))
    curves = [name for name in history if name not in NOT_CURVES | {abscissa}]
    if not curves:
        raise MissingData(f"'{run.path('history.csv')}' has nothing but times")
    columns = min(3, len(curves))
    rows = -(-len(curves) // columns)
    made, panels = style.figure(rows, columns, 6.2 * columns, 4.8 * rows)
    for panel in panels[len(curves):]:
        panel.set_axis_off()
    for panel, name in zip(panels, curves):
        panel.plot(history[abscissa], history[name], color=style.BLACK)
        panel.set(xlabel=abscissa, ylabel=name)
    return [style.save(made, run, "history.png")]


def magnitude(values):
    return np.linalg.norm(values, axis=1) if values.ndim > 1 else values


def widest_plane(position):
    """The two directions in which the particles extend most, in their natural order."""
    return sorted(np.argsort(-np.ptp(position, axis=0), kind="stable")[:2])


def draw_field(axes, position, values):
    """Colours in the plane; a graph where all particles lie on a line."""
    plane = widest_plane(position)
    first, second = position[:, plane].T
    names = ["xyz"[k] + " (m)" for k in plane]
    if np.ptp(second) < 1e-9 * max(np.ptp(first), 1e-300):
        axes.plot(first, values, ".", ms=3, color=style.BLACK)
        axes.set(xlabel=names[0])
        return
    mesh = triangulate(np.column_stack([first, second])) if np.ptp(position[:, 2]) == 0 else None
    if mesh is None:
        shown = axes.scatter(first, second, c=values, s=4, lw=0, cmap="viridis")
    else:
        shown = axes.tripcolor(mesh, values, shading="gouraud", cmap="viridis", rasterized=True)
    axes.set(aspect="equal", xlabel=names[0], ylabel=names[1])
    axes.figure.colorbar(shown, ax=axes, shrink=0.85)


def draw_fields(run):
    output = run.outputs()[-1]
    position = output.field("position")
    fields = [name for name in FIELDS if name in output.names]
    if not fields or not len(position):
        raise MissingData(f"{output.path} has no particle fields to draw")
    columns = min(3, len(fields))
    rows = -(-len(fields) // columns)
    made, panels = style.figure(rows, columns, 6.2 * columns, 5.2 * rows)
    for panel in panels[len(fields):]:
        panel.set_axis_off()
    for panel, name in zip(panels, fields):
        draw_field(panel, position, magnitude(output.field(name)))
        panel.set_title(LABELS[name])
    made.suptitle(f"t = {output.time:.4g} s", fontsize=9)
    return [style.save(made, run, "fields.png")]
