"""Runs that cannot go on: exit code 3 on all ranks, and what failure.json says.

usage: failures_found.py LAUNCHER PROGRAM RANKS
"""

import json
import pathlib
import subprocess
import sys
import tempfile

SECONDS = 120
PLACE = ["step", "last_good_step", "time_s", "stage"]
PARTICLE = ["particle", "position_m", "velocity_m_per_s", "stress_Pa", "material", "neighbours"]
# Options, kind of the failure, what `try` has to name, and keys.
CASES = {
    "an unstable step": ("-scene bar -cells 20 -basis linear -courant 2 -progress off",
                         "particle_lost", "-courant: it is 2", PLACE + PARTICLE),
}
# The law is far too stiff for so small a stress: solved in bounded time, or refused with a reason.
SMALL_PRESSURE = ("-scene material_point -sand_pressure_floor 0.01 -increments 50 "
                  "-confining_pressure 1")


def fault_of(command, directory, kind, remedy, keys):
    done = subprocess.run(command, check=False, text=True, capture_output=True, timeout=SECONDS)
    if done.returncode != 3:
        return f"exit code {done.returncode}, not 3: {done.stderr}"
    details = json.loads((directory / "failure.json").read_text(encoding="utf-8"))
    missing = [key for key in ["kind", "message", "try", *keys] if key not in details]
    if missing:
        return f"failure.json has no {', '.join(missing)}"
    if details["kind"] != kind or remedy not in details["try"]:
        return f"kind {details['kind']}, try {details['try']}"
    if "particle" in keys and details["last_good_step"] != details["step"] - 1:
        return "the last good step is not the one before"
    return None


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    launch, failed = [sys.argv[1], sys.argv[3], sys.argv[2]], 0
    with tempfile.TemporaryDirectory() as base:
        for name, (words, *expected) in CASES.items():
            directory = pathlib.Path(base) / name.replace(" ", "_")
            command = [*launch, *words.split(), "-output_dir", str(directory)]
            fault = fault_of(command, directory, *expected)
            print(f"{'FAIL' if fault else 'ok  '} {name}{': ' + fault if fault else ''}")
            failed += bool(fault)
        point = subprocess.run([sys.argv[2], *SMALL_PRESSURE.split(), "-output_dir", f"{base}/point"],
                               check=False, timeout=SECONDS, stdout=subprocess.DEVNULL)
        print(f"{'FAIL' if point.returncode else 'ok  '} an element test at 1 Pa")
    return 1 if failed or point.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
