"""The claim of the abstract that the trajectory is re-planned online: what the answer costs, and whether it comes in time."""

import math
from typing import Final

from testbed.results.statistics import NAN, NO_EFFECT, NO_SPREAD
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS_ONLY_IF, NOT_DETERMINED, Claim
from testbed.studies.scoam.labels import Axis, Method
from testbed.studies.scoam.verdict.csv_words import say
from testbed.studies.scoam.verdict.flights import Flights, label, number
from testbed.studies.scoam.verdict.rulings import Ruling

TICK_MS: Final = 1000.0 / 60.0
"""Time between two looks of the planner at its usual 60 Hz."""


def rule(answer_ms: float, safe: Claim) -> Ruling:
    """From the time that the planner takes, and from whether its answers come early enough for an aircraft."""
    if not math.isfinite(answer_ms):
        return Ruling(NOT_DETERMINED, reason="the planner's computing time was not measured in these flights")
    if answer_ms > TICK_MS:
        return Ruling(NOT_DETERMINED, reason="on the computer that flew this an answer may take longer than a tick")
    if safe.word in (FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN):
        return Ruling(HOLDS_ONLY_IF, "online means computed within a tick, and not early enough for the aircraft")
    return Ruling(HOLDS_ONLY_IF, "the computer is as fast as the one that flew this")


def online(flights: Flights, safe: Claim, answer_ms: float) -> Claim:
    """``safe``: the claim of section 5.1 that the path is safe, for whether the answer comes in time."""
    answers = sum(label(row, Axis.METHOD) == Method.SCOAM and number(row, "replans") > 0 for row in flights.all)
    ruling = rule(answer_ms, safe)
    said = [f"{ruling.reason[:1].upper()}{ruling.reason[1:]}."] if ruling.reason else []
    if math.isfinite(answer_ms):
        most = f"at most {say(answer_ms, 'ms')} (median of {answers} flights, rounded up to a power of ten)"
        said.append(f"From threat to new path takes {most}; a tick of the planner is {say(TICK_MS, 'ms')}.")
    said.append(f"Whether the answer comes in time for an aircraft is the claim that the path is safe: {safe.word}.")
    return Claim(
        key="words.online",
        where="Abstract",
        text="the trajectory can be re-planned online",
        paper="can realize the online obstacle avoidance trajectory re-planning",
        unit="ms",
        quantity="computing time of an answer, at most",
        reading="",
        aircraft="",
        kinematic=answer_ms,
        point_mass=NAN,
        flown_calm=NAN,
        flown_air=NO_SPREAD,
        word=ruling.word,
        condition=ruling.condition,
        effect=NO_EFFECT,
        robustness_share=NAN,
        robustness_n=0,
        deciding_limit="",
        why=" ".join(said),
    )
