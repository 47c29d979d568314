"""Reads what a run has left in its output directory."""

import csv
import glob
import json
import os
import shlex

import h5py
import numpy as np


class MissingData(Exception):
    """Data that a picture needs are not there; the message is for the user."""


class Output:
    """One particle file: attributes at hand, fields read when asked for."""

    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as file:
            self.attributes = dict(file.attrs)
            self.names = set(file)

    def field(self, name):
        if name not in self.names:
            raise MissingData(f"{self.path} has no field '{name}'")
        with h5py.File(self.path, "r") as file:
            return file[name][()]

    @property
    def time(self):
        return float(self.attributes.get("time_s", 0.0))


class Run:
    """The output directory of a run, finished or not."""

    def __init__(self, directory):
        self.directory = directory
        if not os.path.isdir(directory):
            raise MissingData(f"there is no directory '{directory}'")
        self.summary = self._read_summary()
        self._used = self._read_used_options()
        self.scene = self.summary.get("scene") or self._used.get("scene")
        if not self.scene:
            raise MissingData(f"'{directory}' has neither a summary.json nor a used.opts of a run")

    def path(self, name):
        return os.path.join(self.directory, name)

    def value(self, key):
        """Number from the summary; None where it is absent or null."""
        value = self.summary.get(key)
        return value if isinstance(value, (int, float)) else None

    def option(self, name):
        """Numeric value of an option, also of a run that has not written its summary."""
        value = self.summary.get("option_" + name, self._used.get(name))
        try:
            return float(value)
        except (TypeError, ValueError):
            raise MissingData(f"the option -{name} of the run in '{self.directory}' is unknown")

    def words(self, name):
        """The parts of an option that is a list; none where it is not set."""
        text = str(self.summary.get("option_" + name, self._used.get(name, "")))
        return [word.strip() for word in text.split(",") if word.strip()]

    def numbers(self, name):
        try:
            return np.array([float(word) for word in self.words(name)])
        except ValueError:
            raise MissingData(f"the option -{name} of the run in '{self.directory}' is no list of "
                              "numbers")

    def table(self, name):
        """Columns of a CSV file by name; rows that are not complete are left out."""
        try:
            with open(self.path(name), newline="") as file:
                rows = list(csv.reader(file))
        except OSError:
            raise MissingData(f"there is no '{self.path(name)}'")
        names = [column.strip() for column in rows[0]] if rows else []
        complete = [row for row in rows[1:] if len(row) == len(names)]
        if not complete:
            raise MissingData(f"'{self.path(name)}' has no rows yet")
        return dict(zip(names, np.array(complete, dtype=float).T))

    def outputs(self):
        """Particle files in order of time."""
        paths = sorted(glob.glob(os.path.join(glob.escape(self.directory), "particles_*.h5")))
        if not paths:
            raise MissingData(f"'{self.directory}' has no particle files (particles_*.h5)")
        return [Output(path) for path in paths]

    def _read_summary(self):
        try:
            with open(self.path("summary.json")) as file:
                return json.load(file)
        except OSError:
            return {}
        except json.JSONDecodeError as error:
            raise MissingData(f"'{self.path('summary.json')}' is damaged: {error}")

    def _read_used_options(self):
        try:
            with open(self.path("used.opts")) as file:
                words = [shlex.split(line, comments=True) for line in file]
        except OSError:
            return {}
        return {line[0].lstrip("-"): line[1] for line in words if len(line) > 1}
