"""Triaxial tests laid over each other; a single one is drawn like a material point."""

from . import style
from .run import MissingData

COLOURS = [style.BLUE, style.GREEN, style.RED, style.PURPLE, style.ORANGE, style.SKY]
NEEDED = ["axial_strain", "q_Pa", "volumetric_strain"]


def history_of(run):
    history = run.table("history.csv")
    lacking = [name for name in NEEDED if name not in history]
    if lacking:
        raise MissingData(f"{run.path('history.csv')} has no column {', '.join(lacking)}")
    return history


def compare(runs):
    """Left column the lower, right the higher confining pressure; material points are dashed."""
    pressures = sorted({run.option("confining_pressure") for run in runs})
    if len(pressures) > 2:
        raise MissingData("the comparison has room for two confining pressures, not "
                          f"{len(pressures)}")
    columns = len(pressures)
    made, panels = style.figure(2, columns, 8.5 * columns, 13, sharex="col")
    for k, pressure in enumerate(pressures):
        group = [run for run in runs if run.option("confining_pressure") == pressure]
        draw_column(panels[k], panels[columns + k], group)
        panels[k].set_title(f"({'ab'[k]}) Deviatoric stress, {pressure / 1000:g} kPa")
        panels[columns + k].set_title(f"({'cd'[k] if columns > 1 else 'b'}) Volume change, "
                                      f"{pressure / 1000:g} kPa")
        panels[columns + k].set_xlabel("Axial strain (%)")
    panels[0].set_ylabel(r"$q$ (kPa)")
    panels[columns].set_ylabel("Volumetric strain (%), compression +")
    return made


def draw_column(stress, volume, runs):
    void_ratios = sorted({run.option("sand_void_ratio") for run in runs})
    volume.axhline(0, color="0.75", lw=0.8, zorder=0)
    for run in sorted(runs, key=lambda run: run.option("sand_void_ratio")):
        history = history_of(run)
        void_ratio = run.option("sand_void_ratio")
        look = {"color": COLOURS[void_ratios.index(void_ratio) % len(COLOURS)],
                "label": rf"$e_0$ = {void_ratio:g}"}
        if run.scene == "material_point":
            look = {"color": style.BLACK, "ls": (0, (4, 3)), "lw": 0.7, "zorder": 4,
                    "label": "material point"}
        strain = 100 * history["axial_strain"]
        stress.plot(strain, history["q_Pa"] / 1000, **look)
        volume.plot(strain, 100 * history["volumetric_strain"], **look)
    stress.set(xlim=(0, None), ylim=(0, None))
    handles, labels = stress.get_legend_handles_labels()
    once = dict(sorted(zip(labels, handles), key=lambda item: item[0] == "material point"))
    stress.legend(once.values(), once.keys(), loc="lower right")
