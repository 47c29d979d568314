"""fields.png of a scene on a line: its fields over the height x at a few moments."""

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.ticker import MaxNLocator

from . import style
from .custom_bodies import bodies_at

MOMENTS = 5
PROFILES = [
    ("Displacement $u_x$ (mm)", lambda output: 1e3 * output.field("displacement")[:, 0]),
    (r"Axial stress $-\sigma_{xx}$ (kPa)", lambda output: -output.field("stress")[:, 0] / 1e3),
    ("Mean pressure $p$ (kPa)", lambda output: output.field("p") / 1e3),
    ("Deviatoric strain (%)", lambda output: 100 * output.field("deviatoric_strain")),
]
HALO = [effects.withStroke(linewidth=2.0, foreground="white")]


def moments(outputs):
    """A few of them from the first to the last."""
    chosen = np.linspace(0, len(outputs) - 1, MOMENTS).round().astype(int)
    return [outputs[k] for k in sorted(set(chosen))]


def draw_profile(axes, outputs, label, values):
    for shade, output in zip(np.linspace(0.75, 0, len(outputs)), outputs):
        x = output.field("position")[:, 0]
        order = np.argsort(x)
        axes.plot(values(output)[order], x[order], color=str(shade), lw=1.0, marker=".", ms=2,
                  label=f"$t$ = {output.time:.3g} s")
    axes.set(xlabel=label, ylabel="$x$, upward (m)")
    axes.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))


def draw_bodies(axes, run, output):
    limits = axes.get_ylim()
    for body in bodies_at(run, output.attributes):
        axes.axhspan(*sorted(body.outline()), fc="0.88", ec="black", lw=0.8, zorder=0)
    axes.set_ylim(limits)


def name_regions(axes, run, output):
    """Each at the middle of its particles."""
    x, material = output.field("position")[:, 0], output.field("material")
    for k, name in enumerate(run.words("regions")):
        if np.any(material == k):
            axes.text(0.03, x[material == k].mean(), name, fontsize=7, va="center",
                      transform=axes.get_yaxis_transform(), path_effects=HALO)


def draw_borders(axes, output):
    """Between regions."""
    order = np.argsort(output.field("position")[:, 0])
    x, material = output.field("position")[order, 0], output.field("material")[order]
    for k in np.flatnonzero(np.diff(material)):
        axes.axhline(0.5 * (x[k] + x[k + 1]), color="0.6", lw=0.8, ls=":", zorder=0)


def draw(run, outputs):
    outputs = moments(outputs)
    made, panels = style.figure(1, len(PROFILES), 5.2 * len(PROFILES), 9, sharey=True)
    for panel, (label, values) in zip(panels, PROFILES):
        draw_profile(panel, outputs, label, values)
        draw_bodies(panel, run, outputs[-1])
        draw_borders(panel, outputs[-1])
        panel.label_outer()
    name_regions(panels[0], run, outputs[-1])
    style.legend_below(made, panels[0], MOMENTS)
    return [style.save(made, run, "fields.png")]
