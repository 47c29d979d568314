"""Renders the last output of a run with ParaView; run by tools/paraview through tools/pvpython."""

import os
import sys
from dataclasses import dataclass
from typing import Callable

import numpy as np
from paraview import simple

from plotting.run import MissingData, Run
from plotting.scales import about_far_field, from_zero

SIZE = [1400, 900]


@dataclass
class Field:
    name: str
    title: str
    colours: str
    limits: Callable
    inverted: bool = False


FIELDS = [
    Field("deviatoric_strain", "Deviatoric strain", "Magma (matplotlib)", from_zero, inverted=True),
    Field("void_ratio", "Void ratio", "Cool to Warm", about_far_field),
    Field("displacement", "Displacement (m)", "Viridis (matplotlib)", from_zero),
]


class Scene:
    """What is drawn: the particles, both halves of a half model, and the pipe if there is one."""

    def __init__(self, run):
        self.run = run
        self.output = run.outputs()[-1]
        self.reader = simple.Xdmf3ReaderT(FileName=[os.path.abspath(run.path("particles.xdmf"))])
        self.reader.UpdatePipeline(self.output.time)
        self.count = self.reader.GetDataInformation().GetNumberOfPoints()
        if self.count == 0:
            raise MissingData(f"no particles in {run.path('particles.xdmf')}")
        self.particles = self._with_mirror()
        self.particles.UpdatePipeline(self.output.time)
        self.bounds = self.particles.GetDataInformation().GetBounds()

    @property
    def pipe(self):
        """(x, y, diameter) of the pipe, or None."""
        attributes = self.output.attributes
        if "pipe_x_m" not in attributes:
            return None
        return (float(attributes["pipe_x_m"]), float(attributes["pipe_y_m"]),
                self.run.option("pipe_diameter"))

    @property
    def particle_distance(self):
        """Mean over the area they fill."""
        low_x, high_x, low_y, high_y = self.reader.GetDataInformation().GetBounds()[:4]
        return float(np.sqrt(max((high_x - low_x) * (high_y - low_y), 1e-30) / self.count))

    def _with_mirror(self):
        if self.run.summary.get("symmetry") != "half" or self.pipe is None:
            return self.reader
        mirror = simple.Reflect(Input=self.reader)
        mirror.Plane, mirror.Center, mirror.CopyInput = "X", self.pipe[0], 1
        return mirror


def look_at(view, scene):
    """The whole, or the soil around the pipe down to where slip surfaces reach."""
    low_x, high_x, low_y, high_y = scene.bounds[:4]
    middle = [0.5 * (low_x + high_x), 0.5 * (low_y + high_y)]
    half_height = 0.55 * max(high_y - low_y, (high_x - low_x) * SIZE[1] / SIZE[0])
    if scene.pipe is not None:
        x, y, diameter = scene.pipe
        half_height = min(half_height, 0.5 * (high_y - y + 3.5 * diameter))
        middle = [x, high_y + 0.3 * diameter - half_height]
    view.CameraParallelProjection = 1
    view.CameraPosition = middle + [10.0 * half_height]
    view.CameraFocalPoint = middle + [0.0]
    view.CameraViewUp = [0, 1, 0]
    view.CameraParallelScale = half_height


def new_view(scene):
    view = simple.CreateView("RenderView")
    view.ViewSize = SIZE
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0
    view.ViewTime = scene.output.time
    look_at(view, scene)
    return view


def draw_pipe(view, scene):
    x, y, diameter = scene.pipe
    disk = simple.Disk(InnerRadius=0.0, OuterRadius=0.5 * diameter, CircumferentialResolution=180)
    moved = simple.Transform(Input=disk)
    moved.Transform.Translate = [x, y, 0.01 * diameter]
    display = simple.Show(moved, view)
    display.AmbientColor = display.DiffuseColor = [0.75, 0.75, 0.75]


def draw_scale(view, table, title):
    bar = simple.GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = title, ""
    bar.TitleColor = bar.LabelColor = [0, 0, 0]
    bar.TitleFontSize = bar.LabelFontSize = 20
    bar.DrawBackground = 1
    bar.BackgroundColor = [1, 1, 1, 1]
    bar.BackgroundPadding = 8
    bar.WindowLocation = "Any Location"
    bar.Orientation = "Horizontal"
    bar.Position = [0.33, 0.03]
    bar.ScalarBarLength = 0.34
    bar.AddRangeLabels = 0
    return bar


def colour(display, scene, field):
    values = scene.output.field(field.name)
    vector = values.ndim > 1
    simple.ColorBy(display, ("POINTS", field.name, "Magnitude") if vector
                   else ("POINTS", field.name))
    table = simple.GetColorTransferFunction(field.name)
    table.ApplyPreset(field.colours, True)
    if field.inverted:
        table.InvertTransferFunction()
    table.RescaleTransferFunction(*field.limits(np.linalg.norm(values, axis=1) if vector
                                                else values))
    return table


def render(view, scene, field):
    display = simple.Show(scene.particles, view)
    display.SetRepresentationType("Point Gaussian")
    display.GaussianRadius = 0.75 * scene.particle_distance
    display.ShaderPreset = "Plain circle"
    bar = draw_scale(view, colour(display, scene, field), field.title)
    bar.Visibility = 1
    target = scene.run.path(f"paraview_{field.name}.png")
    simple.SaveScreenshot(target, view, ImageResolution=SIZE)
    bar.Visibility = 0
    return target


def main(directory):
    scene = Scene(Run(directory))
    view = new_view(scene)
    if scene.pipe is not None:
        draw_pipe(view, scene)
    for field in FIELDS:
        if field.name in scene.output.names:
            print(render(view, scene, field))
        else:
            print(f"tools/paraview: the run has no {field.name}, not drawn", file=sys.stderr)
    # Left to the interpreter's end, the view outlives its display: GLXBadContext, exit code 1.
    simple.Delete(view)


try:
    main(sys.argv[1])
except MissingData as missing:
    sys.exit(f"tools/paraview: {missing}")
