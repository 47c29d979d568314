"""used.opts repeats the run that wrote it, bit for bit.

usage: used_options.py LAUNCHER PROGRAM
"""

import pathlib
import subprocess
import sys
import tempfile

CYCLE = "increments, strain_yy, stress_xx_Pa, stress_zz_Pa\n20, 0.01, hold, hold\n20, 0.002, hold, hold\n"

# Every kind of default that one option gives others, and options that others make ineffective.
RUNS = {
    "element": "-scene material_point -strain_end 0.05",
    "path": "-scene material_point -test path -path_file PATH",
    "another_law": "-scene material_point -material mohr_coulomb -strain_end 0.02",
    "another_sand": "-scene material_point -sand toyoura -sand_relative_density 0.55",
    "single_constants": "-scene material_point -sand stockton_paper -sand_bulk poisson "
                        "-sand_poisson 0.1 -sand_m 3.7",
    "pipe": "-scene pipe -sand toyoura -pipe_cells_per_diameter 4 -pipe_domain_width 4 "
            "-pipe_domain_depth_below 3 -geostatic_reaction_tolerance 0.3 -max_steps 40",
    "biaxial": "-scene biaxial -cell_size 0.25 -rest_tolerance 0.1 -max_steps 150",
}


def history(command, directory, arguments):
    """The rows that a run writes into its directory."""
    subprocess.run([*command, *arguments, "-output_dir", str(directory)], check=True,
                   stdout=subprocess.DEVNULL, timeout=120)
    return (directory / "history.csv").read_bytes()


def main():
    launcher, program = sys.argv[1:]
    command = [launcher, "1", program]
    failed = 0
    with tempfile.TemporaryDirectory() as base:
        path = pathlib.Path(base) / "path.csv"
        path.write_text(CYCLE, encoding="utf-8")
        for name, words in RUNS.items():
            first, again = (pathlib.Path(base) / f"{name}_{which}" for which in ("first", "again"))
            rows = history(command, first, words.replace("PATH", str(path)).split())
            same = rows == history(command, again, ["-options_file", str(first / "used.opts")])
            print(f"{'ok  ' if same else 'FAIL'} {name}: the same history from used.opts")
            failed += not same
    return failed


if __name__ == "__main__":
    sys.exit(main())
