"""fields.png of a scene on a line: its fields over the height x at a few moments."""

import numpy as np

from . import style
from .custom_bodies import bodies_at

MOMENTS = 5
PROFILES = [
    ("Displacement $u_x$ (m)", lambda output: output.field("displacement")[:, 0]),
    (r"Axial stress $-\sigma_{xx}$, compression + (kPa)",
     lambda output: -output.field("stress")[:, 0] / 1e3),
    ("Mean stress $p$, compression + (kPa)", lambda output: output.field("p") / 1e3),
    ("Deviatoric strain", lambda output: output.field("deviatoric_strain")),
]


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
    axes.locator_params(axis="x", nbins=5)


def draw_bodies(axes, run, output):
    limits = axes.get_ylim()
    for body in bodies_at(run, output.attributes):
        axes.axhspan(*sorted(body.outline()), fc="0.88", ec="black", lw=0.8, zorder=0)
    axes.set_ylim(limits)


def draw(run, outputs):
    outputs = moments(outputs)
    made, panels = style.figure(1, len(PROFILES), 5.2 * len(PROFILES), 9, sharey=True)
    for panel, (label, values) in zip(panels, PROFILES):
        draw_profile(panel, outputs, label, values)
        draw_bodies(panel, run, outputs[-1])
        panel.label_outer()
    style.legend_below(made, panels[0], MOMENTS)
    return [style.save(made, run, "fields.png")]
