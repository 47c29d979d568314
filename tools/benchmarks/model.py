"""A model of what a step costs on many ranks, from what was measured on one and two.

t = (A n_p + B n_I) i + sum over 4 halo exchanges (s + m L + b (w + 1/W)) + 1.1 log2(P) L

A per particle, B per node, i the largest part over the mean, m neighbours, b bytes sent, s and w
what PETSc spends on an exchange and on a byte of it, L and W latency and bandwidth of the network.
docs/scaling.md explains it.
"""

import functools
import math
import sys
import typing

from . import tables
from .common import CELLS_2D, CELLS_3D, ROOT, provenance

SHOWN = (4, 16, 64, 256, 1024)  # ranks
TABLES = (tables.Table("scaling_model", ("case", "ranks"), ("efficiency",),
                       lambda row: int(row["ranks"]) in SHOWN),)
PICTURE = ROOT / "docs/pictures/scaling.png"

LAYERS = 3              # of nodes beyond a part that its particles reach
SMALLEST_PART = 3       # nodes in every direction
ALLREDUCES = 1.1        # per step: agreement in every step, the time step in every tenth
# Components of nodal fields in the four exchanges of a step.
COMPONENTS = {2: (5, 4, 2, 2), 3: (7, 6, 3, 3)}
RANKS = tuple(2 ** k for k in range(11))
HALF = 0.5


class Network(typing.NamedTuple):
    latency: float    # s
    bandwidth: float  # bytes/s


CLUSTER = Network(latency=1.5e-6, bandwidth=10e9)  # assumed


class Costs(typing.NamedTuple):
    """All measured, s."""
    particle: dict   # by case
    node: dict       # by dimension
    exchange: float  # PETSc's own, per exchange
    byte: float      # PETSc's own, per byte
    shared: Network  # between two ranks of this machine


class Case(typing.NamedTuple):
    name: str
    dimension: int
    cells: int   # per side; 4 or 8 particles each
    costs: str   # whose particles


CASES = (
    Case("2D, 45,000 particles", 2, CELLS_2D, "elastic 2D"),
    Case("2D sand, 45,000 particles", 2, CELLS_2D, "sand 2D"),
    Case("2D, a million particles", 2, 500, "elastic 2D"),
    Case("2D, 100 million particles", 2, 5000, "elastic 2D"),
    Case("3D, 10 million particles", 3, 108, "elastic 3D"),
)


def fit_line(points):
    """Intercept and slope with least relative errors."""
    weights = [1.0 / (y * y) for _, y in points]
    total = sum(weights)
    mean_x = sum(w * x for w, (x, _) in zip(weights, points)) / total
    mean_y = sum(w * y for w, (_, y) in zip(weights, points)) / total
    slope = (sum(w * (x - mean_x) * (y - mean_y) for w, (x, y) in zip(weights, points))
             / sum(w * (x - mean_x) ** 2 for w, (x, _) in zip(weights, points)))
    return mean_y - slope * mean_x, slope


def shared_memory(rows):
    messages = [(float(row["bytes"]), 1e-6 * float(row["microseconds"])) for row in rows
                if row["measure"] == "message"]
    latency = min(time for _, time in messages)
    return Network(latency, max(size / time for size, time in messages))


def exchange_costs(rows, shared):
    """What PETSc adds to the message itself."""
    halos = [(float(row["bytes"]), 1e-6 * float(row["microseconds"])) for row in rows
             if row["measure"].startswith("halo")]
    start, per_byte = fit_line(halos)
    return max(0.0, start - shared.latency), max(0.0, per_byte - 1.0 / shared.bandwidth)


def particle_and_node(rows, dimension):
    """From two numbers of particles on the same nodes, on one rank."""
    cells = str({2: CELLS_2D, 3: CELLS_3D}[dimension])
    same = [row for row in rows if row["cells_per_side"] == cells and row["ranks"] == "1"
            and row["dimension"] == str(dimension)]
    few, many = sorted(((float(row["particles"]), 1e-3 * float(row["step_ms"])) for row in same))
    particle = (many[1] - few[1]) / (many[0] - few[0])
    nodes = (int(cells) + LAYERS) ** dimension
    node = max(0.0, few[1] - particle * few[0]) / nodes
    return (few[1] - node * nodes) / few[0], node


