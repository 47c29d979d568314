"""The look that all pictures share."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# Okabe and Ito's colours, told apart by everybody.
BLACK, ORANGE, SKY, GREEN, BLUE, RED, PURPLE = (
    "#000000", "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7")
CENTIMETRE = 1.0 / 2.54

plt.rcParams.update({
    "figure.dpi": 200,
    "savefig.dpi": 200,
    "font.size": 9,
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "legend.frameon": False,
    "legend.fontsize": 8,
    "lines.linewidth": 1.4,
    "xtick.direction": "out",
    "ytick.direction": "out",
})


def figure(rows, columns, width_cm, height_cm, **options):
    """A constrained-layout figure; the axes always come as a flat list."""
    made, axes = plt.subplots(rows, columns, squeeze=False, layout="constrained",
                              figsize=(width_cm * CENTIMETRE, height_cm * CENTIMETRE), **options)
    return made, list(axes.flat)


def legend_below(made, axes, columns, room=0.06):
    """One legend for the whole figure, under it, in a share of its height."""
    made.legend(*axes.get_legend_handles_labels(), loc="lower center", ncol=columns)
    made.get_layout_engine().set(rect=(0, room, 1, 1 - room))


def save(made, run, name):
    """Writes the picture and returns its path."""
    path = run.path(name)
    made.savefig(path)
    plt.close(made)
    return path
