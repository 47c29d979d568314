"""Runs that are interrupted and go on from their checkpoint.

usage: restart.py LAUNCHER PROGRAM scenes|ranks|signals

scenes: every scene on a grid, put back on the same ranks, gives the bits of the uninterrupted run:
    tables, answers, fields.
ranks: on other ranks it gives the same but for the growth of round-off.
signals: what stops a run, what it leaves and what it prints; killed runs go on as well.
Needs h5py, as the tools do.
"""

import concurrent.futures
import csv
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "regression"))
from same_bits import PIPE, bits_of  # noqa: E402

STOPPED_EARLY = 75
FINISHED = (0, 4)  # coarse runs have answers that are withheld
SECONDS = 120
FIELDS = "-progress on -particle_output_every 20"
CUBE = "-scene triaxial -cells 4 -triaxial_velocity 0.3"
TRENCH = "-options_file {root}/input/custom/trench_with_pipe.opts"

# All but patch, which has one step: options of a short run, and the steps between its checkpoints, the last of which it goes on from.
SCENES = {
    "pipe_spring": (f"{PIPE} -max_steps 60 -contact_detection spring", 37),
    "pipe_gap": (f"{PIPE} -max_steps 60 -contact_detection gap -pipe_far_cell_ratio 1.5", 37),
    "pipe_velocity": (f"{PIPE} -max_steps 60 -contact_detection velocity -contact_normal gradient",
                      37),
    "pipe_particle": (f"{PIPE} -max_steps 60 -contact_detection particle -average_volume", 37),
    "pipe_paced": (PIPE.replace("-pipe_velocity 0.2", "-max_steps 60"), 37),
    "pipe_at_rest": (f"{PIPE} -max_steps 90 -counted_stage geostatic -contact_detection spring", 70),
    "pipe_regularised": (f"{PIPE} -max_steps 60 -regularisation_length 0.025", 37),
    "biaxial": ("-scene biaxial -cell_size 0.25 -rest_tolerance 0.1 -max_steps 150 "
                "-history_every 20", 67),
    "triaxial": (f"{CUBE} -max_steps 30 -basis quadratic", 17),
    "mms1d": ("-scene mms1d -cells 32 -max_steps 150 -basis gimp -update usf", 83),
    "vortex": ("-scene vortex -cells 16 -max_steps 30 -transfer apic", 17),
    "incline": ("-scene incline -max_steps 60 -counted_stage settling", 37),
    "incline_disc": ("-scene incline -body disc -max_steps 60 -counted_stage settling", 37),
    "column": ("-scene column -cells 16 -max_steps 300", 170),
    "bar": ("-scene bar -cells 20 -max_steps 150 -basis linear", 83),
    "discs": ("-scene discs -cells 10 -courant 0.9 -max_steps 90 -basis ddmp", 57),
    "discs_metis": ("-scene discs -cells 10 -courant 0.9 -max_steps 90 -load_balance metis "
                    "-rebalance_above 1.001", 57),
    "rotation": ("-scene rotation -max_steps 60", 37),
    "rotation_free": ("-scene rotation -turn free -max_steps 60", 37),
    "traction": ("-scene traction -max_steps 150 -transfer pic", 83),
    "reversal": ("-scene reversal -cells 3 -cycles 1 -strain_rate 1 -max_steps 60 -update usf", 37),
    "collapse": ("-scene collapse -cells 8 -base frictional -max_steps 150", 83),
    "gap": ("-scene gap -cells 10 -body circle -offset 0.3 -max_steps 100", 57),
    "hertz": ("-scene hertz -cells 16 -max_steps 150 -update usl", 83),
    "footing": ("-scene footing -cells 4 -max_steps 150", 83),
    "custom": (f"{TRENCH} -max_steps 60", 37),
}
# Options, steps between checkpoints, and the largest difference of a column of history.csv as a
# share of its largest value.
ON_OTHER_RANKS = {
    "pipe": (f"{PIPE} -max_steps 300 -contact_detection spring", 201, 1e-8),
    "pipe_gap": (f"{PIPE} -max_steps 300 -contact_detection gap", 201, 1e-8),
    "biaxial": ("-scene biaxial -cell_size 0.25 -rest_tolerance 0.1 -max_steps 300", 157, 1e-8),
    "discs_metis": ("-scene discs -cells 10 -courant 0.9 -load_balance metis -max_steps 90", 57,
                    1e-10),
    "triaxial": (f"{CUBE} -max_steps 60", 37, 1e-9),
    "reversal": ("-scene reversal -cells 3 -cycles 1 -strain_rate 1 -max_steps 60", 37, 1e-10),
    "hertz": ("-scene hertz -cells 16 -max_steps 150", 83, 1e-10),
    "collapse": ("-scene collapse -cells 8 -base frictional -max_steps 150", 83, 1e-10),
    "custom": (f"{TRENCH} -max_steps 60", 37, 1e-9),
}
LONG_PIPE = (f"{PIPE} -max_steps 1500 -progress on -contact_detection spring -history_every 20 "
             "-restart auto")


