"""Computed against measured peaks of Toyoura sand: what was calibrated, and what was predicted."""

import math

import matplotlib.pyplot as plt

from . import style

COLOURS = {"triaxial_compression": "0.55", "plane_strain": style.BLUE,
           "triaxial_extension": style.ORANGE}
LABELS = {"triaxial_compression": "triaxial compression (calibrated)",
          "plane_strain": "plane strain (predicted)",
          "triaxial_extension": "triaxial extension (predicted)"}
MARKERS = {4.9: "v", 9.8: "<", 49.0: "s", 98.0: "o", 392.0: "^"}


def points(rows, quantity, **wanted):
    return [(float(row["measured_" + quantity]), float(row["computed_" + quantity]), row)
            for row in rows if row["measured_" + quantity]
            and all(row[key] == value for key, value in wanted.items())]


def rms(values):
    return math.sqrt(sum(value * value for value in values) / len(values))


def verdict(rows):
    """Errors of the predictions under one reading, in a line."""
    angles = [c - m for m, c, _ in points(rows, "deg", kind="plane_strain")]
    fitted = [c - m for m, c, _ in points(rows, "deg", kind="triaxial_compression")]
    strains = [math.log(c / m) for m, c, _ in points(rows, "strain_pct")]
    bolton = [float(row["bolton_deg"]) - m for m, _, row in points(rows, "deg",
                                                                   kind="plane_strain")]
    shares = [c - m for m, c, _ in points(rows, "residual_share")]
    return (f"{rows[0]['reading']}: plane strain {rms(angles):.2f} deg rms, "
            f"mean {sum(angles) / len(angles):+.2f} (Bolton {rms(bolton):.2f}, "
            f"{sum(bolton) / len(bolton):+.2f}); triaxial {rms(fitted):.2f} deg rms; strain at "
            f"the peak {math.exp(sum(strains) / len(strains)):.2f} times, "
            f"{sum(abs(s) <= math.log(1.5) for s in strains)} of {len(strains)} within 1.5; "
            f"residual share {sum(shares) / len(shares):+.2f}")


def draw_angles(axes, rows, title):
    for kind, colour in COLOURS.items():
        for measured, computed, row in points(rows, "deg", kind=kind):
            marker = MARKERS.get(float(row["pressure_kPa"]), "o")
            axes.plot(measured, computed, marker, ms=4, mfc="none", color=colour)
        axes.plot([], [], "o", ms=4, mfc="none", color=colour, label=LABELS[kind])
    top = max(56.0, 1.0 + max(computed for _, computed, _ in points(rows, "deg")))
    axes.plot([33, top], [33, top], color="0.3", lw=0.8)
    axes.fill_between([33, top], [30.5, top - 2.5], [35.5, top + 2.5], color="0.93", zorder=0)
    axes.set(xlim=(33, 52), ylim=(33, top), xlabel="measured peak angle (°)", title=title)


def draw_strains(axes, rows):
    for measured, computed, row in points(rows, "strain_pct"):
        axes.plot(measured, computed, MARKERS[float(row["pressure_kPa"])], ms=5, mfc="none",
                  color=style.BLUE)
    for pressure, marker in MARKERS.items():
        axes.plot([], [], marker, ms=5, mfc="none", color=style.BLUE, label=f"{pressure:g} kPa")
    axes.plot([1, 6], [1, 6], color="0.3", lw=0.8)
    axes.fill_between([1, 6], [1 / 1.5, 4], [1.5, 9], color="0.93", zorder=0)
    axes.set(xscale="log", yscale="log", xlim=(1, 6), ylim=(1, 6))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(plt.FixedLocator([1, 2, 3, 4, 6]))
        axis.set_major_formatter(plt.FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(plt.NullLocator())
    axes.set(xlabel="measured strain at the peak (%)", ylabel="computed (%)",
             title="(d) Plane strain, strain at the peak")
    axes.legend(loc="lower right")


def draw(rows, path):
    """Bands: 2.5 degrees, and a factor of 1.5."""
    made, axes = style.figure(2, 2, 18, 17)
    for panel, letter, reading, title in zip(axes, "abc", ("house", "c0.706", "printed_D"),
                                             ("as it is", "$c$ of equal critical angles",
                                              "$D$ as printed")):
        draw_angles(panel, [row for row in rows if row["reading"] == reading],
                    f"({letter}) {title}")
    axes[0].set_ylabel("computed (°)")
    axes[2].set_ylabel("computed (°)")
    axes[0].legend(loc="upper left", fontsize=7)
    draw_strains(axes[3], [row for row in rows if row["reading"] == "house"])
    made.savefig(path)
    plt.close(made)
