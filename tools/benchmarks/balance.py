"""Largest over mean number of particles of a rank on 4, 8 and 64 ranks that need not be there, for a
collapsing column and a pipe at several moments."""

import pathlib
import subprocess
import tempfile

import h5py
import numpy as np

from .common import BUILD, PROGRAMS, provenance, rows_of, run_on_ranks
from .tables import Table

TABLES = (Table("load_balance", ("scene", "moment", "ranks", "method"), ("max_over_mean",)),)

# With linear splines the nodes that are written stand on the lines of the cells.
SCENES = {
    "collapse": ["-scene", "collapse", "-cells", "40", "-particle_output_times", "0.25,0.5,1",
                 "-end_time", "1"],
    "pipe": ["-scene", "pipe", "-pipe_velocity", "0.2", "-pipe_cells_per_diameter", "8", "-pipe_domain_width", "6",
             "-pipe_domain_depth_below", "4", "-max_steps", "300",
             "-particle_output_every", "300"],
}


def counts_of(directory, number):
    """Particles in every cell, x fastest, as numbers of cells and text."""
    with h5py.File(directory / f"grid_{number}.h5") as grid:
        lines = [grid[f"nodes_{axis}"][()] for axis in "xy"]
    with h5py.File(directory / f"particles_{number}.h5") as particles:
        x = particles["position"][()]
    counts, _, _ = np.histogram2d(x[:, 1], x[:, 0], bins=lines[::-1])
    if counts.sum() != len(x):
        raise RuntimeError("particles outside the grid")
    cells = f"{len(lines[0]) - 1} {len(lines[1]) - 1}"
    return cells + "\n" + " ".join(str(int(count)) for count in counts.ravel())


def moment_of(directory, number):
    with h5py.File(directory / f"particles_{number}.h5") as particles:
        return f"{float(particles.attrs['time_s']):.3g}s"


def histograms(scene, arguments):
    """One for each moment."""
    with tempfile.TemporaryDirectory() as temporary:
        directory = pathlib.Path(temporary)
        run_on_ranks(1, [BUILD / "mpmsolve", *arguments, "-basis", "linear", "-progress", "off",
                         "-output_dir", directory])
        numbers = sorted(path.stem.split("_")[1] for path in directory.glob("particles_*.h5"))
        moments = {moment_of(directory, number): counts_of(directory, number)
                   for number in numbers}
        return [f"{scene} {moment} {counts}" for moment, counts in moments.items()]


def measure(_effort):
    text = [histogram for scene, arguments in SCENES.items()
            for histogram in histograms(scene, arguments)]
    printed = subprocess.run([PROGRAMS / "load_balance"], input="\n".join(text), text=True, check=True,
                             stdout=subprocess.PIPE).stdout
    return {"load_balance": [row | provenance(" ".join(SCENES[row["scene"]]) + " -basis linear")
                             for row in rows_of(printed)]}
