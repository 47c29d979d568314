"""Speed of whole runs per core, on one and two ranks, next to the yardstick.

The yardstick is the method as a textbook writes it, without SIMD, on one core
(tests/bench/PlainStep.hpp). Runs and yardstick take turns, and ratios are taken within a turn.
"""

import math
import statistics

from .common import (CELLS_2D, CELLS_3D, PROGRAMS, ROOT, provenance, rows_of, run, run_on_ranks,
                     simulate)
from .tables import Table

TABLES = (Table("speed", ("case", "ranks"),
                ("updates_per_s_and_core", "over_plain", "two_rank_speed_up",
                 "bytes_per_particle")),)

RANKS = (1, 2)
CUT_CELL = ("-scene", "cut_cell", "-offset", "0.3")
# Options, the one that says how many steps, dimension and cells of the yardstick.
CASES = {
    "elastic_2d": ((*CUT_CELL, "-dimension", "2", "-cells", str(CELLS_2D)), "-increments",
                   (2, CELLS_2D)),
    "sand_2d": (("-options_file", str(ROOT / "input/pipe_reference.opts")), "-max_steps",
                (2, CELLS_2D)),
    "elastic_3d": ((*CUT_CELL, "-dimension", "3", "-cells", str(CELLS_3D)), "-increments",
                   (3, CELLS_3D)),
}
TRIAL_STEPS = 20
LEAST_STEPS = 20


def steps_for(case, seconds):
    """Steps of a run on each number of ranks that take so many seconds."""
    options, limit, _ = CASES[case]
    trial = simulate(1, options, (limit, str(TRIAL_STEPS)))
    per_step = trial["step_loop_s"] / trial["steps"]
    return {ranks: max(LEAST_STEPS, math.ceil(seconds * ranks / per_step)) for ranks in RANKS}


def simulate_case(case, ranks, steps, log=None):
    options, limit, _ = CASES[case]
    return simulate(ranks, options, (limit, str(steps)), log)


def yardstick(place, effort):
    dimension, cells = place
    text = run([PROGRAMS / "plain_step", dimension, cells, 3, effort.seconds / 6])
    return float(rows_of(text)[0]["updates_per_s"])


def check_yardstick():
    """Ends everything unless the yardstick takes the very steps of the solver."""
    for ranks in RANKS:
        run_on_ranks(ranks, [PROGRAMS / "plain_step_check"])


def measure_rounds(effort):
    """For each case a list of rounds: the yardstick's rate, and summaries by ranks."""
    steps = {case: steps_for(case, effort.seconds) for case in CASES}
    rounds = {case: [] for case in CASES}
    for _ in range(effort.rounds):
        for case, (_, _, place) in CASES.items():
            rate = yardstick(place, effort)
            runs = {ranks: simulate_case(case, ranks, steps[case][ranks]) for ranks in RANKS}
            rounds[case].append((rate, runs))
    return rounds


def row_of(case, ranks, rounds):
    def middle(function):
        return statistics.median(function(plain, runs) for plain, runs in rounds)

    def per_core(runs):
        return runs[ranks]["particle_updates_per_s"] / ranks

    last = rounds[-1][1][ranks]
    rates = [per_core(runs) for _, runs in rounds]
    row = {
        "case": case, "ranks": str(ranks), "particles": str(last["particles"]),
        "steps": str(last["steps"]),
        "updates_per_s_and_core": f"{statistics.median(rates):.4g}",
        "spread": f"{(max(rates) - min(rates)) / statistics.median(rates):.2f}",
        "plain_updates_per_s": f"{middle(lambda plain, _: plain):.4g}",
        "over_plain": f"{middle(lambda plain, runs: per_core(runs) / plain):.3f}",
        "two_rank_speed_up": "",
        "load_max_over_mean": f"{last['load_max_over_mean']:.3f}",
        "bytes_per_particle": str(last["bytes_per_particle"]),
    }
    if ranks == 2:
        gain = middle(lambda _, runs: runs[2]["particle_updates_per_s"]
                      / runs[1]["particle_updates_per_s"])
        row["two_rank_speed_up"] = f"{gain:.3f}"
    return row


def settings_of(case, effort):
    options = " ".join(CASES[case][0]).replace(f"{ROOT}/", "")
    return f"{options}; median of {effort.rounds} runs of {effort.seconds} s or more"


def measure(effort):
    check_yardstick()
    rounds = measure_rounds(effort)
    return {"speed": [row_of(case, ranks, rounds[case]) | provenance(settings_of(case, effort))
                      for case in CASES for ranks in RANKS]}
