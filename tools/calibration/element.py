"""Element tests by the program's material_point scene, many at a time."""

import concurrent.futures
import dataclasses
import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np

from .tables import BadInput

# One rank needs no launcher and no network, and starts in a fifth of the time without (Open MPI).
ALONE = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_btl": "self", "OMPI_MCA_pml": "ob1"}
NORMAL = ("stress_xx_Pa", "stress_yy_Pa", "stress_zz_Pa")
BAD_INPUT, STOPPED = 2, 3  # exit codes of the program that are its answer


@dataclasses.dataclass
class Response:
    """Columns of a computed test. Strains have the signs of compression positive."""

    strain: np.ndarray
    ratio: np.ndarray  # sigma1/sigma3
    volume: np.ndarray

    def peak(self):
        """Friction angle in degrees and size of the strain, by a parabola through three rows."""
        k = int(np.argmax(self.ratio))
        ratio, strain = self.ratio[k], abs(self.strain[k])
        if 0 < k < len(self.ratio) - 1:
            before, after = self.ratio[k - 1], self.ratio[k + 1]
            bend = before - 2.0 * ratio + after
            shift = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
            strain += shift * abs(self.strain[k + 1] - self.strain[k])
            ratio -= 0.25 * (before - after) * shift
        return float(np.degrees(np.arcsin((ratio - 1.0) / (ratio + 1.0)))), float(strain)

    def at(self, strains, values):
        return np.interp(np.abs(strains), np.abs(self.strain), values)


class Failed(Exception):
    """The program gave no answer to a test; the message is its own."""


class Program:
    """Answers to tests; what was once computed is kept."""

    def __init__(self, path, at_once, strain_end, increments):
        self.path, self.strain_end, self.increments = path, strain_end, increments
        self.pool = concurrent.futures.ThreadPoolExecutor(at_once)
        self.known = {}

    @property
    def runs(self):
        return len(self.known)

    def responses(self, sands, tests):
        """For each sand, a dictionary of options, the list of a Response or Failed per test."""
        keys = [[(test.name, tuple(sorted(sand.items()))) for test in tests] for sand in sands]
        for sand, row in zip(sands, keys):
            for key, test in zip(row, tests):
                if key not in self.known:
                    self.known[key] = self.pool.submit(self._answer, sand, test)
        return [[self.known[key].result() for key in row] for row in keys]

    def _answer(self, sand, test):
        try:
            with tempfile.TemporaryDirectory(prefix="calibrate-") as directory:
                self.run(sand, test, directory)
                return read_response(pathlib.Path(directory) / "history.csv")
        except Failed as failed:
            return failed

    def options(self, sand, test):
        return {
            "scene": "material_point", "test": test.mode, "confining_pressure": test.sigma3,
            "sand_cohesion": 0, "sand_tolerance": 1e-6, "increments": self.increments,
            "strain_end": max(self.strain_end, test.last_strain)} | sand | {
            "sand_void_ratio": test.void_ratio}

    def run(self, sand, test, directory):
        command = [str(self.path), "-output_dir", str(directory)]
        for name, value in self.options(sand, test).items():
            command += [f"-{name}", str(value)]
        # Runs side by side must not share the directory that MPI makes and removes.
        alone = ALONE | {"OMPI_MCA_orte_tmpdir_base": str(directory)}
        done = start(command, os.environ | alone)
        if done.returncode not in (0, BAD_INPUT, STOPPED):
            done = start(command, os.environ)
        if done.returncode != 0:
            last = (done.stderr or done.stdout).strip().splitlines() or ["no message"]
            raise Failed(f"test {test.name}: {last[-1]}")

    def defaults(self, sand, test):
        """All options of a run at the start, which also shows whether the program takes them."""
        with tempfile.TemporaryDirectory(prefix="calibrate-") as directory:
            try:
                self.run(sand, test, directory)
            except Failed as failed:
                raise BadInput(str(failed)) from failed
            with open(pathlib.Path(directory) / "summary.json", encoding="utf-8") as file:
                summary = json.load(file)
        prefix = "option_"
        return {key.removeprefix(prefix): value for key, value in summary.items()
                if key.startswith(prefix) or key in ("git_hash", "version")}


def start(command, environment):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=False,
                              env=environment)
    except OSError as error:
        raise BadInput(f"the program cannot be run: {error}") from error


def read_response(path):
    with open(path, encoding="utf-8") as file:
        names = file.readline().strip().split(",")
        table = dict(zip(names, np.loadtxt(file, delimiter=",", ndmin=2).T))
    stresses = np.array([table[name] for name in NORMAL])
    return Response(table["axial_strain"], stresses.max(axis=0) / stresses.min(axis=0),
                    table["volumetric_strain"])
