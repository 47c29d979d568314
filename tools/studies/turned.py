"""Does the pipe's answer feel the directions of the grid? The same pipe in ground that stands
upright and turned against the grid, with all of its ground modelled."""

import math

from . import pipe, rows

ANGLE = 20.0  # degrees, of gravity and the pipe's motion against the grid
DISPLACEMENTS = [round(0.05 * k, 2) for k in range(1, 18)] + [0.89]
COVER, END, WIDTH, BELOW = 3.0, 0.9, 14.0, 14.0  # D
GRAVITY = 9.81
SIZES = {"37.5": {"diameter": 0.0375, "velocity": 0.15}, "500": {"diameter": 0.5, "velocity": 0.6}}
PACKINGS = {"dense": 0.524, "medium": 0.657}
FRICTION = 0.3355825585249491  # tan(0.6 phi_c), the pipe's default
GRAINS = 2650.0  # kg/m^3


def numbers(values):
    return ",".join(f"{value:.17g}" for value in values)


def ground(diameter, angle):
    """The pipe's axis is the origin; walls are fixed, since they are neither level nor upright."""
    slope = math.tan(math.radians(abs(angle)))
    top = COVER / math.cos(math.radians(angle)) + WIDTH * slope + 1.5
    domain = (-WIDTH, -BELOW - 0.5, WIDTH, math.ceil(top))
    fine_half = 3.0 + END * slope
    fine = (-fine_half, -END - 2.5, fine_half, COVER / math.cos(math.radians(angle)) + 3.0 * slope)
    return {"domain": numbers(diameter * x for x in domain),
            "fine_box": numbers(diameter * x for x in fine), "far_cell_ratio": 4,
            "walls": "fixed,fixed,fixed,free"}


def case(size, packing, cells, angle):
    diameter, velocity = SIZES[size]["diameter"], SIZES[size]["velocity"]
    up = (-math.sin(math.radians(angle)), math.cos(math.radians(angle)))
    surface = [COVER * diameter * component for component in up]
    return {
        "scene": "custom", "dimension": 2, **ground(diameter, angle),
        "cell_size": f"{diameter / cells:.17g}", "gravity": GRAVITY, "gravity_angle": angle,
        "average_volume": "true", "flip_time": f"{0.016 * math.sqrt(diameter / GRAVITY):.6g}",
        "regions": "sand", "region_sand_plane": numbers([*surface, *up]),
        "region_sand_material": "sand", "region_sand_sand_void_ratio": PACKINGS[packing],
        "region_sand_sand_cohesion": 1000, "region_sand_K0": 0.5,
        "bodies": "pipe", "body_pipe_ball": numbers([0.0, 0.0, 0.5 * diameter]),
        "body_pipe_velocity": numbers(-velocity * component for component in up),
        "body_pipe_ramp": f"{0.02 * diameter:.17g}", "body_pipe_friction": FRICTION,
        "body_pipe_contour": numbers([0.15 * diameter, 0.85 * diameter]),
        "stages": "geostatic,loading", "stage_geostatic_until": "rest",
        "stage_geostatic_damping": 0.7, "stage_geostatic_bodies": "held",
        "stage_loading_until": f"pipe:{END * diameter:.17g}"}


def jobs():
    for size, packing, cells in (("37.5", "dense", 8), ("37.5", "medium", 8), ("500", "dense", 8),
                                 ("500", "medium", 8), ("37.5", "dense", 12)):
        for angle in (0, ANGLE):
            yield f"{size}mm_{packing}_cells{cells}_turned{angle:g}", case(
                size, packing, cells, angle)


def along(job_dir, name, direction):
    """Component of a vector of the history along the direction."""
    x, y = (map(float, pipe.column(job_dir, name.format(axis))) for axis in "xy")
    return [a * direction[0] + b * direction[1] for a, b in zip(x, y)]


def curves(job_dir, diameter, packing, angle):
    """u/D; N_d by impulse, by contour and across the motion."""
    up = (-math.sin(math.radians(angle)), math.cos(math.radians(angle)))
    across = (up[1], -up[0])
    unit_weight = GRAINS / (1.0 + PACKINGS[packing]) * GRAVITY
    reference = unit_weight * COVER * diameter**2
    u = [-way / diameter for way in along(job_dir, "pipe_{}_m", up)]
    forces = [[force / reference for force in along(job_dir, name, direction)]
              for name, direction in (("pipe_force_{}_N_per_m", up),
                                      ("pipe_contour_force_{}_N_per_m", up),
                                      ("pipe_force_{}_N_per_m", across))]
    return u, *forces


def table_row(job, job_dir, options):
    size, packing, cells, turned = job.split("_")
    summary = rows.read_json(job_dir / "summary.json")
    u, N_d, contour, across = curves(job_dir, SIZES[size.removesuffix("mm")]["diameter"], packing,
                                     options["gravity_angle"])
    peak = max((value, at) for at, value in zip(u, N_d) if at < 0.3)
    row = {"diameter_mm": size.removesuffix("mm"), "packing": packing,
           "cells": cells.removeprefix("cells"), "turned": turned.removeprefix("turned")}
    row |= {f"N_d_at_{at}": f"{rows.mean_near(u, N_d, at):.4g}" for at in DISPLACEMENTS}
    row |= {"peak": f"{peak[0]:.4g}", "u_over_D_at_peak": f"{peak[1]:.3f}",
            "across_over_along_to_0.3": f"{ratio(u, across, N_d):.3g}",
            "contour_over_impulse_to_0.3": f"{ratio(u, contour, N_d):.4g}"}
    return row | rows.cost(summary) | rows.provenance(options, summary)


def ratio(u, one, other):
    """Of their means."""
    begun = [k for k, at in enumerate(u) if 0.02 < at < 0.3]
    return sum(one[k] for k in begun) / sum(other[k] for k in begun)


STUDIES = {"pipe_turned": jobs}
RANKS = 2
