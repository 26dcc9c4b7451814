"""The claims in words that compare: least deflection, shortest path, least time, superior."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from testbed.results.statistics import LEAST_PAIRS, NAN, finite, spread
from testbed.show.words import listed
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, HOLDS, HOLDS_ONLY_IF, NOT_DETERMINED, TOO_FEW, Claim, Word
from testbed.studies.scoam.labels import DROAM, MAIN, MULTI, SINGLE, Design, Method, Part, Rung
from testbed.studies.scoam.verdict import robustness
from testbed.studies.scoam.verdict.csv_words import interval, percent, reading, say
from testbed.studies.scoam.verdict.flights import Flights
from testbed.studies.scoam.verdict.pairs import CLEAR, DEFLECTION, EVERY, LENGTH, TIME, Measure, Pairs, gain, paired
from testbed.studies.scoam.verdict.rulings import Agreement, Ruling, agreement, comparison, robust, side

SINGLE_DRAWN: Final = SINGLE[0]
POPULATION: Final = Part.POPULATION


@dataclass(frozen=True)
class Least:
    """A claim that SCOAM has the least of something."""

    key: str
    text: str
    paper: str
    measure: Measure


CLAIMS: Final = (
    Least(
        "words.deflection_least",
        "SCOAM's deflection is the least",
        "the deflection angle based on space VOSC method is minimum",
        DEFLECTION,
    ),
    Least("words.path_shortest", "SCOAM's path is the shortest", "the path length is the shortest", LENGTH),
    Least("words.time_least", "SCOAM takes the least time", "it costs the least time for obstacle avoidance", TIME),
)


@dataclass(frozen=True)
class Judged:
    """A ruling against some rivals, and the pairs it rests on."""

    ruling: Ruling
    agreement: Agreement
    rails: Pairs
    flown: Pairs


def least(flights: Flights, claim: Least) -> Claim:
    """Against the paper's own rivals first; what holds there must hold against the least possible too, or is so conditioned."""
    own = _judged(flights, claim.measure, DROAM)
    every = _judged(flights, claim.measure, EVERY)
    ruling = own.ruling
    if own.ruling.word == HOLDS and every.ruling.word == TOO_FEW:
        ruling = every.ruling
    elif own.ruling.word in (HOLDS, HOLDS_ONLY_IF) and every.ruling.word not in (own.ruling.word, TOO_FEW):
        extra = [own.ruling.condition] if own.ruling.condition else []
        ruling = Ruling(HOLDS_ONLY_IF, ", ".join(["DROAM is the only rival", *extra]), every.ruling.reason)
    on_rails = ruling.word in (FAILS_KINEMATICALLY, NOT_DETERMINED) or not own.flown.differences
    effect = own.rails.effect if on_rails else own.flown.effect
    rungs = {rung: _nominal(flights, claim.measure, rung, SINGLE_DRAWN) for rung in (Rung.KINEMATIC, Rung.POINT_MASS, Rung.JSBSIM)}
    return Claim(
        claim.key,
        "Table 2",
        claim.text,
        claim.paper,
        claim.measure.unit,
        f"{claim.measure.name} of the best DROAM minus SCOAM's (flown: {_flown_name(claim.measure)})",
        SINGLE_DRAWN,
        MAIN,
        rungs[Rung.KINEMATIC],
        rungs[Rung.POINT_MASS],
        rungs[Rung.JSBSIM],
        spread(_in_air(flights, claim.measure)),
        ruling.word,
        ruling.condition,
        effect,
        own.agreement.share,
        own.agreement.n,
        "",
        _why(flights, claim.measure, own, every, ruling),
    )


def _flown_name(measure: Measure) -> str:
    return "as flown at the insertion point" if measure is DEFLECTION else "the same"


