"""Runs whose disk is full, or whose files must not grow any more.

usage: disk_full.py LAUNCHER PROGRAM RANKS disk|limit

disk: in a small tmpfs, mounted where only this test sees it; skipped (exit code 77) where that is
    not allowed. The room is such that each kind of file in turn does not fit.
limit: under a limit to the size of files, as `ulimit -f` sets it, from some moment of the run on.

A run has to stop with exit code 3, naming file and cause; a checkpoint that it has left has to be
whole: with more room the run goes on from it to the bits of the run that nothing disturbed. Needs
h5py, as the tools do.
"""

import ctypes
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from restart import PIPE, SECONDS, Program, lists_of, ranks_of, results, wait_for  # noqa: E402

SKIPPED = 77
FAILED = 3
WORDS = f"{PIPE} -contact_detection spring -particle_output_every 20 -progress on"
LONG = f"{PIPE} -contact_detection spring -progress on -max_steps 1500"
POINT = "-scene material_point"
CHECKPOINTS = f"{WORDS} -max_steps 60 -checkpoint_every 20"
TOO_LARGE = "File too large"
PAGE = 4096
ROOM = 64 << 20


def mount_private(path):
    """A tmpfs that no other process sees; False where that is not allowed."""
    libc = ctypes.CDLL(None, use_errno=True)
    new_mounts, private_and_recursive = 0x00020000, 0x44000
    return (libc.unshare(new_mounts) == 0
            and libc.mount(b"none", b"/", None, private_and_recursive, None) == 0
            and libc.mount(b"tmpfs", bytes(path), b"tmpfs", 0, f"size={ROOM}".encode()) == 0)


def leave_room(base, room):
    """Fills the disk up to so many bytes."""
    ballast = base / "ballast"
    ballast.unlink(missing_ok=True)
    free = shutil.disk_usage(base).free
    with ballast.open("wb") as file:
        os.posix_fallocate(file.fileno(), 0, free - room)


