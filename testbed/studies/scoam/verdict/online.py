"""The claim of the abstract that the trajectory is re-planned online: under which condition it holds.

What an answer costs is a time of the computer that flew: another one each run, and on a slow machine another order of magnitude. So no
time decides here and none is written: ``verdict.csv`` and the page are the same bytes whatever flew them. The times are in ``timings.csv``.
"""

from typing import Final

from testbed.results.statistics import NAN, NO_EFFECT, NO_SPREAD
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS_ONLY_IF, NOT_DETERMINED, Claim
from testbed.studies.scoam.labels import READING_PARTS, Axis, Method
from testbed.studies.scoam.verdict.csv_words import say
from testbed.studies.scoam.verdict.flights import Flights, label, number
from testbed.studies.scoam.verdict.rulings import Ruling

TICK_MS: Final = 1000.0 / 60.0
"""Time between two looks of the planner at its usual 60 Hz."""


def rule(answers: int, safe: Claim) -> Ruling:
    """From how many flights got an answer, and from whether answers come early enough for an aircraft."""
    if not answers:
        return Ruling(NOT_DETERMINED, reason="none of these flights had a threat to answer")
    if safe.word in (FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN):
        return Ruling(HOLDS_ONLY_IF, "online means computed within a tick, and not early enough for the aircraft")
    return Ruling(HOLDS_ONLY_IF, "the computer answers within a tick")


def online(flights: Flights, safe: Claim) -> Claim:
    """``safe``: the claim of section 5.1 that the path is safe, for whether the answer comes in time."""
    scoam = (row for row in flights.all if label(row, Axis.METHOD) == Method.SCOAM and label(row, Axis.PART) not in READING_PARTS)
    answers = sum(number(row, "replans") > 0 for row in scoam)
    ruling = rule(answers, safe)
    said = [f"{ruling.reason[:1].upper()}{ruling.reason[1:]}."] if ruling.reason else []
    if answers:
        said.append(f"{answers} flights had a threat answered; a tick of the planner is {say(TICK_MS, 'ms')}.")
        said.append("What their answers took on the computer that flew them is the column fly.answer_s of timings.csv.")
    said.append(f"Whether the answer comes in time for an aircraft is the claim that the path is safe: {safe.word}.")
    return Claim(
        key="words.online",
        where="Abstract",
        text="the trajectory can be re-planned online",
        paper="can realize the online obstacle avoidance trajectory re-planning",
        unit="",
        quantity="",
        reading="",
        aircraft="",
        kinematic=NAN,
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
