"""Problems put together by options.

usage: custom_cases.py LAUNCHER PROGRAM INPUT same_bits|exact|examples

Claims: the pipe and the biaxial test by hand give the bits of the scenes; layers at rest stay at
rest under their weight and surcharge; a body that turns and moves by a table ends where the table
says and its two reactions agree; every example runs.
"""

import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy


class Program:
    def __init__(self, launcher, program, base):
        self.launcher, self.program, self.base = launcher, program, base

    def run(self, name, *arguments, ranks=2):
        directory = self.base / name
        subprocess.run([self.launcher, str(ranks), self.program, "-progress", "off",
                        "-output_dir", str(directory), *arguments], check=True,
                       stdout=subprocess.DEVNULL)
        return Result(directory)


class Result:
    def __init__(self, directory):
        self.directory = directory
        self.summary = json.loads((directory / "summary.json").read_text(encoding="utf-8"))
        with open(directory / "history.csv", encoding="utf-8") as file:
            self.rows = list(csv.DictReader(file))

    def column(self, name):
        return numpy.array([float(row[name]) for row in self.rows])

    def last_particles(self):
        path = sorted(self.directory.glob("particles_*.h5"))[-1]
        with h5py.File(path) as file:
            return {name: numpy.array(values) for name, values in file.items()}


def claim(text, holds, figure=""):
    print(f"{'ok  ' if holds else 'FAIL'} {text} {figure}")
    return bool(holds)


def same_fields(one, other):
    """The scene by hand has the same fields and the same particles, bit by bit."""
    a, b = one.last_particles(), other.last_particles()
    b = {name.replace("body_pipe_", "contact_"): values for name, values in b.items()}
    return a.keys() == b.keys() and all(numpy.array_equal(a[name], b[name]) for name in a)


PUSHED = {"pipe": ["-pipe_velocity", "0.2"]}


def same_bits(program, inputs):
    short = ["-max_steps", "300", "-history_every", "20"]
    held = []
    for scene, force, by_hand, share in [
            ("pipe", "reaction_N_per_m", "pipe_force_y_N_per_m", 2.0),
            ("biaxial", "vertical_stress_Pa", "plate_force_y_N_per_m", 1.0)]:
        built_in = program.run(scene, "-scene", scene, *short, *PUSHED.get(scene, []))
        custom = program.run(f"{scene}_by_hand", "-options_file",
                             str(inputs / f"{scene}.opts"), *short)
        forces, others = built_in.column(force), share * custom.column(by_hand)
        held.append(claim(f"{scene}: the same forces", numpy.array_equal(forces, others),
                          f"{len(forces)} rows up to {max(forces):.4g}"))
        held.append(claim(f"{scene}: the same particles", same_fields(built_in, custom)))
        bad = [name for name in ("particles", "steps") if built_in.summary[name]
               != custom.summary[name]]
        held.append(claim(f"{scene}: the same number of particles and steps", not bad))
    return held


LAYERS = """-scene custom
-gravity 9.3
-regions lower,upper
-region_lower_layer 0,2
-region_lower_material elastic
-region_lower_elastic_youngs_modulus 7e6
-region_lower_elastic_density 2100
-region_lower_K0 0.6
-region_upper_layer 1.2,2
-region_upper_material mohr_coulomb
-region_upper_mohr_coulomb_friction_angle 33
-region_upper_mohr_coulomb_density 1700
-region_upper_K0 0.45
-loads tank
-stage_run_until 0.02
"""
SPACES = {1: ["-domain", "0,2.4", "-cell_size", "0.1", "-walls", "fixed,free",
              "-load_tank_right", "8e3"],
          2: ["-domain", "0,0,0.8,2.4", "-cell_size", "0.1",
              "-walls", "roller,roller,roller,free",
              "-load_tank_top", "8e3"],
          3: ["-domain", "0,0,0,0.8,2.4,0.6", "-cell_size", "0.2",
              "-walls", "roller,roller,roller,free,roller,roller",
              "-load_tank_top", "8e3"]}


