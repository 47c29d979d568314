"""Work-precision charts: errors against seconds, particle updates and steps."""

import matplotlib.pyplot as plt

from . import style

COLOURS = {"linear": style.BLACK, "gimp": style.ORANGE, "ddmp": style.PURPLE,
           "quadratic": style.SKY, "cubic": style.BLUE}
LOOKS = {"": ("-", "o"), "open": (":", "s"), "usl": ("--", "v"), "usf": ("-.", "^"),
         "pic": (":", "x"), "apic": ("--", "D")}
TITLES = {"mms1d": "vibrating bar, $A$ = 0.05 (particles cross cells)",
          "mms1d_small": "vibrating bar, $A$ = 0.001 (none crosses)",
          "vortex": "vortex, $A$ = 0.2"}
STEPS = {"own": "half of each method's limit", "common": "Courant number 0.2 for all"}
WORK = {"step_loop_s": "time of the step loop (s)", "updates": "particle updates", "steps": "steps"}
WORST = 2.0  # of the amplitude: where failed runs are drawn


def points_of(rows, case, method, step):
    """Work and error of a method's runs; errors of failed runs are None."""
    chosen = [row for row in rows
              if (row["case"], row["method"], row["step"]) == (case, method, step)]
    for row in chosen:
        error = float(row["error"]) if row["error"] else None
        steps, particles = (float(row[key] or 0) for key in ("steps", "particles"))
        yield {"step_loop_s": float(row["step_loop_s"] or 0), "updates": steps * particles,
               "steps": steps, "error": error}


def draw_method(axes, method, points, work):
    basis, _, variant = method.partition("_")
    line, marker = LOOKS[variant]
    shown = [point for point in points if point["error"] is not None]
    axes.plot([point[work] for point in shown],
              [min(point["error"], WORST) for point in shown], line, marker=marker, ms=3, lw=1,
              color=COLOURS[basis], label=method.replace("_", " "))
    failed = [point[work] for point in points if point["error"] is None and point[work]]
    axes.plot(failed, [WORST] * len(failed), marker, mec=COLOURS[basis], mfc="none", ms=6)


def draw(rows, path):
    cases = list(dict.fromkeys(row["case"] for row in rows))
    methods = list(dict.fromkeys(row["method"] for row in rows))
    lines = [(case, step) for case in cases for step in STEPS]
    made, axes = style.figure(len(lines), len(WORK), 26, 6.2 * len(lines))
    for panel, (case, step, work) in zip(axes, [(*line, work) for line in lines for work in WORK]):
        for method in methods:
            draw_method(panel, method, list(points_of(rows, case, method, step)), work)
        panel.set(xscale="log", yscale="log", xlabel=WORK[work])
        panel.axhline(WORST, color="0.8", lw=0.8, zorder=0)
        if work == "step_loop_s":
            panel.set_title(f"{TITLES[case]}; {STEPS[step]}")
            panel.set_ylabel("rms error of displacement / $A$")
    made.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncol=6)
    made.get_layout_engine().set(rect=(0, 0.035, 1, 1 - 0.035))
    made.savefig(path)
    plt.close(made)