def _judged(flights: Flights, measure: Measure, rivals: Sequence[str]) -> Judged:
    """By the population; without one, the paper's own encounters can refute, together with their draws, but not prove."""
    nominal, words = draw_words(flights, measure, rivals)
    rails, flown = (paired(flights, measure, POPULATION, rung, rivals) for rung in (Rung.KINEMATIC, Rung.JSBSIM))
    if len(rails.differences) >= LEAST_PAIRS:
        sides = [side(pairs.effect, measure.margin, pairs.least) for pairs in (rails, flown)]
        ruling = comparison(sides[0], sides[1], flown.least.value)
    else:
        own = finite(_nominal(flights, measure, Rung.KINEMATIC, encounter, rivals) for encounter in SINGLE)
        rails = Pairs(tuple(own), measure)
        flown = Pairs(tuple(finite(_nominal(flights, measure, Rung.JSBSIM, encounter, rivals) for encounter in SINGLE)), measure)
        refuted = bool(own) and max(own) < -measure.margin and bool(words)
        ruling = Ruling(FAILS_KINEMATICALLY) if refuted else Ruling(NOT_DETERMINED, reason="no population was flown")
    agree = agreement(ruling.word, nominal, words)
    return Judged(robust(ruling, agree), agree, rails, flown)


def draw_words(flights: Flights, measure: Measure, rivals: Sequence[str], encounter: str = SINGLE_DRAWN) -> tuple[Word | None, list[Word]]:
    """What each draw's own flights say: SCOAM is least on rails, and flown."""
    both = []
    for rung in (Rung.KINEMATIC, Rung.JSBSIM):
        scoam = robustness.replicates(flights, Method.SCOAM, rung, encounter)
        others = [robustness.replicates(flights, rival, rung, encounter) for rival in rivals]
        gains = {n: gain(measure, rung, row, [other[n] for other in others if n in other]) for n, row in scoam.items()}
        both.append({n: (g >= -measure.margin if math.isfinite(g) else None) for n, g in gains.items()})
    return robustness.pair_words(*both)


def _nominal(flights: Flights, measure: Measure, rung: str, encounter: str, rivals: Sequence[str] = DROAM) -> float:
    """The difference in one encounter in calm air."""
    pairs = paired(flights, measure, Part.CALM, rung, rivals, encounter=encounter, flown_by=MAIN).differences
    return pairs[0] if pairs else NAN


def _in_air(flights: Flights, measure: Measure) -> list[float]:
    wind = paired(flights, measure, Part.WIND, Rung.JSBSIM, DROAM, encounter=SINGLE_DRAWN, flown_by=MAIN, design=Design.ANCHORED)
    return [
        *wind.differences,
        *paired(flights, measure, Part.TURBULENCE, Rung.JSBSIM, DROAM, encounter=SINGLE_DRAWN, flown_by=MAIN).differences,
    ]


def _why(flights: Flights, measure: Measure, own: Judged, every: Judged, ruling: Ruling) -> str:
    """The figures of the deciding pairs, then the paper's own encounters."""
    said = []
    if len(own.rails.differences) >= LEAST_PAIRS:
        told = [f"{name} {interval(pairs.effect)}, SCOAM least in {percent(pairs.least.value)}" for name, pairs in _rungs(own)]
        said.append(f"Best DROAM minus SCOAM over the population: {'; '.join(told)}.")
        said.append(f"With the least deflection as a rival: {interval(every.rails.effect)} on rails, {interval(every.flown.effect)} flown.")
    for rung, where in ((Rung.KINEMATIC, "On rails"), (Rung.JSBSIM, "Flown")):
        gaps = {encounter: _nominal(flights, measure, rung, encounter) for encounter in (*SINGLE, *MULTI)}
        told = [f"{_apart(gap, measure.unit)} ({reading(encounter)})" for encounter, gap in gaps.items() if math.isfinite(gap)]
        if told:
            said.append(f"{where} SCOAM's {measure.name} is, against the best DROAM's in calm air, {listed(told)}.")
    if measure is TIME and math.isfinite(gap := _nominal(flights, CLEAR, Rung.KINEMATIC, SINGLE_DRAWN)):
        said.append(f"Until clear instead of to the insertion point, on rails: {_apart(gap, 's')}.")
    if ruling.reason:
        said.append(f"{ruling.reason[:1].upper()}{ruling.reason[1:]}.")
    return " ".join(said) or "No pair of flights."


def _rungs(judged: Judged) -> tuple[tuple[str, Pairs], ...]:
    return (("on rails", judged.rails), ("flown", judged.flown))


def _apart(gap: float, unit: str) -> str:
    """How far SCOAM is from its rival, in words."""
    size = say(abs(gap), unit)
    if size == say(0.0, unit):
        return "the same"
    return f"{size} {'less' if gap > 0.0 else 'more'}"


def comparisons(flights: Flights) -> tuple[Claim, ...]:
    """Least deflection, shortest path, least time."""
    return tuple(least(flights, claim) for claim in CLAIMS)
