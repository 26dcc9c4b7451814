"""The claim of the abstract that the trajectory is re-planned online: what the answer costs, and whether it comes in time."""

import math
from collections.abc import Sequence
from typing import Final

from testbed.paper.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS_ONLY_IF, NOT_DETERMINED, Claim
from testbed.paper.verdict.saying import percent, say
from testbed.paper.verdict.select import Flights, label, number
from testbed.paper.verdict.stats import NAN, NO_EFFECT, finite, share, spread
from testbed.paper.verdict.words import SHARE, Ruling

COST: Final = "planner_ms"
"""Column with the wall-clock time of the slowest decision of a flight, ms; no row needs to have it."""
TICK_MS: Final = 1000.0 / 60.0
"""Time between two looks of the planner at its usual 60 Hz."""


def rule(costs: Sequence[float], safe: Claim) -> Ruling:
    """From the times of the planner, and from whether its answers come early enough for an aircraft."""
    if not costs:
        return Ruling(NOT_DETERMINED, reason="the planner's computing time was not measured in these flights")
    intime = share("", sum(cost <= TICK_MS for cost in costs), len(costs))
    if intime.low < SHARE:
        return Ruling(NOT_DETERMINED, reason=f"{percent(intime.value)} of {intime.n} flights decide within a tick")
    if safe.word in (FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN):
        return Ruling(HOLDS_ONLY_IF, "online means computed within a tick, and not early enough for the aircraft")
    return Ruling(HOLDS_ONLY_IF, "the computer is as fast as the one that flew this")


def online(flights: Flights, safe: Claim) -> Claim:
    """``safe``: the claim of section 5.1 that the path is safe, for whether the answer comes in time."""
    rows = [row for row in flights.all if label(row, "method") == "scoam" and number(row, "replans") > 0]
    costs = finite(number(row, COST) for row in rows)
    ruling, found = rule(costs, safe), spread(costs)
    effect = (
        share("flights whose slowest decision takes no longer than a tick", sum(c <= TICK_MS for c in costs), len(costs))
        if costs
        else NO_EFFECT
    )
    said = [f"{ruling.reason[:1].upper()}{ruling.reason[1:]}."] if ruling.reason else []
    if math.isfinite(found.median):
        worst = f"{say(found.median, 'ms')} (95 % below {say(found.p95, 'ms')})"
        said.append(f"The slowest decision of a flight takes {worst}; a tick is {say(TICK_MS, 'ms')}.")
    said.append(f"Whether the answer comes in time for an aircraft is the claim that the path is safe: {safe.word}.")
    return Claim(
        "words.online",
        "Abstract",
        "the trajectory can be re-planned online",
        "can realize the online obstacle avoidance trajectory re-planning",
        "ms",
        "computing time of a flight's slowest decision",
        "",
        "",
        NAN,
        NAN,
        NAN,
        found,
        ruling.word,
        ruling.condition,
        effect,
        NAN,
        0,
        "",
        " ".join(said),
    )