class Program:
    def __init__(self, launcher, program):
        self.launcher, self.program = launcher, program
        self.root = pathlib.Path(__file__).resolve().parent.parent.parent

    def command(self, ranks, words, directory):
        return [self.launcher, str(ranks), self.program, *words.format(root=self.root).split(),
                "-output_dir", str(directory)]

    def run(self, ranks, words, directory, expected=0):
        """Returns what a run prints; it has to return `expected`."""
        done = subprocess.run(self.command(ranks, words, directory), check=False, text=True,
                              capture_output=True, timeout=SECONDS)
        if done.returncode != expected and {done.returncode, expected} != set(FINISHED):
            raise AssertionError(f"exit code {done.returncode}, not {expected}: {done.stderr}")
        return done.stdout + done.stderr

    def start(self, words, directory, ranks=2):
        return subprocess.Popen(self.command(ranks, words, directory), text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def results(directory):
    checkpoint = directory / "checkpoint.h5"
    if checkpoint.exists():
        checkpoint.unlink()
    bits = bits_of(directory)
    return {name: value for name, value in bits.items()
            if not any(f"option_{name_}" in name
                       for name_ in ("restart", "checkpoint_every", "wall_time_limit"))}


def lists_of(directory):
    return {path.name: path.read_text(encoding="utf-8") for path in directory.glob("*.xdmf")}


def same_bits(program, name, base):
    words, every = SCENES[name]
    whole, broken = base / f"{name}_whole", base / f"{name}_broken"
    program.run(2, f"{words} {FIELDS}", whole)
    words = f"{words} {FIELDS} -checkpoint_every {every} -restart auto"
    program.run(2, words, broken)
    if not (broken / "checkpoint.h5").exists():
        return "no checkpoint"
    (broken / "summary.json").unlink()  # it has not finished
    printed = program.run(2, words, broken)
    if "goes on from" not in printed:
        return f"does not go on: {printed}"
    before, after = results(whole), results(broken)
    wrong = [thing for thing in before if after.get(thing) != before[thing]]
    wrong += [thing for thing in after if thing not in before]
    if lists_of(whole) != lists_of(broken):
        wrong.append("xdmf")
    return f"differ: {', '.join(wrong[:5])}" if wrong else None


def table(directory):
    rows = list(csv.DictReader((directory / "history.csv").read_text(encoding="utf-8").splitlines()))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def difference(one, other):
    """Over the columns the largest difference as a share of the column's largest value."""
    largest = 0.0
    for name, values in one.items():
        if len(values) != len(other[name]):
            return float("inf")
        scale = max(map(abs, values)) or 1.0
        if name.startswith("ledger_") or name in ("out_of_balance", "error_momentum"):
            continue  # small differences of large sums
        largest = max([largest, *(abs(a - b) / scale for a, b in zip(values, other[name]))])
    return largest


def on_other_ranks(program, name, base):
    words, every, allowed = ON_OTHER_RANKS[name]
    whole = base / f"{name}_whole"
    program.run(2, f"{words} -history_every 10 -checkpoint_every {every}", whole)
    found = []
    for ranks in (1, 3):
        moved = base / f"{name}_{ranks}"
        program.run(ranks, f"{words} -history_every 10 -restart {whole}/checkpoint.h5", moved)
        found.append(difference(table(whole), table(moved)))
        if not found[-1] <= allowed:
            return f"on {ranks} ranks off by {found[-1]:.2g}"
    print(f"     {name}: off by {found[0]:.2g} on one rank, {found[1]:.2g} on three")
    return None


def wait_for(condition, what):
    end = time.monotonic() + SECONDS
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"waited for {what} in vain")
        time.sleep(0.02)