def layers_at_rest(program):
    file = program.base / "layers.opts"
    file.write_text(LAYERS, encoding="utf-8")
    held = []
    for dimension, space in SPACES.items():
        result = program.run(f"layers_{dimension}", "-options_file", str(file), "-dimension",
                             str(dimension), *space)
        fields = result.last_particles()
        up = 0 if dimension == 1 else 1
        y = fields["position"][:, up]
        exact = -(8e3 + 9.3 * numpy.where(y > 1.2, 1700 * (2.0 - y),
                                          1700 * 0.8 + 2100 * (1.2 - y)))
        error = numpy.abs(fields["stress"][:, up] - exact).max() / numpy.abs(exact).max()
        held.append(claim(f"{dimension}D: vertical stress stays the weight above", error < 0.02,
                          f"largest error {error:.2g} of the largest stress"))
        across = fields["stress"][:, 1 - up] / fields["stress"][:, up]
        K0 = numpy.where(y > 1.2, 0.45, 0.6)
        held.append(claim(f"{dimension}D: horizontal stress stays K0 of it",
                          numpy.abs(across - K0).max() < 0.02,
                          f"largest error {numpy.abs(across - K0).max():.2g}"))
        moved = numpy.abs(fields["displacement"]).max()
        held.append(claim(f"{dimension}D: nothing moves", moved < 2e-5, f"{moved:.2g} m"))
    return held


PADDLE = """-scene custom
-domain -1.5,-1.5,1.5,1.5
-cell_size 0.1
-walls roller,roller,roller,roller
-gravity 0
-flip_time 0.002
-regions jelly
-region_jelly_box -1.5,-1.5,1.5,1.5
-region_jelly_material elastic
-region_jelly_elastic_youngs_modulus 5e5
-region_jelly_elastic_poisson_ratio 0.2
-bodies paddle
-body_paddle_box -0.45,-0.25,0.35,0.35
-body_paddle_friction_law rough
-body_paddle_contour 0.15,0.6
-stage_run_until 0.5
"""


def paddle(program):
    """Velocity 0.3 and -0.1 m/s and spin 0.4 rad/s rise linearly in 0.2 s and stay."""
    file, motion = program.base / "paddle.opts", program.base / "motion.txt"
    file.write_text(PADDLE, encoding="utf-8")
    motion.write_text("# time, velocity, spin\n0 0 0 0\n0.2, 0.3, -0.1, 0.4\n", encoding="utf-8")
    result = program.run("paddle", "-options_file", str(file), "-body_paddle_motion", str(motion))
    last = {name: float(value) for name, value in result.rows[-1].items()}
    free = 0.1 + 0.3  # s at full speed, half of the ramp counting
    place = [last["paddle_x_m"] - (-0.05 + 0.3 * free), last["paddle_y_m"] - (0.05 - 0.1 * free),
             last["paddle_angle_rad"] - 0.4 * free]
    held = [claim("the paddle ends where its table says", max(map(abs, place)) < 2e-5, str(place))]
    for name in ("force_x_N_per_m", "force_y_N_per_m", "moment_N_m_per_m"):
        by_impulse, by_contour = (result.column(f"paddle_{kind}{name}")[-60:]
                                  for kind in ("", "contour_"))
        difference = by_contour.mean() / by_impulse.mean() - 1.0
        held.append(claim(f"{name}: both ways of measuring agree", abs(difference) < 0.05,
                          f"{by_impulse.mean():.4g} and {by_contour.mean():.4g}"))
    return held


def ledger_closes(result, body):
    """Impulses of all causes are the momentum, and the body's is the time integral of its rows."""
    residual = result.summary["ledger_momentum_residual"]
    held = [claim("the ledger of momentum closes", residual < 1e-11, f"{residual:.2g}")]
    columns = [name for name in result.rows[0] if name.startswith("ledger_impulse_body_" + body)]
    held.append(claim("each body has its cause in the history", len(columns) == 2, str(columns)))
    return held


def exact(program, _):
    held = layers_at_rest(program) + paddle(program)
    return held + ledger_closes(Result(program.base / "paddle"), "paddle")


def examples(program, inputs):
    held = []
    for file in sorted(inputs.glob("*.opts")):
        result = program.run(file.stem, "-options_file", str(file), "-max_steps", "40",
                             "-history_every", "10")
        finite = all(math.isfinite(float(value)) for row in result.rows for value in row.values())
        held.append(claim(f"{file.name} runs", finite and len(result.rows) == 4))
    return held


def main():
    launcher, program, inputs, part = sys.argv[1:]
    with tempfile.TemporaryDirectory() as directory:
        runner = Program(launcher, program, pathlib.Path(directory))
        parts = {"same_bits": same_bits, "exact": exact, "examples": examples}
        return 0 if all(parts[part](runner, pathlib.Path(inputs))) else 1


if __name__ == "__main__":
    sys.exit(main())
