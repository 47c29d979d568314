"""What inertia does to the pipe's resistance: constant velocities, and pushing as fast as a tolerance
allows, against the slowest run of each size."""

import numpy as np

from plotting import pipe_speed as picture

from . import pipe, rows

DISPLACEMENTS = (0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.12, 0.14, 0.16, 0.18, 0.2, 0.25, 0.29)
END = 0.305
SIZES = {  # D in mm: settings and velocities in m/s, the first of which is the reference
    "37.5": ({"pipe_cells_per_diameter": 6}, (0.02, 0.05, 0.1, 0.15, 0.3)),
    "500": ({"pipe_diameter": 0.5, "pipe_cells_per_diameter": 6}, (0.08, 0.2, 0.4, 0.6, 1.2)),
}
TOLERANCES = (0.02, 0.05, 0.1, 0.2)
EARLY, WHOLE = (0.005, 0.05), (0.005, 0.29)  # u/D


def jobs():
    for size, (settings, velocities) in SIZES.items():
        base = pipe.AS_IN_INPUT | settings | {"sand_void_ratio": 0.524,
                                              "pipe_end_displacement": END}
        for velocity in velocities:
            yield f"{size}mm_{velocity}", base | {"pipe_velocity": velocity}
        for tolerance in TOLERANCES:
            yield f"{size}mm_auto{tolerance}", base | {"inertia_tolerance": tolerance}


def smooth(values):
    """Means over five rows, 0.0125 in u/D."""
    return np.convolve(np.pad(values, 2, "edge"), np.ones(5) / 5, "valid")


def curve(job_dir):
    return tuple(np.array(pipe.column(job_dir, name), float)
                 for name in ("u_over_D", "N_d", "step", "velocity_m_per_s", "inertia"))


def differences(job_dir, reference, begin, end):
    """Of N_d from the reference, relative, between two displacements."""
    places = np.arange(begin, end, 0.0025)
    one, other = (smooth(np.interp(places, *curve(place)[:2])) for place in (job_dir, reference))
    return one / other - 1.0


def table_row(job, job_dir, options):
    size, pushed = job.split("mm_")
    reference = job_dir.parent / f"{size}mm_{SIZES[size][1][0]}"
    summary = rows.read_json(job_dir / "summary.json")
    u, _, step, speed, inertia = curve(job_dir)
    row = {"diameter_mm": size, "pushed": pushed}
    row |= {f"N_d_at_{at}": f"{pipe.resistance_at(job_dir, at):.4g}" for at in DISPLACEMENTS}
    for name, (begin, end) in (("to_0.05", EARLY), ("to_0.29", WHOLE)):
        off = differences(job_dir, reference, begin, end)
        row |= {f"difference_rms_{name}": f"{np.sqrt(np.mean(off**2)):.4f}",
                f"difference_most_{name}": f"{np.abs(off).max():.4f}",
                f"steps_{name}": f"{np.interp(end, u, step):.0f}"}
    for at in (0.02, 0.05, 0.15, 0.29):
        row |= {f"velocity_at_{at}": f"{np.interp(at, u, speed):.3g}",
                f"inertia_at_{at}": f"{np.interp(at, u, inertia):.3g}"}
    return row | rows.cost(summary) | rows.provenance(options, summary)


def draw(table, pictures):
    picture.draw(table, pictures / "pipe_speed.png")


STUDIES = {"pipe_speed": jobs}
RANKS = 2