def pages(path):
    return -(-path.stat().st_size // PAGE) * PAGE


def first_half_of(wanted, whole):
    """Room for all that a run writes before this file, and for half of it."""
    order = ["result_files.txt", "used.opts", "history.csv"]
    for k in range(10):
        order += [f"particles_{k:06}.h5", f"grid_{k:06}.h5"]
    room = 0
    for name in order:
        if name == wanted:
            return room + pages(whole / name) // 2 // PAGE * PAGE
        room += pages(whole / name)
    raise AssertionError(f"{wanted} is not written")


def fault_of(done, named, cause):
    """What is wrong with the end of a run that could not write this file."""
    if done.returncode != FAILED:
        return f"exit code {done.returncode}, not {FAILED}: {done.stderr}"
    if named not in done.stderr or cause not in done.stderr:
        return f"does not name {named} and '{cause}': {done.stderr}"
    return None


def goes_on(program, ranks, words, directory, whole):
    """Whether the run goes on to the bits of the whole one."""
    printed = program.run(ranks, f"{words} -restart auto", directory)
    if "goes on from" not in printed:
        return f"does not go on: {printed}"
    before, after = results(whole), results(directory)
    wrong = [name for name in before if after.get(name) != before[name]]
    if lists_of(whole) != lists_of(directory):
        wrong.append("xdmf")
    wrong += [path.name for path in directory.glob("*.part")]
    return f"differ: {', '.join(wrong[:5])}" if wrong else None


def run_in(program, ranks, words, directory):
    return subprocess.run(program.command(ranks, words, directory), check=False, text=True,
                          capture_output=True, timeout=SECONDS)


def on_full_disk(program, ranks, base):
    """Yields what was tried and what was wrong."""
    whole = base / "whole"
    words = f"{WORDS} -max_steps 60"
    program.run(ranks, words, whole)
    checkpoint = base / "with_checkpoint"
    program.run(ranks, CHECKPOINTS, checkpoint)
    size = pages(checkpoint / "checkpoint.h5")
    shutil.rmtree(checkpoint)
    point = base / "point"
    program.run(ranks, POINT, point)
    all_but_summary = sum(pages(path) for path in point.iterdir() if path.name != "summary.json")
    few = pages(whole / "used.opts") + PAGE
    cases = {
        "used.opts": (words, PAGE, "used.opts"),
        "failure.json": (words, few, "failure.json"),
        "history": (words, few, "history.csv"),
        "fields": (words, first_half_of("particles_000001.h5", whole), "particles_000001.h5"),
        "nodes": (words, first_half_of("grid_000001.h5", whole), "grid_000001.h5"),
        "summary": (POINT, all_but_summary, "summary.json"),
        "first checkpoint": (CHECKPOINTS, few + size // 2, "checkpoint.h5"),
        "next checkpoint": (CHECKPOINTS, few + size + size // 2, "checkpoint.h5"),
    }
    for name, (options, room, named) in cases.items():
        directory = base / name.replace(" ", "_")
        leave_room(base, room)
        done = run_in(program, ranks, options, directory)
        fault = fault_of(done, named, "No space left on device")
        if not fault and list(directory.glob("*.part")):
            fault = "leaves parts of files"
        if not fault and name == "next checkpoint":
            leave_room(base, ROOM // 2)
            fault = goes_on(program, ranks, CHECKPOINTS, directory, whole)
        yield name, fault
        shutil.rmtree(directory)


def limited_from(program, ranks, words, directory, sign, size):
    """Runs, and lets no file grow beyond the size once the file `sign` is there: MPI could not start
    under such a limit."""
    run = program.start(words, directory, ranks)
    wait_for(lambda: (directory / sign).exists() or run.poll() is not None, sign)
    for process in ranks_of(directory):
        resource.prlimit(process, resource.RLIMIT_FSIZE, (size, size))
    printed = run.communicate(timeout=SECONDS)[0]
    return subprocess.CompletedProcess(run.args, run.returncode, stderr=printed)


def with_limit(program, ranks, base):
    """Yields what was tried and what was wrong."""
    table = f"{LONG} -history_every 1"
    yield "history", fault_of(limited_from(program, ranks, table, base / "history", "grid.xdmf",
                                           2 * PAGE), "history.csv", TOO_LARGE)
    yield "fields", fault_of(limited_from(program, ranks, f"{LONG} -particle_output_every 300",
                                          base / "fields", "used.opts", 20 * PAGE),
                             "particles_0000", TOO_LARGE)
    whole, directory = base / "whole", base / "checkpoint"
    program.run(ranks, LONG, whole)
    words = f"{LONG} -checkpoint_every 25"
    fault = fault_of(limited_from(program, ranks, words, directory, "grid.xdmf", 20 * PAGE),
                     "checkpoint.h5", TOO_LARGE)
    yield "next checkpoint", fault or goes_on(program, ranks, words, directory, whole)


def failures(outcomes):
    failed = 0
    for name, fault in outcomes:
        print(f"{'FAIL' if fault else 'ok  '} {name}{': ' + fault if fault else ''}", flush=True)
        failed += bool(fault)
    return failed


def main():
    if len(sys.argv) != 5 or sys.argv[4] not in ("disk", "limit"):
        sys.exit(__doc__)
    program, ranks, part = Program(*sys.argv[1:3]), int(sys.argv[3]), sys.argv[4]
    with tempfile.TemporaryDirectory() as directory:
        base = pathlib.Path(directory)
        if part == "limit":
            return 1 if failures(with_limit(program, ranks, base)) else 0
        if not mount_private(os.fsencode(base)):
            print("skipped: no tmpfs may be mounted here")
            return SKIPPED
        try:
            return 1 if failures(on_full_disk(program, ranks, base)) else 0
        finally:
            subprocess.run(["umount", str(base)], check=True)


if __name__ == "__main__":
    sys.exit(main())
