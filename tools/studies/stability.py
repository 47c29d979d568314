"""The largest stable Courant number of every basis, scheme and transfer: the stability map."""

import json

from . import rows

BASES = ("linear", "gimp", "ddmp", "quadratic", "cubic")
UPDATES = ("musl", "usl", "usf")
TRANSFERS = ("flip", "pic", "apic")
LIMITS = ("limit_interior", "limit_fixed_wall", "limit_filled_to_free_end", "limit_free_surface",
          "two_over_omega_free_surface")
IN_PLANE = {"dimension": 2, "cells": 3, "stride": 0.3}


def bodies(update, transfer):
    """Bodies of one and two dimensions with 1 to 4 particles per direction; less in the plane for
    transfers that damp, and for usf, which has the limits of musl."""
    for particles in (1, 2, 3, 4):
        yield f"1d_{particles}", {"particles_per_cell_direction": particles}
    many = transfer == "flip" and update != "usf"
    for particles in (1, 2, 3, 4) if many else (2,):
        yield f"2d_{particles}", IN_PLANE | {"particles_per_cell_direction": particles}


def methods():
    for transfer in TRANSFERS:
        for basis in BASES:
            for update in UPDATES:
                yield {"basis": basis, "update": update, "transfer": transfer}
    for transfer in TRANSFERS:
        for basis in ("quadratic", "cubic"):
            for update in UPDATES:
                yield {"basis": basis, "update": update, "transfer": transfer,
                       "basis_boundary": "open_knot"}


def jobs():
    for method in methods():
        for body, options in bodies(method["update"], method["transfer"]):
            name = "_".join(list(method.values()) + [body])
            yield name, {"scene": "stability"} | method | options


def table_row(job, job_dir, options):
    summary = json.loads((job_dir / "summary.json").read_text(encoding="utf-8"))
    row = {key: summary[f"option_{key}"]
           for key in ("basis", "basis_boundary", "update", "transfer")}
    row["dimension"] = int(summary["option_dimension"])
    row["particles_per_direction"] = int(summary["option_particles_per_cell_direction"])
    row |= {key: f"{summary[key]:.3f}" for key in LIMITS}
    row["worst_place"] = " ".join(f"{share:g}" for share in summary["worst_place"])
    return row | rows.provenance(options, summary)


STUDIES = {"stability": jobs}
RANKS = 1
