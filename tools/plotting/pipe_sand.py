"""Resistance of the pipe against displacement under readings of the law, or on different cells."""

import matplotlib.pyplot as plt

from . import style

COLOURS = (style.RED, style.ORANGE, "0.6", style.SKY, style.GREEN, style.PURPLE, style.BLUE,
           style.BLACK)


def points(row):
    """u/D and N_d of a row of a table."""
    return [(float(name.removeprefix("N_d_at_")), float(value)) for name, value in row.items()
            if name.startswith("N_d_at_")]


def curve(row):
    return zip(*([(0.0, float("nan"))] + points(row)))


def draw_panel(axes, rows):
    for row, colour in zip(rows, COLOURS):
        house = row["case"] == "house"
        axes.plot(*curve(row), color=colour, lw=2.2 if house else 1.2,
                  label=row["case"].replace("_", ", "))
        if row["N_df"]:
            axes.plot(float(row["u_df_over_D"]), float(row["N_df"]), "o", ms=4, color=colour)
    axes.set(xlim=(0, 0.9), ylim=(0, None))
    axes.set_title(f"$D$ = {rows[0]['diameter_mm']} mm, {rows[0]['packing']}")


def draw(rows, path):
    """Four panels, dots where the failure threshold is read."""
    made, axes = style.figure(2, 2, 22, 16, sharex=True)
    panels = dict.fromkeys((row["diameter_mm"], row["packing"]) for row in rows)
    for panel, (size, packing) in zip(axes, panels):
        draw_panel(panel, [row for row in rows
                           if (row["diameter_mm"], row["packing"]) == (size, packing)])
    for panel in axes[2:]:
        panel.set_xlabel("$u/D$")
    for panel in axes[::2]:
        panel.set_ylabel("$N_d$")
    style.legend_below(made, axes[0], columns=4)
    made.savefig(path)
    plt.close(made)
