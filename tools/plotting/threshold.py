"""Known resistance curves with scatter, their true thresholds and what is read from them."""

import matplotlib.pyplot as plt

from . import style

TITLES = {"corner": "Rounded corner, 2 % noise", "peak": "Peak, 2 % noise",
          "corner with teeth": "Corner, 3 % saw-teeth, 1 % noise",
          "peak with teeth": "Peak, 3 % saw-teeth, 1 % noise"}


def column(rows, name):
    return [float(row[name]) for row in rows]


def draw_panel(axes, rows, letter, title):
    first = {name: float(value) for name, value in rows[0].items() if name != "curve"}
    u = column(rows, "u_over_D")
    axes.plot(u, column(rows, "N_d"), color="0.6", lw=0.7, label="with scatter, as read")
    axes.plot(u, column(rows, "without_scatter"), color=style.BLACK, lw=1.0,
              label="without scatter")
    axes.errorbar(first["u"], first["N"],
                  xerr=[[first["u"] - first["u_low"]], [first["u_high"] - first["u"]]],
                  yerr=[[first["N"] - first["N_low"]], [first["N_high"] - first["N"]]],
                  fmt="o", ms=5, mfc="white", mew=1.3, color=style.RED, capsize=2.5, zorder=4,
                  label="threshold read, 95 % intervals")
    axes.plot(first["true_u"], first["true_N"], "x", ms=7, mew=1.8, color=style.BLUE, zorder=5,
              label="true threshold")
    axes.set(xlim=(0, 0.9), ylim=(0, None))
    axes.set_title(f"({letter}) {title}")


def draw(rows, picture):
    made, panels = style.figure(2, 2, 17, 13, sharex=True, sharey=True)
    for axes, letter, (curve, title) in zip(panels, "abcd", TITLES.items()):
        draw_panel(axes, [row for row in rows if row["curve"] == curve], letter, title)
    for axes in panels[2:]:
        axes.set_xlabel("$u/D$")
    for axes in panels[::2]:
        axes.set_ylabel("$N_d$")
    style.legend_below(made, panels[0], columns=4, room=0.05)
    made.savefig(picture)
    plt.close(made)
