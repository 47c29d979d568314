"""What the studies share: reading a run's answers, and columns of their tables."""

import json


def mean_near(places, values, place):
    """Mean of the values over the 0.01 around a place."""
    near = [value for at, value in zip(places, values) if abs(at - place) <= 0.005 + 1e-9]
    return sum(near) / len(near)


def read_json(path):
    return json.loads(path.read_text(encoding="utf-8"))


def cost(summary, seconds="wall_s"):
    return {key: summary[key] for key in ("particles", "steps", "ranks")} | {
        seconds: f"{summary[seconds]:.1f}"}


def provenance(options, summary):
    return {"settings": " ".join(f"-{name} {value}" for name, value in options.items()),
            "commit": summary["git_hash"]}
