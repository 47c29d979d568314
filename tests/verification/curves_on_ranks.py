"""Coarse, short runs under contact on 1, 2, 3 and 4 ranks.

usage: curves_on_ranks.py LAUNCHER PROGRAM pipe|pipe_paper|biaxial

Claims: the same ranks give the same bits; other ranks the same curve to the growth of round-off
through contact that opens and closes; both reactions agree; nothing is lost.
"""

import csv
import dataclasses
import json
import pathlib
import subprocess
import sys
import tempfile


@dataclasses.dataclass
class Case:
    options: dict
    curve: str  # column of history.csv
    largest_difference_over_ranks: float
    largest_reaction_difference: float
    largest_load_over_mean: float = 1.2
    reaction_difference: str = "reaction_difference_max"  # answer of the summary
    # Rows that may differ by more: contact began, or the soil came to rest, sooner or later.
    rows_at_a_switch: int = 0
    largest_difference_at_a_switch: float = 0.0

    def holds(self, differences):
        """Whether the curves are the same but for round-off and the rows at a switch."""
        ordered = sorted(differences, reverse=True)
        at_switch, rest = (ordered[:self.rows_at_a_switch], ordered[self.rows_at_a_switch:])
        return (max(rest) <= self.largest_difference_over_ranks
                and all(d <= max(self.largest_difference_at_a_switch,
                                 self.largest_difference_over_ranks) for d in at_switch))


PIPE = {"scene": "pipe", "pipe_velocity": 0.2, "pipe_cells_per_diameter": 4, "pipe_domain_width": 6,
        "pipe_domain_depth_below": 4, "pipe_end_displacement": 0.1, "pipe_far_cell_ratio": 1.5}
CASES = {
    # As measured: 1.1e-4 in the first row, 1e-5 later, but 8e-4 and -7e-4 in two rows on 3 and 4
    # ranks: a step's impulse counts in one row or in the next.
    "pipe": Case(PIPE, "N_d", 3e-4, 0.03, rows_at_a_switch=2,
                 largest_difference_at_a_switch=2e-3),
    # As measured: 2.7e-4 in the first row, since the soil comes to rest a check sooner or later and
    # local damping knows signs alone; 2.7e-5 later.
    "pipe_paper": Case(PIPE | {"sand": "stockton_paper"}, "N_d", 1e-4, 0.03, rows_at_a_switch=1,
                       largest_difference_at_a_switch=1e-3),
    # The consolidation may end a check sooner or later: 2.4e-4 at worst as measured.
    "biaxial": Case({"scene": "biaxial", "cell_size": 0.125, "strain_end": 0.01},
                    "vertical_stress_Pa", 1e-3, 0.015, 1.3, "stress_difference_max"),
}
FINISHED = (0, 4)  # with an answer or, since these runs are quick, perhaps without


def run(launcher, program, options, ranks, directory):
    command = [launcher, str(ranks), program, "-progress", "off", "-output_dir", str(directory)]
    for name, value in options.items():
        command += [f"-{name}", str(value)]
    done = subprocess.run(command, check=False, stdout=subprocess.DEVNULL)
    if done.returncode not in FINISHED:
        raise subprocess.CalledProcessError(done.returncode, command)
    text = (directory / "history.csv").read_text(encoding="utf-8")
    summary = json.loads((directory / "summary.json").read_text(encoding="utf-8"))
    return text, summary


def column(text, name):
    return [float(row[name]) for row in csv.DictReader(text.splitlines())]


def main():
    launcher, program, name = sys.argv[1:]
    case = CASES[name]
    failures = []

    def check(claim, holds, figure):
        print(f"{'ok  ' if holds else 'FAIL'} {claim}: {figure}")
        if not holds:
            failures.append(claim)

    with tempfile.TemporaryDirectory() as directory:
        base = pathlib.Path(directory)
        runs = {ranks: run(launcher, program, case.options, ranks, base / str(ranks))
                for ranks in (1, 2, 3, 4)}
        again, _ = run(launcher, program, case.options, 2, base / "again")
    serial = column(runs[1][0], case.curve)
    check("the same ranks give the same bits", again == runs[2][0], f"{len(serial)} rows")
    for ranks, (text, summary) in runs.items():
        other = column(text, case.curve)
        differences = [abs(a / b - 1.0) for a, b in zip(other, serial)]
        check(f"{ranks} ranks give the curve of one",
              len(other) == len(serial) and case.holds(differences), f"{max(differences):.1e}")
        check(f"reactions agree on {ranks} ranks",
              summary[case.reaction_difference] <= case.largest_reaction_difference,
              summary[case.reaction_difference])
        check(f"mass stays on {ranks} ranks", abs(summary["mass_change_share"]) < 1e-12,
              summary["mass_change_share"])
        check(f"all of {ranks} ranks work", summary["load_max_over_mean"] < case.largest_load_over_mean,
              summary["load_max_over_mean"])
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
