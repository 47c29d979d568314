"""Columns that the tables of several studies share."""


def cost(summary, seconds="wall_s"):
    return {key: summary[key] for key in ("particles", "steps", "ranks")} | {
        seconds: f"{summary[seconds]:.1f}"}


def provenance(options, summary):
    return {"settings": " ".join(f"-{name} {value}" for name, value in options.items()),
            "commit": summary["git_hash"]}
