"""The largest stable Courant number of every basis, scheme and transfer: the stability map; and
10,000 non-linear steps just below and above it."""

import csv
import pathlib

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
    summary = rows.read_json(job_dir / "summary.json")
    if options["scene"] == "cut_cell":
        return confirming_row(job, summary, options)
    row = {key: summary[f"option_{key}"]
           for key in ("basis", "basis_boundary", "update", "transfer")}
    row["dimension"] = int(summary["option_dimension"])
    row["particles_per_direction"] = int(summary["option_particles_per_cell_direction"])
    row |= {key: f"{summary[key]:.3f}" for key in LIMITS}
    row["worst_place"] = " ".join(f"{share:g}" for share in summary["worst_place"])
    return row | rows.provenance(options, summary)


MAP = pathlib.Path(__file__).resolve().parents[2] / "docs/data/stability.csv"
SHARES = (0.97, 1.03, 1.1)
LARGEST_COURANT = 2.0  # that can be asked for


def limits_of_bars():
    """Basis, update and limit of free bars with two particles per cell, FLIP."""
    with open(MAP, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if (row["dimension"], row["particles_per_direction"], row["transfer"],
                    row["basis_boundary"]) == ("1", "2", "flip", "mirror"):
                yield row["basis"], row["update"], float(row["limit_free_surface"])


def confirming_jobs():
    """Bars at 20 places of their ends, stepped at shares of their limit."""
    for basis, update, limit in limits_of_bars():
        for share in SHARES:
            if share * limit <= LARGEST_COURANT:
                yield f"steps-{basis}-{update}-{share}", {
                    "scene": "cut_cell", "basis": basis, "update": update, "amplitude": 1e-6,
                    "courant": round(share * limit, 4), "progress": "off"}


def confirming_row(job, summary, options):
    _, basis, update, share = job.split("-")
    return {"basis": basis, "update": update, "share_of_limit": share,
            "courant": options["courant"], "stable_places": int(summary["stable_offsets"]),
            "places": int(summary["option_offsets"])} | rows.provenance(options, summary)


STUDIES = {"stability": jobs, "stability_confirmed": confirming_jobs}
RANKS = 1