def sand_particle(rows, elastic):
    """Of the pipe's sand on one rank; the elastic one where it has not been measured."""
    rates = [float(row["updates_per_s_and_core"]) for row in rows
             if (row["case"], row["ranks"]) == ("sand_2d", "1")]
    return 1.0 / rates[0] if rates else elastic


@functools.cache
def costs():
    scaling, exchange = tables.newest("scaling"), tables.newest("exchange")
    if not scaling or not exchange:
        sys.exit("tools/bench: the model needs the part scaling first")
    shared = shared_memory(exchange)
    (flat, flat_node), (solid, solid_node) = (particle_and_node(scaling, d) for d in (2, 3))
    sand = sand_particle(tables.newest("speed"), flat + flat_node / 4)
    return Costs({"elastic 2D": flat, "elastic 3D": solid, "sand 2D": sand - flat_node / 4},
                 {2: flat_node, 3: solid_node}, *exchange_costs(exchange, shared), shared)


def processes(ranks, dimension):
    """Ranks, a power of two, per direction."""
    exponent = ranks.bit_length() - 1
    return [2 ** ((exponent + d) // dimension) for d in range(dimension)]


def halo_nodes(part, grid):
    """Nodes of others that a part in the middle of the grid of parts holds."""
    whole = math.prod(n + LAYERS * min(2, p - 1) for n, p in zip(part, grid))
    return whole - math.prod(part)


def exchange_time(case, part, grid, network, known):
    neighbours = math.prod(min(3, p) for p in grid) - 1
    if neighbours == 0:
        return 0.0
    nodes = halo_nodes(part, grid)
    return sum(known.exchange + neighbours * network.latency
               + 8 * c * nodes * (known.byte + 1.0 / network.bandwidth)
               for c in COMPONENTS[case.dimension])


def step(case, ranks, network, known):
    """Seconds of a step by what takes them; None where parts are too narrow."""
    grid = processes(ranks, case.dimension)
    nodes_per_side = case.cells + LAYERS
    if nodes_per_side // max(grid) < SMALLEST_PART:
        return None
    part = [math.ceil(case.cells / p) for p in grid]
    per_cell = 2 ** case.dimension
    mean_cells = case.cells ** case.dimension / ranks
    compute = known.particle[case.costs] * per_cell * mean_cells
    nodes = known.node[case.dimension] * nodes_per_side ** case.dimension / ranks
    largest = math.prod(part) / mean_cells
    return {"particles": compute, "nodes": nodes, "imbalance": (compute + nodes) * (largest - 1.0),
            "halo": exchange_time(case, part, grid, network, known),
            "allreduce": ALLREDUCES * math.log2(ranks) * network.latency}


def efficiency(case, ranks, network, known):
    alone, parts = (step(case, n, network, known) for n in (1, ranks))
    return sum(alone.values()) / (ranks * sum(parts.values())) if parts else None


def row_of(case, ranks, known):
    parts = step(case, ranks, CLUSTER, known)
    if parts is None:
        return None
    row = {"case": case.name, "ranks": str(ranks),
           "particles_per_rank": f"{(2 * case.cells) ** case.dimension / ranks:.0f}"}
    row |= {f"{name}_us": f"{1e6 * seconds:.4g}" for name, seconds in parts.items()}
    return row | {"step_us": f"{1e6 * sum(parts.values()):.4g}",
                  "efficiency": f"{efficiency(case, ranks, CLUSTER, known):.3f}"}


def limit(case, known):
    """The first number of ranks with less than half efficiency, and what takes most of the loss;
    or None, and why there is no such number."""
    for ranks in RANKS:
        parts = step(case, ranks, CLUSTER, known)
        if parts is None:
            return None, "grid too small for more"
        if efficiency(case, ranks, CLUSTER, known) < HALF:
            return ranks, max(("imbalance", "halo", "allreduce"), key=parts.get)
    return None, "above it up to 1,024"


def measure(_effort):
    known = costs()
    settings = (f"assumed {1e6 * CLUSTER.latency:g} us and {CLUSTER.bandwidth / 1e9:g} GB/s; "
                "costs of a step from scaling.csv and exchange.csv")
    rows = [row for case in CASES for ranks in RANKS if (row := row_of(case, ranks, known))]
    return {"scaling_model": [row | provenance(settings) for row in rows]}


def draw(rows):
    from plotting import scaling

    scaling.draw(rows, PICTURE)
