"""A coarse, short pipe run on 1, 2, 3 and 4 ranks.

Claims: the same ranks give the same bits; other ranks the same resistance to the growth of
round-off through contact that opens and closes; both reactions agree; nothing is lost.
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

OPTIONS = {"scene": "pipe", "pipe_cells_per_diameter": 4, "pipe_domain_width": 6,
           "pipe_domain_depth_below": 4, "pipe_end_displacement": 0.1, "pipe_far_cell_ratio": 1.5,
           "progress": "off"}
LARGEST_DIFFERENCE_OVER_RANKS = 1e-4  # of N_d; 1e-5 in the first row, 1e-6 later, as measured
LARGEST_REACTION_DIFFERENCE = 0.03


def run(launcher, program, ranks, directory):
    command = [launcher, str(ranks), program, "-output_dir", str(directory)]
    for name, value in OPTIONS.items():
        command += [f"-{name}", str(value)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    text = (directory / "history.csv").read_text(encoding="utf-8")
    summary = json.loads((directory / "summary.json").read_text(encoding="utf-8"))
    return text, summary


def resistance(text):
    return [float(row["N_d"]) for row in csv.DictReader(text.splitlines())]


def main():
    launcher, program = sys.argv[1:]
    failures = []

    def check(claim, holds, figure):
        print(f"{'ok  ' if holds else 'FAIL'} {claim}: {figure}")
        if not holds:
            failures.append(claim)

    with tempfile.TemporaryDirectory() as directory:
        base = pathlib.Path(directory)
        runs = {ranks: run(launcher, program, ranks, base / str(ranks)) for ranks in (1, 2, 3, 4)}
        again, _ = run(launcher, program, 2, base / "again")
    serial = resistance(runs[1][0])
    check("the same ranks give the same bits", again == runs[2][0], f"{len(serial)} rows")
    for ranks, (text, summary) in runs.items():
        other = resistance(text)
        largest = max(abs(a / b - 1.0) for a, b in zip(other, serial))
        check(f"{ranks} ranks give the resistance of one",
              len(other) == len(serial) and largest <= LARGEST_DIFFERENCE_OVER_RANKS,
              f"{largest:.1e}")
        check(f"reactions agree on {ranks} ranks",
              summary["reaction_difference_max"] <= LARGEST_REACTION_DIFFERENCE,
              summary["reaction_difference_max"])
        check(f"mass stays on {ranks} ranks", abs(summary["mass_change_share"]) < 1e-12,
              summary["mass_change_share"])
        check(f"all of {ranks} ranks work", summary["load_max_over_mean"] < 1.2,
              summary["load_max_over_mean"])
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
