"""Pictures of biaxial compression: the plate's stress, two watched particles, fields."""

import numpy as np

from . import style
from .particle_field import triangulate
from .run import MissingData
from .scales import from_zero

LONGEST_SIDE = 9  # particle distances: the crossing of the bands stretches more than a free surface
COLOURS = [style.BLACK, style.ORANGE, style.BLUE, style.GREEN, style.RED, style.PURPLE]


def label_of(run):
    """Cell size and particles per cell, as the paper's cases are told apart."""
    per_direction = int(run.option("particles_per_cell_direction"))
    return f"$h$ = {run.option('cell_size'):g} m, {per_direction**2} particles per cell"


def draw_curve(run):
    history = run.table("history.csv")
    strain = 100 * history["axial_strain"]
    made, (stress, points, volume) = style.figure(1, 3, 18.5, 7)
    stress.plot(strain, history["vertical_stress_Pa"] / 1e3, color=style.BLACK, label="contact")
    stress.plot(strain, history["vertical_stress_contour_Pa"] / 1e3, color=style.ORANGE, ls="--",
                lw=1.0, label="momentum balance")
    stress.set(xlabel="Axial strain (%)", ylabel="Vertical stress on the plate (kPa)",
               ylim=(0, None))
    stress.set_title("(a) Reaction by two measures")
    stress.legend(loc="lower right")
    for name, place, colour in (("point1", "Pt.1", style.BLUE), ("point2", "Pt.2", style.RED)):
        points.plot(strain, history[f"{name}_q_Pa"] / 1e3, color=colour, label=place)
        volume.plot(strain, 100 * history[f"{name}_volumetric_strain"], color=colour, label=place)
    points.set(xlabel="Axial strain (%)", ylabel=r"$q$ (kPa)", ylim=(0, None))
    points.set_title("(b) Two particles")
    points.legend(loc="lower right")
    volume.axhline(0, color="0.7", lw=0.8)
    volume.set(xlabel="Axial strain (%)", ylabel="Volumetric strain, compression + (%)")
    volume.set_title("(c) Volume change")
    return [style.save(made, run, "curve.png")]


def watched_places(run):
    """Where the watched particles stood at the start."""
    try:
        x1, y1, x2, y2 = (float(word) for word in str(run.summary["option_biaxial_points"]).split(","))
    except (KeyError, ValueError):
        return {}
    return {"Pt.1": (x1, y1), "Pt.2": (x2, y2)}


def mark_watched(axes, run, output, position):
    start = position - output.field("displacement")
    for name, place in watched_places(run).items():
        particle = np.argmin(np.linalg.norm(start[:, :2] - place, axis=1))
        x, y = position[particle, :2]
        axes.plot(x, y, "o", ms=4, mfc="white", mec="black", mew=0.8)
        axes.annotate(name, (x, y), xytext=(4, 3), textcoords="offset points", fontsize=7)


FIELDS = {
    "deviatoric_strain": ("Deviatoric strain", "magma_r"),
    "void_ratio": ("Void ratio", "RdYlBu_r"),
}


def limits_of(field, outputs):
    values = np.concatenate([output.field(field) for output in outputs])
    if field == "deviatoric_strain":
        return from_zero(values)
    return tuple(np.quantile(values, [0.002, 0.998]))


def draw_panel(axes, run, output, field, limits, marked=False):
    position = output.field("position")
    mesh = triangulate(position[:, :2], longest_side=LONGEST_SIDE)
    if mesh is None:
        raise MissingData(f"{output.path} has too few particles for a picture")
    shown = axes.tripcolor(mesh, output.field(field), shading="gouraud", cmap=FIELDS[field][1],
                           vmin=limits[0], vmax=limits[1], rasterized=True)
    plate = float(output.attributes["plate_y_m"])
    axes.fill_between([-0.8, 0.8], plate, plate + 0.06, color="0.35", lw=0)
    axes.set(aspect="equal", xlim=(-0.85, 0.85), ylim=(-0.02, 2.1), xlabel="$x$ (m)")
    if marked:
        mark_watched(axes, run, output, position)
    return shown


def draw_fields(run):
    """Both fields over the run."""
    outputs = [output for output in run.outputs() if output.attributes["axial_strain"] > 0]
    if not outputs:
        raise MissingData(f"'{run.directory}' has no output under load")
    outputs = outputs[:: max(1, len(outputs) // 4)][-3:] + outputs[-1:]
    outputs = sorted({output.path: output for output in outputs}.values(), key=lambda o: o.path)
    made, panels = style.figure(len(FIELDS), len(outputs), 4.6 * len(outputs) + 1, 13, sharey=True)
    for row, field in enumerate(FIELDS):
        limits = limits_of(field, outputs)
        for column, output in enumerate(outputs):
            axes = panels[row * len(outputs) + column]
            shown = draw_panel(axes, run, output, field, limits, marked=True)
            axes.set_title(rf"$\varepsilon_a$ = {100 * output.attributes['axial_strain']:.1f} %")
        made.colorbar(shown, ax=panels[row * len(outputs):(row + 1) * len(outputs)],
                      label=FIELDS[field][0], shrink=0.9, pad=0.01)
        panels[row * len(outputs)].set_ylabel("$y$ (m)")
    return [style.save(made, run, "fields.png")]


def draw_curves(axes, runs):
    for run, colour in zip(runs, COLOURS):
        history = run.table("history.csv")
        axes.plot(100 * history["axial_strain"], history["vertical_stress_Pa"] / 1e3,
                  color=colour, label=label_of(run))
    axes.set(xlabel="Axial strain (%)", ylabel="Vertical stress on the plate (kPa)",
             xlim=(0, None), ylim=(0, None))
    axes.legend(loc="lower right")


def draw_row(panels, runs, field):
    """One field of all runs at their ends, on one scale."""
    lasts = [run.outputs()[-1] for run in runs]
    limits = limits_of(field, lasts)
    for panel, run, last in zip(panels, runs, lasts):
        shown = draw_panel(panel, run, last, field, limits, marked=run is runs[-1])
        panel.set_title(label_of(run).replace("particles per cell", "p.p.c."), fontsize=7)
        panel.label_outer()
    panels[0].set_ylabel("$y$ (m)")
    panels[0].figure.colorbar(shown, ax=panels, label=FIELDS[field][0], pad=0.01, aspect=25)


def compare(runs):
    """The plate's stress of several runs, and their fields at the end; a figure."""
    runs = sorted(runs, key=lambda run: (-run.option("cell_size"),
                                         run.option("particles_per_cell_direction")))
    made = style.plt.figure(figsize=(18.5 * style.CENTIMETRE, 21.5 * style.CENTIMETRE),
                            layout="constrained")
    rows = made.add_gridspec(1 + len(FIELDS), 1)
    draw_curves(made.add_subplot(rows[0]), runs)
    for row, field in enumerate(FIELDS, start=1):
        cells = rows[row].subgridspec(1, len(runs))
        draw_row([made.add_subplot(cells[k]) for k in range(len(runs))], runs, field)
    return made
