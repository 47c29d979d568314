"""What the studies share: reading a run's answers, and columns of their tables."""

import json


def read_json(path):
    return json.loads(path.read_text(encoding="utf-8"))


def cost(summary, seconds="wall_s"):
    return {key: summary[key] for key in ("particles", "steps", "ranks")} | {
        seconds: f"{summary[seconds]:.1f}"}


def provenance(options, summary):
    return {"settings": " ".join(f"-{name} {value}" for name, value in options.items()),
            "commit": summary["git_hash"]}
