"""curve.png of the material point: stress, volume and path of an element test."""

from . import style
from .run import MissingData


def draw(run):
    history = run.table("history.csv")
    needed = ["q_Pa", "p_Pa", "volumetric_strain"]
    lacking = [name for name in needed if name not in history]
    if lacking:
        raise MissingData(f"history.csv has no column {', '.join(lacking)}")
    strain_name = next(iter(history))
    strain = 100 * history[strain_name]
    q, p = history["q_Pa"] / 1000, history["p_Pa"] / 1000
    label = strain_name.replace("_", " ").capitalize() + " (%)"
    made, (stress, volume, path) = style.figure(1, 3, 18.5, 7)
    stress.plot(strain, q, color=style.BLACK)
    stress.set(xlabel=label, ylabel=r"$q$ (kPa)")
    stress.set_title("(a) Deviatoric stress")
    volume.axhline(0, color="0.7", lw=0.8)
    volume.plot(strain, 100 * history["volumetric_strain"], color=style.BLUE)
    volume.set(xlabel=label, ylabel="Volumetric strain (%)")
    volume.set_title("(b) Volume change (compression +)")
    draw_path(path, run, p, q)
    return [style.save(made, run, "curve.png")]


def draw_path(axes, run, p, q):
    axes.plot(p, q, color=style.BLACK, label="stress path")
    axes.plot(p[0], q[0], "o", ms=5, mfc="white", color=style.BLACK)
    slope = critical_slope(run)
    if slope:
        axes.plot([0, p.max()], [0, slope * p.max()], color=style.RED, ls="--", lw=1.0,
                  label=rf"critical state, $M_c$ = {slope:g}")
    axes.set(xlabel=r"$p$ (kPa)", ylabel=r"$q$ (kPa)", xlim=(0, None), ylim=(0, None))
    axes.set_title("(c) Stress path")
    axes.legend(loc="upper left", bbox_to_anchor=(0, -0.26), borderaxespad=0)


def critical_slope(run):
    try:
        return run.option("sand_Mc")
    except MissingData:
        return None
