"""calibration.png: measured and computed tests."""

import matplotlib as mpl
import numpy as np
from matplotlib.lines import Line2D

from plotting import style

from .element import Failed

MARKERS = {"triaxial_compression": "o", "triaxial_extension": "v", "plane_strain": "s"}
CURVE_COLOURS = [style.BLUE, style.GREEN, style.RED, style.PURPLE, style.ORANGE, style.SKY,
                  style.BLACK]


def draw(answer, path):
    """`answer` has pairs of test and response, fitted and predicted. A row of curves for each of
    the two that has any, then peak angles."""
    groups = [("fitted", answer.fitted_pairs), ("predicted", answer.predicted_pairs)]
    groups = [(what, with_curves(pairs)) for what, pairs in groups if with_curves(pairs)]
    rows = len(groups) + 1
    made, panels = style.figure(rows, 2, 17, 7.5 * rows + 0.5)
    for k, (what, pairs) in enumerate(groups):
        draw_curves(panels[2 * k], panels[2 * k + 1], pairs, what)
    draw_angles(made, panels[-2], answer.fitted_pairs + answer.predicted_pairs)
    draw_agreement(panels[-1], answer)
    for letter, axes in zip("abcdef", panels):
        axes.set_title(f"({letter}) {axes.get_title('left')}")
    made.savefig(path)
    style.plt.close(made)


def with_curves(pairs):
    return [(test, response) for test, response in pairs
            if len(test.ratio_curve) or len(test.volume_curve)]


def draw_curves(stress, volume, pairs, what):
    volume.axhline(0, color="0.75", lw=0.8, zorder=0)
    for k, (test, response) in enumerate(pairs):
        draw_curve(stress, volume, test, response, CURVE_COLOURS[k % len(CURVE_COLOURS)])
    stress.set(xlabel="Axial strain, size (%)", ylabel=r"$\sigma_1/\sigma_3$")
    stress.set_title(f"Stress ratio, {what} (points: measured)")
    volume.set(xlabel="Axial strain, size (%)", ylabel="Volumetric strain, compression + (%)")
    volume.set_title(f"Volume change, {what}")
    volume.legend(loc="best", fontsize=7)


def draw_curve(stress, volume, test, response, colour):
    look = {"ls": "none", "marker": MARKERS[test.mode], "ms": 3, "color": colour, "alpha": 0.6}
    stress.plot(100 * np.abs(test.ratio_curve[:, 0]), test.ratio_curve[:, 1], **look)
    volume.plot(100 * np.abs(test.volume_curve[:, 0]), 100 * test.volume_curve[:, 1], **look)
    if isinstance(response, Failed):
        return
    strain = np.abs(response.strain)
    seen = strain <= test.last_strain
    stress.plot(100 * strain[seen], response.ratio[seen], color=colour)
    volume.plot(100 * strain[seen], 100 * response.volume[seen], color=colour, label=test.name)


def draw_angles(made, axes, pairs):
    pressures = [test.sigma3 / 1000 for test, _ in pairs]
    norm = mpl.colors.LogNorm(min(pressures) / 1.2, max(pressures) * 1.2)
    colours = mpl.colormaps["viridis"]
    for test, response in pairs:
        colour = colours(norm(test.sigma3 / 1000))
        if test.phi_peak is not None:
            axes.plot(test.void_ratio, test.phi_peak, MARKERS[test.mode], ms=4.5, color=colour)
        if not isinstance(response, Failed):
            axes.plot(test.void_ratio, response.peak()[0], MARKERS[test.mode], ms=4.5, mfc="none",
                      color=colour)
    bar = made.colorbar(mpl.cm.ScalarMappable(norm, colours), ax=axes, pad=0.02)
    bar.set_label(r"$\sigma_3$ (kPa)")
    axes.set(xlabel="Void ratio", ylabel="Peak friction angle (°)")
    axes.set_title("Filled: measured, open: computed")


def draw_agreement(axes, answer):
    for pairs, colour in ((answer.fitted_pairs, style.BLUE), (answer.predicted_pairs, style.RED)):
        for test, response in pairs:
            if test.phi_peak is not None and not isinstance(response, Failed):
                axes.plot(test.phi_peak, response.peak()[0], MARKERS[test.mode], ms=4,
                          color=colour)
    ends = np.array(axes.get_xlim() + axes.get_ylim())
    ends = np.array([ends.min(), ends.max()])
    axes.plot(ends, ends, color="0.6", lw=0.8, zorder=0)
    axes.set(xlabel="Measured angle (°)", ylabel="Computed angle (°)", xlim=ends, ylim=ends,
             aspect="equal")
    axes.set_title("Peak friction angles")
    label_agreement(axes, answer)


def label_agreement(axes, answer):
    modes = dict.fromkeys(test.mode for test, _ in answer.fitted_pairs + answer.predicted_pairs)
    handles = [Line2D([], [], ls="none", marker=MARKERS[mode], color="0.4",
                      label=mode.replace("_", " ")) for mode in modes]
    groups = [("fitted", style.BLUE)] + [("predicted", style.RED)] * bool(answer.predicted_pairs)
    handles += [Line2D([], [], lw=3, color=colour, label=label) for label, colour in groups]
    axes.legend(handles=handles, loc="upper left", fontsize=7)
