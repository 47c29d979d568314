"""own_evidence.py LAUNCHER PROGRAM: a run whose own measurements contradict its answer has none,
ends with exit code 4 and says why; what is only doubtful stands as warnings beside the answer."""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

WITHHELD = 4
PIPE = {"scene": "pipe", "pipe_cells_per_diameter": 4, "pipe_domain_width": 14,
        "pipe_domain_depth_below": 10, "pipe_far_cell_ratio": 4, "pipe_end_displacement": 0.12,
        "inertia_tolerance": 0.05, "progress": "off"}
# A footing that is pulled up does not touch the ground; its motion alone is looked at.
CUSTOM = {"scene": "custom", "domain": "0,0,2,1", "cell_size": 0.1,
          "walls": "roller,roller,fixed,free", "regions": "soil", "region_soil_box": "0,0,2,0.5",
          "region_soil_material": "elastic", "bodies": "ball", "body_ball_ball": "1,0.7,0.1",
          "body_ball_velocity": "0,-1", "stage_run_until": "ball:0.61", "progress": "off"}


class Runs:
    def __init__(self, launcher, program, directory):
        self.launcher, self.program, self.directory = launcher, program, directory
        self.failed = 0

    def run(self, name, options):
        """Exit code, what was printed, summary (empty where there is none)."""
        out = self.directory / name
        command = [self.launcher, "2", self.program, "-output_dir", str(out)]
        for option, value in options.items():
            command += [f"-{option}", str(value)]
        result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                text=True, check=False)
        summary = out / "summary.json"
        return (result.returncode, result.stdout,
                json.loads(summary.read_text(encoding="utf-8")) if summary.exists() else {})

    def claim(self, text, holds, shown=""):
        self.failed += not holds
        print(f"{'ok' if holds else 'FAILED'}: {text}{'' if holds else ': ' + str(shown)}")

    def is_withheld(self, name, options, check):
        code, printed, summary = self.run(name, PIPE | options)
        reasons = summary.get("answer_withheld", [])
        self.claim(f"{name} ends with exit code 4", code == WITHHELD, code)
        self.claim(f"{name} names the check and the remedy",
                   any(f"(-check_{check})" in reason and "help" in reason for reason in reasons)
                   and f"(-check_{check})" in printed, reasons)
        code, _, _ = self.run(name, PIPE | options | {"restart": "auto"})
        self.claim(f"{name} asked to go on has no answer either", code == WITHHELD, code)
        self.claim(f"{name} has no answer", "N_df" in summary and summary["N_df"] is None
                   and summary["u_df_over_D"] is None and "withheld" in printed, summary)

    def warns(self, name, options, *words):
        """Runs a few steps: said at the start, and again beside the answer."""
        code, printed, summary = self.run(name, PIPE | {"max_steps": 2} | options)
        told = [text for text in summary.get("warnings", []) if all(w in text for w in words)]
        self.claim(f"{name} is warned about once at the start and once beside the answer",
                   code == 0 and len(told) == 1 and printed.count(told[0]) == 2, printed)


def check_answers(runs):
    code, printed, summary = runs.run("good", PIPE)
    runs.claim("a run without fault has no warning", code == 0 and "warnings" not in summary
               and "answer_withheld" not in summary and "warning" not in printed,
               summary.get("warnings"))
    with open(runs.directory / "good/history.csv", encoding="utf-8") as file:
        last = list(csv.DictReader(file))[-1]
    runs.claim("the summary has what the history measures",
               summary["check_side_wall"] >= float(last["strain_at_side"]) > 0.0 and
               summary["check_energy"] == float(last["energy_residual_share"]), summary)
    runs.is_withheld("narrow", {"pipe_domain_width": 2, "pipe_domain_depth_below": 4}, "side_wall")
    runs.is_withheld("shallow", {"pipe_domain_depth_below": 2}, "bottom")
    runs.is_withheld("fast", {"pipe_velocity": 0.6}, "inertia")
    code, _, summary = runs.run("unchecked", PIPE | {"pipe_domain_depth_below": 2,
                                                     "check_bottom": "1e30,1e30"})
    runs.claim("a check that is left out withholds nothing",
               code == 0 and "answer_withheld" not in summary, (code, summary))


def check_cautions(runs):
    runs.warns("domain", {"pipe_domain_width": 5}, "-pipe_domain_width 5", "1.3 times")
    runs.warns("gap", {"contact_gap_cells": 0.8}, "-contact_gap_cells 0.8", "no effect",
               "-contact_detection gap")
    runs.warns("normal", {"contact_normal": "gradient"}, "-contact_normal gradient", "no effect")
    runs.warns("ramp", {"pipe_ramp_distance": 0.01}, "-pipe_ramp_distance 0.01", "no effect",
               "-pipe_velocity")
    runs.warns("courant", {"courant": 0.7, "basis": "quadratic", "update": "usl"},
               "-courant 0.7", "limit", "blow up")
    runs.warns("packing", {"sand_void_ratio": 0.48}, "-sand_void_ratio 0.48", "relative density")
    runs.warns("grains", {"sand_d50": 0.005}, "-sand_d50 0.005", "grains")
    code, printed, _ = runs.run("through_the_bottom", CUSTOM)
    runs.claim("a body on its way through the bottom is refused",
               code == 2 and "-body_ball_velocity 0,-1" in printed and "bottom wall" in printed,
               printed)
    code, printed, _ = runs.run("to_the_bottom", CUSTOM | {"stage_run_until": "ball:0.59",
                                                           "end_time": 1e-4})
    runs.claim("a body that stops before it is not", code == 0, printed)


def main():
    launcher, program = sys.argv[1:]
    with tempfile.TemporaryDirectory() as scratch:
        runs = Runs(launcher, program, pathlib.Path(scratch))
        check_answers(runs)
        check_cautions(runs)
    return 1 if runs.failed else 0


if __name__ == "__main__":
    sys.exit(main())
