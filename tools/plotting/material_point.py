"""curve.png of the material point: stress, volume and path of an element test."""

import numpy as np

from . import style
from .run import MissingData

NEEDED = ["q_Pa", "p_Pa", "volumetric_strain"]
NORMAL = ["stress_xx_Pa", "stress_yy_Pa", "stress_zz_Pa"]
SHEAR = ["stress_xy_Pa", "stress_yz_Pa", "stress_xz_Pa"]


def draw(run):
    history = run.table("history.csv")
    lacking = [name for name in NEEDED if name not in history]
    if lacking:
        raise MissingData(f"history.csv has no column {', '.join(lacking)}")
    name, strain = abscissa(history)
    q, q_label = deviator(history)
    p = history["p_Pa"] / 1000
    has_voids = "void_ratio" in history and (history["void_ratio"] > 0).all()
    made, panels = style.figure(2, 2, 17, 14)
    draw_stress(panels[0], name, strain, q, q_label)
    draw_volume(panels[1], name, strain, 100 * history["volumetric_strain"])
    draw_path(panels[2], run, p, q, q_label)
    if has_voids:
        draw_void_ratio(panels[3], run, p, history["void_ratio"])
    else:
        panels[3].set_axis_off()
    return [style.save(made, run, "curve.png")]


def abscissa(history):
    """The axial strain in per cent, or the shear strain of a path that shears only."""
    first = next(iter(history))
    strain, gamma = history[first], history.get("gamma_xy")
    if gamma is not None and np.ptp(gamma) > 10 * np.ptp(history["strain_yy"]):
        return r"Shear strain $\gamma_{xy}$ (%)", 100 * gamma
    return first.replace("_", " ").capitalize() + " (%)", 100 * strain


def deviator(history):
    """q in kPa, with the sign of axial minus lateral stress where the test is axisymmetric."""
    q = history["q_Pa"] / 1000
    if not all(name in history for name in NORMAL + SHEAR):
        return q, r"$q$ (kPa)"
    xx, yy, zz = (history[name] / 1000 for name in NORMAL)
    tolerance = 1e-6 * max(np.abs(yy).max(), 1e-9)
    shears = any(np.abs(history[name]).max() / 1000 > tolerance for name in SHEAR)
    if shears or np.abs(xx - zz).max() > tolerance:
        return q, r"$q$ (kPa)"
    return yy - 0.5 * (xx + zz), r"$q=\sigma_a-\sigma_r$ (kPa)"


def mark_ends(axes, x, y, color=style.BLACK):
    axes.plot(x[0], y[0], "o", ms=4.5, mfc="white", color=color, zorder=4, clip_on=False)
    axes.plot(x[-1], y[-1], "s", ms=4, color=color, zorder=4, clip_on=False)


def zero_line(axes, values):
    if values.min() < 0 < values.max():
        axes.axhline(0, color="0.75", lw=0.8, zorder=0)


def is_loop(strain):
    return strain.min() < 0 < strain.max()


def draw_stress(axes, name, strain, q, q_label):
    zero_line(axes, q)
    if is_loop(strain):
        axes.axvline(0, color="0.75", lw=0.8, zorder=0)
    axes.plot(strain, q, color=style.BLACK, lw=1.2)
    mark_ends(axes, strain, q)
    axes.set(xlabel=name, ylabel=q_label)
    axes.set_title("(a) Deviatoric stress")


def draw_volume(axes, name, strain, volume):
    if np.ptp(volume) < 1e-9:
        volume = np.zeros_like(volume)
        axes.set_ylim(-1, 1)
    axes.axhline(0, color="0.75", lw=0.8, zorder=0)
    axes.plot(strain, volume, color=style.BLUE, lw=1.2)
    mark_ends(axes, strain, volume, style.BLUE)
    axes.set(xlabel=name, ylabel="Volumetric strain (%)")
    axes.set_title("(b) Volume change (compression +)")


def draw_path(axes, run, p, q, q_label):
    zero_line(axes, q)
    axes.plot(p, q, color=style.BLACK, lw=1.2)
    mark_ends(axes, p, q)
    Mc, c = option(run, "sand_Mc"), option(run, "sand_c")
    if is_sand(run) and Mc:
        shift = cohesion_shift(run)
        ends = np.array([0.0, 1.08 * p.max()])
        line = {"color": style.RED, "ls": "--", "lw": 1.0}
        both = q.min() < 0
        axes.plot(ends, Mc * (ends + shift), **line,
                  label="critical state" + ("" if both else " in compression"))
        if both:
            axes.plot(ends, -c * Mc * (ends + shift), **line)
        axes.legend(loc="best")
    room = 1.1 * q[np.argmax(np.abs(q))]
    axes.set(xlabel=r"$p$ (kPa)", ylabel=q_label, xlim=(0, 1.08 * p.max()),
             ylim=(min(1.1 * q.min(), 0), max(1.1 * q.max(), 0)) if room else None)
    axes.set_title("(c) Stress path")


def draw_void_ratio(axes, run, p, void_ratio):
    positive = p > 0
    axes.plot(p[positive], void_ratio[positive], color=style.BLUE, lw=1.2)
    mark_ends(axes, p[positive], void_ratio[positive], style.BLUE)
    low, high = p[positive].min() / 1.5, 1.5 * p.max()
    pressures = np.geomspace(low, high, 100)
    axes.plot(pressures, critical_void_ratio(run, pressures), color=style.RED, ls="--", lw=1.0,
              label="critical state")
    axes.set(xscale="log", xlim=(low, high), xlabel=r"$p$ (kPa)", ylabel="Void ratio")
    plain_ticks(axes, low, high)
    axes.set_title("(d) Void ratio")
    axes.legend(loc="best")


def plain_ticks(axes, low, high):
    ticks = [t for power in range(-3, 6) for t in (10.0**power, 2 * 10.0**power, 5 * 10.0**power)
             if low <= t <= high]
    if len(ticks) > 6:
        ticks = [t for t in ticks if np.log10(t) == round(np.log10(t))]
    axes.set_xticks(ticks, [f"{t:g}" for t in ticks])
    axes.minorticks_off()


def critical_void_ratio(run, p_kPa):
    """e_c of the critical line; p* in kPa follows from p and the cohesion."""
    p_star = p_kPa + cohesion_shift(run)
    e_Gamma, slope, xi = (option(run, "sand_" + name) for name in ("e_Gamma", "lambda_c", "xi"))
    if xi:
        return e_Gamma - slope * (p_star / 101) ** xi
    return e_Gamma - slope * np.log(p_star)


def cohesion_shift(run):
    """p_c in kPa."""
    cohesion = (option(run, "sand_cohesion") or 0.0) / 1000
    if run.summary.get("option_sand_cohesion_shift") != "cot_phi":
        return cohesion
    Mc = option(run, "sand_Mc")
    return cohesion / np.tan(np.arcsin(3 * Mc / (6 + Mc)))


def is_sand(run):
    return run.summary.get("option_material", "sand") == "sand"


def option(run, name):
    try:
        return run.option(name)
    except MissingData:
        return None
