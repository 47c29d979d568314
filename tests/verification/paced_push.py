"""paced_push.py LAUNCHER PROGRAM: a pipe that is pushed as fast as inertia allows keeps to its
tolerance, and the speed follows from the tolerance."""

import csv
import pathlib
import subprocess
import sys
import tempfile

PIPE = {"scene": "pipe", "pipe_cells_per_diameter": 4, "pipe_domain_width": 8,
        "pipe_domain_depth_below": 6, "pipe_far_cell_ratio": 3, "pipe_end_displacement": 0.06,
        "progress": "off"}
BEGUN = 0.02  # u/D, where the first waves have gone
# Of the kinetic energy allowed: mean and largest; as measured 0.57 and 1.16, 0.29 and 0.50, since
# the speed still rises here.
MEAN, LARGEST = (0.2, 1.1), 1.5


def columns(launcher, program, tolerance, directory):
    command = [launcher, "2", program, "-output_dir", str(directory)]
    for name, value in (PIPE | {"inertia_tolerance": tolerance}).items():
        command += [f"-{name}", str(value)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    with open(directory / "history.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if float(row["u_over_D"]) > BEGUN]
    return ([float(row["inertia"]) for row in rows],
            [float(row["velocity_m_per_s"]) for row in rows])


def claim(text, holds, figures):
    print(f"{'ok' if holds else 'FAILED'}: {text}: {figures}")
    return holds


def main():
    launcher, program = sys.argv[1:]
    held, speeds = [], {}
    with tempfile.TemporaryDirectory() as scratch:
        for tolerance in (0.04, 0.16):
            inertia, speed = columns(launcher, program, tolerance,
                                     pathlib.Path(scratch) / str(tolerance))
            speeds[tolerance] = sum(speed) / len(speed)
            shares = [value / tolerance for value in inertia]
            mean = sum(shares) / len(shares)
            held.append(claim(f"kinetic energy keeps to the tolerance {tolerance}",
                              MEAN[0] < mean < MEAN[1] and max(shares) < LARGEST,
                              f"{mean:.2f} of it in the mean, {max(shares):.2f} at most"))
    faster = speeds[0.16] / speeds[0.04]
    held.append(claim("four times the energy is nearly twice the speed", 1.4 < faster < 2.2,
                      f"{faster:.2f} times"))
    return 0 if all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
