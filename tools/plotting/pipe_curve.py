"""curve.png of the pipe: resistance, failure threshold, guideline, and the slope with its fit."""

import numpy as np

from . import style
from .run import MissingData

ANGLES = {36: style.SKY, 39: style.GREEN, 43: style.ORANGE}


def contour_N_d(history):
    """The reaction on the contour in the unit of N_d, whose divisor the two columns give."""
    reaction, N_d = history["reaction_N_per_m"], history["N_d"]
    contour = history.get("reaction_contour_N_per_m")
    used = (np.abs(N_d) > 1e-6) & (np.abs(reaction) > 0)
    if contour is None or not used.any():
        return None
    return contour / np.median(reaction[used] / N_d[used])


def guideline_levels(run):
    """(N_d, friction angle, with cohesion or not), lowest first."""
    levels = []
    for angle in ANGLES:
        plain = run.value(f"ala_N_d_phi{angle}")
        shifted = run.value(f"ala_N_d_phi{angle}_cohesion")
        levels += [(plain, angle, False)] if plain is not None else []
        levels += [(shifted, angle, True)] if shifted not in (None, plain) else []
    return sorted(levels)


def spread(positions, distance):
    """Ascending positions moved up until neighbours are that far apart."""
    moved = []
    for position in positions:
        moved.append(max(position, moved[-1] + distance) if moved else position)
    return moved


def draw_guideline(axes, run, right):
    levels = guideline_levels(run)
    notes = spread([level for level, _, _ in levels], 0.045 * axes.get_ylim()[1])
    for (level, angle, cohesion), height in zip(levels, notes):
        axes.plot([0, right], [level, level], color=ANGLES[angle], lw=1.0, zorder=1,
                  ls=(0, (4, 2)) if cohesion else "-")
        axes.annotate(rf"${angle}°$" + (r"$,\ c$" if cohesion else ""), (right, height),
                      xytext=(3, 0), textcoords="offset points", va="center", fontsize=7.5,
                      color=ANGLES[angle], annotation_clip=False)
    if levels:
        axes.plot([], [], color="0.4", lw=1.0, label=r"ALA (2005) for $\phi$ at the line's end")
    if any(cohesion for _, _, cohesion in levels):
        axes.plot([], [], color="0.4", lw=1.0, ls=(0, (4, 2)), label="the same with cohesion")


def error_bar(run, key, value):
    """Distances from the value to the ends of its interval, or None."""
    low, high = run.value(key + "_low"), run.value(key + "_high")
    if low is None or high is None:
        return None
    return [[max(value - low, 0.0)], [max(high - value, 0.0)]]


def draw_threshold(axes, run):
    u, N_d = run.value("u_df_over_D"), run.value("N_df")
    if u is None or N_d is None:
        if run.value("threshold_found") is not None:
            axes.plot([], [], " ", label="no failure threshold found")
        return
    axes.errorbar(u, N_d, xerr=error_bar(run, "u_df_over_D", u),
                  yerr=error_bar(run, "N_df", N_d), fmt="o", ms=5.5, mfc="white", mew=1.4,
                  color=style.RED, elinewidth=1.1, capsize=2.5, zorder=5,
                  label=rf"threshold: $N_{{df}}$ = {N_d:.1f}, $u_{{df}}/D$ = {u:.3f}")


def draw_resistance(axes, run, history):
    u = history["u_over_D"]
    axes.plot(u, history["N_d"], color=style.BLACK, zorder=3, label="contact reaction")
    contour = contour_N_d(history)
    if contour is not None:
        axes.plot(u, contour, color=style.PURPLE, lw=1.0, ls="--", zorder=2,
                  label="stress resultant around the pipe")
    highest = max([history["N_d"].max()] + [level for level, _, _ in guideline_levels(run)])
    axes.set(xlabel=r"$u/D$", ylabel=r"$N_d = F/(\gamma H D)$", xlim=(0, u.max()),
             ylim=(0, 1.05 * highest))
    draw_guideline(axes, run, u.max())
    draw_threshold(axes, run)
    axes.set_title("(a) Resistance")
    legend_below(axes)


def legend_below(axes):
    axes.legend(loc="upper left", bbox_to_anchor=(0, -0.16), handlelength=2.2, borderaxespad=0,
                labelspacing=0.35)


def draw_slope(axes, run):
    table = run.table("threshold.csv")
    u = table["u_over_D"]
    axes.plot(u, table["slope"], ".", ms=3.5, color="0.45", label="slope of five steps of 0.01")
    fits = [name for name in table if name.startswith("fit_to_")]
    for name, colour in zip(fits, (style.RED, style.BLUE)):
        window = name.removeprefix("fit_to_")
        if np.isfinite(table[name]).any():
            axes.plot(u, table[name], color=colour, label=rf"two segments, to {window}")
    threshold = run.value("u_df_over_D")
    if threshold is not None:
        axes.axvline(threshold, color=style.RED, lw=0.8, ls=":")
        axes.axvspan(run.value("u_df_over_D_low") or threshold,
                     run.value("u_df_over_D_high") or threshold, color=style.RED, alpha=0.12,
                     lw=0, label="95 % interval of the break")
    axes.set(xlabel=r"$u/D$", ylabel=r"$\Delta N_d/(\Delta u/D)$", xlim=(0, u.max()))
    axes.set_ylim(min(0, np.nanmin(table["slope"], initial=0)), None)
    axes.set_title("(b) Slope")
    legend_below(axes)


def draw(run):
    history = run.table("history.csv")
    needed = {"u_over_D", "N_d", "reaction_N_per_m"} - set(history)
    if needed:
        raise MissingData(f"history.csv has no column {', '.join(sorted(needed))}")
    made, (left, right) = style.figure(1, 2, 18, 10.5)
    draw_resistance(left, run, history)
    try:
        draw_slope(right, run)
    except MissingData as missing:
        right.set_axis_off()
        right.text(0.5, 0.5, f"No slope curve:\n{missing}", ha="center", va="center", wrap=True)
    return [style.save(made, run, "curve.png")]
