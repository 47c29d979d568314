"""Tables of docs/performance.md and docs/scaling.md, written between marks from docs/data."""

import re

from . import model, tables
from .common import ROOT

PAGES = ("docs/performance.md", "docs/scaling.md")
MARK = re.compile(r"(<!-- table (?P<name>\w+) -->\n).*?(<!-- end -->)", re.DOTALL)
CASES = {"elastic_2d": "linear elastic, 2D", "sand_2d": "sand under the pipe, 2D",
         "elastic_3d": "linear elastic, 3D"}
LAWS = {"elastic": "linear elastic", "mohr_coulomb": "Mohr–Coulomb", "neo_hookean": "neo-Hookean",
        "von_mises": "von Mises"}


def markdown(heads, rows):
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def number(text, factor=1.0, digits=3):
    """With so many digits, and commas in thousands; empty stays empty."""
    if not text:
        return ""
    value = factor * float(text)
    rounded = float(f"{value:.{digits}g}")
    return f"{rounded:,.0f}" if abs(rounded) >= 10 ** (digits - 1) else f"{rounded:g}"


def count(text):
    return f"{float(text):,.0f}"


def law_name(case):
    """sand/2kPa/plastic_1e-5 becomes sand, 2 kPa, plastic 1e-5."""
    law, *state = case.split("/")
    words = [LAWS.get(law, law), *state]
    return ", ".join(word.replace("_", " ").replace("kPa", " kPa") for word in words)


def speed():
    return markdown(
        ("case", "particles", "ranks", "million updates per second and core", "over plain code",
         "two ranks over one", "bytes per particle"),
        [(CASES[row["case"]], count(row["particles"]), row["ranks"],
          number(row["updates_per_s_and_core"], 1e-6), number(row["over_plain"]),
          number(row["two_rank_speed_up"]), row["bytes_per_particle"])
         for row in tables.committed("speed")])


def phases():
    shares, names = {}, {}
    for row in tables.committed("step_phases"):
        shares[row["case"], row["phase"]] = f"{100 * float(row['share']):.1f} %"
        names[row["phase"]] = None
    cases = [case for case in CASES if any(case == key[0] for key in shares)]
    return markdown(("phase", *(CASES[case] for case in cases)),
                    [(name, *(shares.get((case, name), "") for case in cases)) for name in names])


def exchange():
    """What a step of the smallest strong case exchanges on two ranks, without waiting."""
    times = {(row["measure"], int(row["bytes"])): float(row["microseconds"])
             for row in tables.committed("exchange")}
    sizes = sorted(size for kind, size in times if kind == "halo_sum_2d")[:3]
    kinds = (("halo_sum_2d", 2), ("halo_copy_2d", 1), ("halo_sum_2d", 0), ("halo_copy_2d", 0))
    agreement = next(time for (kind, _), time in times.items() if kind == "allreduce")
    total = sum(times[kind, sizes[k]] for kind, k in kinds) + model.ALLREDUCES * agreement
    step = next(row for row in tables.committed("scaling")
                if (row["measure"], row["dimension"], row["ranks"]) == ("strong", "2", "2"))
    milliseconds = float(step["step_ms"])
    return (f"Measured alone, so without waiting, the four halos and the agreement of a step of "
            f"{count(step['particles'])} elastic particles on two ranks take {total:.0f} µs of "
            f"{milliseconds:.3g} ms: {0.1 * total / milliseconds:.2g} %.\n")


def particles():
    return markdown(
        ("particles", "ms per step", "ns per particle", "memory, bytes per particle"),
        [(count(row["particles"]), number(row["step_ms"]),
          number(row["ns_per_particle"]), row["memory_bytes_per_particle"])
         for row in tables.committed("step_cost") if row["particles"] != "slope"])


def slope():
    row = next(r for r in tables.committed("step_cost") if r["particles"] == "slope")
    return (f"The time of a step grows with the particles to the power {row['exponent']}; each of "
            f"the last takes {row['memory_bytes_per_particle']} bytes.\n")