def ranks_of(directory):
    """Processes of the program that write there."""
    found = []
    for process in pathlib.Path("/proc").iterdir():
        if not process.name.isdigit():
            continue
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if words[0].endswith(b"mpmsolve") and str(directory).encode() in words:
            found.append(int(process.name))
    return sorted(found)


def rows(directory):
    path = directory / "history.csv"
    return len(path.read_text(encoding="utf-8").splitlines()) if path.exists() else 0


def interrupted(program, base, name, stop, expected, words=""):
    """Starts a run, stops it in the main stage, and lets it go on; it has to give what the whole run
    gave."""
    directory = base / name
    run = program.start(f"{LONG_PIPE} {words}", directory)
    wait_for(lambda: rows(directory) > 3 or run.poll() is not None, "rows")
    asked = time.monotonic()
    stop(run, directory)
    printed = run.communicate(timeout=SECONDS)[0]
    took = time.monotonic() - asked
    if run.returncode != expected and {run.returncode, expected} != set(FINISHED):
        return f"exit code {run.returncode}, not {expected}: {printed}"
    if expected == STOPPED_EARLY and (took > 5.0 or "checkpoint" not in printed):
        return f"took {took:.1f} s: {printed}"
    if not (directory / "checkpoint.h5").exists():
        return "no checkpoint"
    if expected != 0:
        printed = program.run(2, LONG_PIPE, directory)
        if "goes on from" not in printed:
            return f"does not go on: {printed}"
    whole = (base / "whole" / "history.csv").read_bytes()
    return None if whole == (directory / "history.csv").read_bytes() else "another history"


def to_launcher(number):
    return lambda run, directory: run.send_signal(number)


def to_last_rank(number):
    return lambda run, directory: os.kill(ranks_of(directory)[-1], number)


def signals(program, base):
    whole = base / "whole"
    program.run(2, LONG_PIPE, whole)
    yield "USR2 at the launcher", interrupted(program, base, "usr2", to_launcher(signal.SIGUSR2),
                                              STOPPED_EARLY)
    yield "TERM at one rank", interrupted(program, base, "term", to_last_rank(signal.SIGTERM),
                                          STOPPED_EARLY)
    yield "USR1 goes on", interrupted(program, base, "usr1", to_last_rank(signal.SIGUSR1), 0)
    yield "KILL", interrupted(program, base, "kill", to_last_rank(signal.SIGKILL), 137,
                              "-checkpoint_every 50")
    yield "wall time", interrupted(program, base, "limit", lambda *_: None, STOPPED_EARLY,
                                   "-wall_time_limit 0.002")  # 0.1 s, before any run ends
    yield "finished", finished(program, whole)
    yield "nobody reads", unread(program, base)


def finished(program, whole):
    before = (whole / "summary.json").read_bytes()
    printed = program.run(2, LONG_PIPE, whole)
    same = (whole / "summary.json").read_bytes() == before
    return None if same and "is finished" in printed else printed


def unread(program, base):
    """A reader of the output who goes away costs no run."""
    directory = base / "unread"
    run = subprocess.Popen([program.program, *PIPE.split(), "-max_steps", "60", "-progress", "on",
                            "-output_dir", str(directory)], stdout=subprocess.PIPE)
    run.stdout.close()
    code = run.wait(timeout=SECONDS)
    return None if code == 0 and (directory / "summary.json").exists() else f"exit code {code}"


def of_all(names, check, program, base):
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        jobs = {name: pool.submit(check, program, name, base) for name in names}
        for name, job in jobs.items():
            try:
                yield name, job.result()
            except (AssertionError, subprocess.TimeoutExpired) as fault:
                yield name, str(fault)


def main():
    if len(sys.argv) != 4 or sys.argv[3] not in ("scenes", "ranks", "signals"):
        sys.exit(__doc__)
    program, part = Program(*sys.argv[1:3]), sys.argv[3]
    failed = 0
    with tempfile.TemporaryDirectory() as directory:
        base = pathlib.Path(directory)
        outcomes = {"scenes": lambda: of_all(SCENES, same_bits, program, base),
                    "ranks": lambda: of_all(ON_OTHER_RANKS, on_other_ranks, program, base),
                    "signals": lambda: signals(program, base)}[part]()
        for name, fault in outcomes:
            print(f"{'FAIL' if fault else 'ok  '} {name}{': ' + fault if fault else ''}", flush=True)
            failed += bool(fault)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
