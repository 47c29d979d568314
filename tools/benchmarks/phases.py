"""Shares of the phases of a step on two ranks, from PETSc's log of events."""

import re
import statistics

from . import speed
from .common import BUILD, provenance
from .tables import Table

TABLES = (Table("step_phases", ("case", "phase"), ("share",)),)

PREFIX = "mpm: "
CASES = ("elastic_2d", "sand_2d")
RANKS = 2
EXCHANGE = {"halo sum", "halo copy", "agree", "migrate"}
BETWEEN_STEPS = {"output"}
STAR_FOREST = ("SFBcastBegin", "SFBcastEnd", "SFReduceBegin", "SFReduceEnd")
# Stage, event, rank, count, seconds: names of events may have commas.
LINE = re.compile(r"^(?P<stage>[^,]*),(?P<event>.*?),(?P<rank>\d+),(?P<count>\d+),"
                  r"(?P<seconds>[0-9.eE+-]+),")
LOG = "events.csv"
MAIN = "Main Stage"


def read_events(path):
    """Seconds of every event that happened, mean over ranks, over all stages of the run; the main
    stage, which holds what comes before and after, counts only where there is no other."""
    matches = [match for line in path.read_text(encoding="utf-8").splitlines()
               if (match := LINE.match(line))]
    ranks = {match["rank"] for match in matches}
    has_stages = any(match["stage"] != MAIN for match in matches)
    total = {}
    for match in matches:
        if match["event"] == "summary" or int(match["count"]) == 0:
            continue
        if not (has_stages and match["stage"] == MAIN):
            total[match["event"]] = total.get(match["event"], 0.0) + float(match["seconds"])
    return {event: seconds / len(ranks) for event, seconds in total.items()}


def shares_of(events, seconds):
    """By phase, where the program names phases; and what PETSc's exchanges of nodes take."""
    shares = {event.removeprefix(PREFIX): time / seconds for event, time in events.items()
              if event.startswith(PREFIX) and event.removeprefix(PREFIX) not in BETWEEN_STEPS}
    if shares:
        shares["all exchange"] = sum(shares.get(phase, 0.0) for phase in EXCHANGE)
    shares["star forests"] = sum(events.get(event, 0.0) for event in STAR_FOREST) / seconds
    return shares


def run_logged(case, steps):
    summary = speed.simulate_case(case, RANKS, steps, LOG)
    return shares_of(read_events(BUILD / "runs" / LOG), summary["step_loop_s"])


def measure_case(case, effort):
    steps = speed.steps_for(case, effort.seconds)[RANKS]
    logs = [run_logged(case, steps) for _ in range(effort.rounds)]
    settings = f"{RANKS} ranks; {steps} steps; median of {effort.rounds} runs"
    for phase in logs[0]:
        share = statistics.median(log.get(phase, 0.0) for log in logs)
        yield {"case": case, "phase": phase, "share": f"{share:.4f}"} | provenance(settings)


def measure(effort):
    return {"step_phases": [row for case in CASES for row in measure_case(case, effort)]}
