"""Runs that are killed at random moments and go on with `-restart auto`.

usage: kills.py LAUNCHER PROGRAM KILLS [SEED [TABLE]]

A coarse pipe on two ranks is killed with SIGKILL one to three times, the whole job or one rank
only, anywhere between its start and its end; then it is left to finish. It has to end with the bits
of the run that nobody disturbed: history, answers, fields, lists of fields. A process that is still
there after the time allowed is a failure. TABLE (CSV) gets a row for each kill; rounds that are in
it already are not run again. Needs h5py, as the tools do.
"""

import csv
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "verification"))
from restart import FINISHED, PIPE, Program, lists_of, ranks_of, results  # noqa: E402

WORDS = (f"{PIPE} -contact_detection spring -max_steps 1500 -history_every 20 "
         "-particle_output_every 300 -checkpoint_every 25 -restart auto -progress off")
COLUMNS = ["round", "kill", "victim", "share_of_run", "exit_code", "checkpoint", "parts_left",
           "outcome"]
SECONDS_TO_DIE = 30
SECONDS_TO_FINISH = 120
KILLED = {-signal.SIGKILL, 128 + signal.SIGKILL}


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass


def wait_until_gone(directory, seconds):
    """Whether no process writes there any more."""
    end = time.monotonic() + seconds
    while ranks_of(directory):
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def strike(run, victim, directory):
    """Kills the launcher with all ranks, or one rank, whose launcher has to end the others."""
    ranks = ranks_of(directory)
    if victim == "job":
        run.kill()
    for rank in ranks if victim == "job" else ranks[-1:] if victim == "last" else ranks[:1]:
        kill(rank)


def end_all(run, directory):
    run.kill()
    for rank in ranks_of(directory):
        kill(rank)


def one_kill(program, directory, victim, delay):
    """Starts the run, kills it after so many seconds; returns its exit code and what is wrong."""
    run = program.start(WORDS, directory)
    try:
        run.communicate(timeout=delay)
        return run.returncode, "" if run.returncode in FINISHED else "ended by itself"
    except subprocess.TimeoutExpired:
        pass
    strike(run, victim, directory)
    try:
        run.communicate(timeout=SECONDS_TO_DIE)
    except subprocess.TimeoutExpired:
        end_all(run, directory)
        return run.returncode, "the launcher hangs"
    if not wait_until_gone(directory, SECONDS_TO_DIE):
        end_all(run, directory)
        return run.returncode, "a rank hangs"
    # Launchers are killed before they have ranks, and ranks in the moment in which they finish.
    return run.returncode, "" if run.returncode in KILLED | set(FINISHED) else "another exit code"


def differences(whole, directory):
    """Of everything that a run has written."""
    before, after = results(whole), results(directory)
    wrong = [name for name in before if after.get(name) != before[name]]
    wrong += [name for name in after if name not in before]
    if lists_of(whole) != lists_of(directory):
        wrong.append("xdmf")
    wrong += [path.name for path in directory.glob("*.part")]
    return f"differ: {' '.join(wrong[:5])}" if wrong else ""


def finish(program, whole, directory):
    """Lets the run end; returns what is wrong."""
    try:
        program.run(2, WORDS, directory)
    except AssertionError as fault:
        return " ".join(str(fault).split())
    except subprocess.TimeoutExpired:
        return "hangs when it goes on"
    return differences(whole, directory)


def one_round(program, whole, base, number, choice, seconds):
    """Rows of the table; the round fails as a whole."""
    directory = base / f"round_{number}"
    rows = []
    for count in range(choice.randint(1, 3)):
        victim, share = choice.choice(["job", "first", "last"]), choice.random()
        code, fault = one_kill(program, directory, victim, share * seconds)
        rows.append({"round": number, "kill": count, "victim": victim,
                     "share_of_run": f"{share:.3f}", "exit_code": code,
                     "checkpoint": int((directory / "checkpoint.h5").exists()),
                     "parts_left": len(list(directory.glob("*.part"))), "outcome": fault})
        if fault:
            break
    fault = rows[-1]["outcome"] or finish(program, whole, directory)
    for row in rows:
        row["outcome"] = fault or "same bits"
    if not fault:
        shutil.rmtree(directory, ignore_errors=True)
    return rows


def rows_of(table):
    if table is None or not table.exists():
        return []
    with table.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def keep(table, rows):
    if table is None:
        return
    with table.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def undisturbed(program, whole):
    """Seconds of the run that nobody disturbs."""
    begin = time.monotonic()
    program.run(2, WORDS, whole)
    return time.monotonic() - begin


def campaign(program, base, kills, seed, table):
    seconds = undisturbed(program, base / "whole")
    rows = rows_of(table)
    number = max([int(row["round"]) + 1 for row in rows], default=0)
    while len(rows) < kills:
        more = one_round(program, base / "whole", base, number,
                         random.Random(f"{seed} {number}"), seconds)
        rows += more
        keep(table, rows)
        print(f"round {number}: {len(more)} kills, {more[0]['outcome']}", flush=True)
        number += 1
    failed = [row for row in rows if row["outcome"] != "same bits"]
    print(f"{len(rows)} kills, {len(failed)} of them in rounds that failed; "
          f"the run takes {seconds:.1f} s undisturbed")
    return 1 if failed else 0


def main():
    if not 4 <= len(sys.argv) <= 6:
        sys.exit(__doc__)
    program, kills = Program(*sys.argv[1:3]), int(sys.argv[3])
    seed = int(sys.argv[4]) if len(sys.argv) > 4 else 1
    table = pathlib.Path(sys.argv[5]) if len(sys.argv) > 5 else None
    with tempfile.TemporaryDirectory() as directory:
        return campaign(program, pathlib.Path(directory), kills, seed, table)


if __name__ == "__main__":
    sys.exit(main())