def laws():
    return markdown(
        ("law", "ns per particle", "over linear elastic"),
        [(law_name(row["case"]), row["law_ns_per_particle"], row["ratio_to_elastic"])
         for row in tables.committed("law_cost") if row["measure"] == "update"])


def law_shares():
    return markdown(
        ("law", "particles yielding", "law, ns", "step, ns per particle", "share"),
        [(law_name(row["case"]), f"{100 * float(row['plastic_share']):.0f} %",
          row["law_ns_per_particle"], row["step_ns_per_particle"],
          f"{100 * float(row['share_of_step']):.0f} %")
         for row in tables.committed("law_cost") if row["measure"] == "step"])


def scaling():
    return markdown(
        ("", "dimension", "particles", "ranks", "ms per step", "ns per particle and core",
         "efficiency"),
        [(row["measure"], row["dimension"], count(row["particles"]), row["ranks"],
          number(row["step_ms"]), number(row["ns_per_particle_and_core"]),
          number(row["efficiency"])) for row in tables.committed("scaling")
         if row["measure"] != "density"])


def parameters():
    known = model.costs()
    cluster = model.CLUSTER

    def us(seconds):
        return f"{1e6 * seconds:.2g} µs"

    rows = [(f"a particle, {name}", f"{1e9 * cost:.0f} ns", "measured")
            for name, cost in known.particle.items()]
    rows += [(f"a node, {dimension}D", f"{1e9 * cost:.0f} ns", "measured")
             for dimension, cost in known.node.items()]
    rows += [
        ("PETSc's part of an exchange", us(known.exchange), "measured"),
        ("and per kilobyte", us(1e3 * known.byte), "measured"),
        ("latency, shared memory", us(known.shared.latency), "measured"),
        ("bandwidth, shared memory", f"{known.shared.bandwidth / 1e9:.3g} GB/s", "measured"),
        ("latency, cluster", us(cluster.latency), "assumed"),
        ("bandwidth, cluster", f"{cluster.bandwidth / 1e9:g} GB/s", "assumed")]
    return markdown(("what", "cost", ""), rows)


def efficiencies():
    rows = tables.committed("scaling_model")
    found = {(row["case"], row["ranks"]): f"{100 * float(row['efficiency']):.0f} %" for row in rows}
    return markdown(
        ("case", *(f"{n:,} ranks" for n in model.SHOWN), "below 50 % from", "because of"),
        [(case.name, *(found.get((case.name, str(n)), "-") for n in model.SHOWN), *reason(case))
         for case in model.CASES])


def reason(case):
    words = {"halo": "halos", "allreduce": "agreement of all ranks", "imbalance": "whole cells"}
    ranks, why = model.limit(case, model.costs())
    return (f"{ranks:,}" if ranks else "-", words.get(why, why))


def check():
    """The model with the costs of shared memory against two measured ranks."""
    known = model.costs()
    rows = []
    for row in tables.committed("scaling"):
        if (row["measure"], row["ranks"]) != ("strong", "2"):
            continue
        dimension = int(row["dimension"])
        case = model.Case("", dimension, int(row["cells_per_side"]), f"elastic {dimension}D")
        computed = model.efficiency(case, 2, known.shared, known)
        rows.append((f"{dimension}D", count(row["particles"]), f"{computed:.3f}",
                     row["efficiency"]))
    return markdown(("", "particles", "model", "measured"), rows)


MAKERS = {make.__name__: make for make in (speed, phases, exchange, particles, slope, laws,
                                           law_shares, scaling, parameters, efficiencies, check)}


def fill(text):
    return MARK.sub(lambda mark: mark[1] + MAKERS[mark["name"]]() + mark[3], text)


def write():
    """Renews the tables of the pages and the chart from docs/data."""
    model.costs.cache_clear()
    for page in PAGES:
        path = ROOT / page
        path.write_text(fill(path.read_text(encoding="utf-8")), encoding="utf-8")
        print(f"renewed {page}")
    model.draw(tables.committed("scaling_model"))
    print(f"wrote {model.PICTURE.relative_to(ROOT)}")
