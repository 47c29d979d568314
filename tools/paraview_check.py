"""Reads a pipe run back as ParaView's users do and checks what they would see; run by
tools/test --paraview through tools/pvpython. Prints a line for each check that fails and
'N passed, N failed'."""

import json
import os
import sys

import numpy as np
from paraview import simple
from vtkmodules.util.numpy_support import vtk_to_numpy

READERS = {
    "XDMFReader": lambda path: simple.XDMFReader(FileNames=[path]),
    "Xdmf3ReaderT": lambda path: simple.Xdmf3ReaderT(FileName=[path]),
}
COMPONENTS = {
    "particles": {"velocity": 3, "displacement": 3, "stress": 6, "p": 1, "q": 1, "void_ratio": 1,
                  "deviatoric_strain": 1, "eps_q": 1, "id": 1, "material": 1, "rank": 1},
    "grid": {"mass": 1, "velocity_x": 1, "velocity_y": 1},
}
PICTURES = ["deviatoric_strain", "void_ratio", "displacement"]
# A picture of nothing but background compresses to less.
SMALLEST_PICTURE = 20000


class Checks:
    def __init__(self):
        self.passed = self.failed = 0

    def that(self, holds, claim):
        if holds:
            self.passed += 1
        else:
            self.failed += 1
            print(f"FAILED: {claim}")


def output_of(reader):
    """The data set itself, out of the blocks some readers wrap it in. Not by servermanager.Fetch,
    which garbles the last values of a flat rectilinear grid on their way."""
    data = reader.GetClientSideObject().GetOutputDataObject(0)
    while data is not None and data.IsA("vtkMultiBlockDataSet"):
        data = data.GetBlock(0)
    return data


def check_arrays(checks, where, data, expected):
    for name, components in expected.items():
        array = data.GetPointData().GetArray(name)
        checks.that(array is not None, f"{where}: has {name}")
        if array is None:
            continue
        checks.that(array.GetNumberOfComponents() == components, f"{where}: {name} has {components} components")
        checks.that(np.isfinite(vtk_to_numpy(array)).all(), f"{where}: {name} is finite")


def check_stress(checks, where, data):
    """The first three components are the normal ones: a reader that takes the six for a tensor of
    its own order shows others."""
    stress, pressure = (data.GetPointData().GetArray(name) for name in ("stress", "p"))
    if stress is None or pressure is None:
        return
    trace, p = vtk_to_numpy(stress)[:, :3].sum(axis=1), vtk_to_numpy(pressure)
    checks.that(np.abs(trace + 3 * p).max() <= 1e-4 * max(np.abs(p).max(), 1e-30),
                f"{where}: the stress has the pressure p")


def check_particles(checks, where, data, count):
    checks.that(data.GetNumberOfPoints() == count,
                f"{where}: {data.GetNumberOfPoints()} points, {count} particles")
    checks.that(data.GetNumberOfCells() > 0, f"{where}: has cells, or nothing is drawn")
    ids = data.GetPointData().GetArray("id")
    checks.that(ids is not None and len(np.unique(vtk_to_numpy(ids))) == count,
                f"{where}: every particle once")


def check_grid(checks, where, data):
    mass = data.GetPointData().GetArray("mass")
    checks.that(mass is not None and vtk_to_numpy(mass).sum() > 0, f"{where}: has mass")


def steps_of(reader):
    """Time values; ParaView gives a bare number where there is one only."""
    values = reader.TimestepValues
    return list(values) if hasattr(values, "__len__") else [values]


def check_file(checks, directory, kind, reader_name, count):
    reader = READERS[reader_name](os.path.join(directory, kind + ".xdmf"))
    steps = steps_of(reader)
    checks.that(len(steps) > 1, f"{kind} by {reader_name}: more than one time step")
    checks.that(steps == sorted(set(steps)), f"{kind} by {reader_name}: times rise")
    for time in steps:
        where = f"{kind} by {reader_name} at {time:.6g} s"
        reader.UpdatePipeline(time)
        data = output_of(reader)
        checks.that(data is not None, f"{where}: readable")
        if data is None:
            continue
        check_arrays(checks, where, data, COMPONENTS[kind])
        if kind == "particles":
            check_stress(checks, where, data)
            check_particles(checks, where, data, count)
        else:
            check_grid(checks, where, data)
    simple.Delete(reader)
    return steps


def check_pictures(checks, directory):
    for name in PICTURES:
        path = os.path.join(directory, f"paraview_{name}.png")
        checks.that(os.path.exists(path) and os.path.getsize(path) > SMALLEST_PICTURE,
                    f"tools/paraview drew {name}")


def main(directory):
    checks = Checks()
    with open(os.path.join(directory, "summary.json")) as file:
        count = json.load(file)["particles"]
    steps = [check_file(checks, directory, kind, reader, count)
             for kind in COMPONENTS for reader in READERS]
    checks.that(all(s == steps[0] for s in steps), "both files have the same times in both readers")
    check_pictures(checks, directory)
    print(f"{checks.passed} passed, {checks.failed} failed")
    return 1 if checks.failed else 0


sys.exit(main(os.path.abspath(sys.argv[1])))
