"""Pressure under strip footings in a centrifuge against settlement, measured and computed."""

import matplotlib.pyplot as plt

from . import style

SETTLEMENTS = [round(0.01 * k, 2) for k in range(1, 25)]
# s/B, q in kPa: points read from Fig. 9 of Kimura, Kusakabe & Saitoh (1985) by others.
MEASURED = {
    "V85.6": ((0.0103, 420), (0.02, 744), (0.0296, 1003), (0.0452, 1374), (0.0597, 1648),
              (0.0754, 1863), (0.0906, 1953), (0.1041, 1744), (0.1184, 1567), (0.1375, 1414),
              (0.1626, 1259), (0.1906, 1121), (0.2466, 938)),
    "V64.6": ((0.0103, 178), (0.02, 309), (0.0305, 439), (0.0453, 599), (0.0594, 733),
              (0.0756, 808), (0.0821, 814), (0.0897, 801), (0.1034, 764), (0.1192, 745),
              (0.1393, 740), (0.1563, 744)),
}
COLOURS = {"6": style.SKY, "12": style.BLUE, "24": style.PURPLE}
VARIANTS = {("6", "slow"): (style.SKY, "--"), ("12", "slow"): (style.BLUE, "--"),
            ("6", "not averaged"): (style.ORANGE, "-"), ("12", "not averaged"): (style.RED, "-"),
            ("12", "length"): (style.GREEN, "-")}


def plot(axes, row, **options):
    axes.plot([0] + SETTLEMENTS, [0] + [float(row[f"q_kPa_at_{s:.2f}"]) for s in SETTLEMENTS],
              **options)


def draw_measured(axes, test):
    axes.plot(*zip(*((0, 0),) + MEASURED[test]), "o-", color=style.BLACK, ms=3, lw=0.8,
              label="measured")
    axes.set(xlim=(0, 0.25), xlabel="$s/B$", ylabel="$q$ (kPa)")


def draw_test(axes, rows, test, letter):
    draw_measured(axes, test)
    for row in rows:
        if row["test"] == test and not row["variant"]:
            plot(axes, row, color=COLOURS[row["cells_per_B"]],
                 ls="-" if row["base"] == "rough" else "--",
                 label=f"{row['base']}, {row['cells_per_B']} cells")
    axes.set(title=f"({letter}) {test}")


def draw_variants(axes, rows):
    draw_measured(axes, "V85.6")
    for row in rows:
        if (row["test"], row["base"]) != ("V85.6", "rough"):
            continue
        cells, variant = row["cells_per_B"], row["variant"]
        colour, line = VARIANTS.get((cells, variant), (COLOURS[cells], "-"))
        label = f"{cells} cells,{variant}" if variant else f"{cells} cells"
        plot(axes, row, color=colour, ls=line, label=label.replace(",", ", "))
    axes.set(title="(c) V85.6, rough: numerical choices")


def draw(rows, path):
    made, axes = style.figure(1, 3, 26, 12)
    draw_test(axes[0], rows, "V85.6", "a")
    draw_test(axes[1], rows, "V64.6", "b")
    draw_variants(axes[2], rows)
    for panel in axes:
        panel.set_ylim(0, None)
        panel.legend(loc="upper left", bbox_to_anchor=(-0.1, -0.15), ncol=2, fontsize=7)
    made.savefig(path)
    plt.close(made)
