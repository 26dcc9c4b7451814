"""The claim that SCOAM is superior to DROAM: five criteria, each against both of its planes, in pairs of the population."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from testbed.results.statistics import LEAST_PAIRS, NAN, NO_EFFECT, NO_SPREAD, Effect, mcnemar, median
from testbed.show.words import listed
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS, HOLDS_ONLY_IF, NOT_DETERMINED, Claim
from testbed.studies.scoam.labels import DROAM, MAIN, Encounter, Method, Part, Rung
from testbed.studies.scoam.verdict.comparisons import draw_words
from testbed.studies.scoam.verdict.csv_words import METHOD_WORDS, RUNG_WORDS, percent, say
from testbed.studies.scoam.verdict.flights import Flights, clearance, keeps
from testbed.studies.scoam.verdict.pairs import CLEARANCE, DEFLECTION, LENGTH, LOAD, gain, paired
from testbed.studies.scoam.verdict.ranking import Pairs, safe_pairs, threats, with_scoam
from testbed.studies.scoam.verdict.rulings import Ruling, agreement, robust

BETTER, WORSE, EQUAL, OPEN = "better", "worse", "equal", "open"
ALPHA: Final = 0.05
MEASURES: Final = (CLEARANCE, DEFLECTION, LENGTH, LOAD)
SAFE_SHARE: Final = "share that is safe"
MULTI_DRAWN: Final = Encounter.MULTI_O2_UP


@dataclass(frozen=True)
class Criterion:
    """One criterion on one rung: where SCOAM lies against both planes, and the medians (shares) against each."""

    name: str
    verdict: str
    figures: str


def criteria(flights: Flights, rung: str) -> list[Criterion]:
    """All five, or none where there are too few pairs."""
    pairs = {plane: with_scoam(flights, plane, rung) for plane in DROAM}
    if min(len(found) for found in pairs.values()) < LEAST_PAIRS:
        return []
    out = [_safety(pairs)]
    for measure in MEASURES:
        effects = [median(measure.name, measure.unit, (gain(measure, rung, a, [b]) for a, b in pairs[plane])) for plane in DROAM]
        figures = f"{measure.name} {say(effects[0].value)} and {say(effects[1].value, measure.unit)}"
        out.append(Criterion(measure.name, both([lies(effect, measure.margin) for effect in effects]), figures))
    return out


def _safety(pairs: Mapping[Method, Pairs]) -> Criterion:
    found = []
    for plane in DROAM:
        ours, theirs = safe_pairs(pairs[plane])
        found.append(OPEN if mcnemar(ours, theirs) >= ALPHA else BETTER if ours > theirs else WORSE)
    counts = [safe_pairs(pairs[plane]) for plane in DROAM]
    figures = f"pairs in which SCOAM alone is safe {counts[0][0]} and {counts[1][0]}, DROAM alone {counts[0][1]} and {counts[1][1]}"
    return Criterion(SAFE_SHARE, both(found), figures)


def lies(effect: Effect, margin: float) -> str:
    """Better or worse by more than the margin, wholly; equal when wholly within it; open otherwise."""
    if effect.n < LEAST_PAIRS:
        return OPEN
    if effect.low > margin:
        return BETTER
    if effect.high < -margin:
        return WORSE
    return EQUAL if effect.low >= -margin and effect.high <= margin else OPEN


def both(found: list[str]) -> str:
    """Better only than both planes, worse already than one."""
    if WORSE in found:
        return WORSE
    if all(one == BETTER for one in found):
        return BETTER
    return EQUAL if all(one in (BETTER, EQUAL) for one in found) else OPEN


def rule(rails: list[Criterion], flown: list[Criterion]) -> Ruling:
    """Superior: better than both planes in something and worse than neither in anything, on rails and flown."""
    if not rails:
        return Ruling(NOT_DETERMINED, reason="no population was flown")
    ahead, behind = _named(rails, BETTER), _named(rails, WORSE)
    if not ahead:
        return Ruling(FAILS_KINEMATICALLY) if behind else Ruling(NOT_DETERMINED, reason="no criterion tells the methods apart on rails")
    if not flown:
        return Ruling(NOT_DETERMINED, reason="the population was not flown by an aircraft")
    left = [name for name in ahead if name in _named(flown, BETTER)]
    if not left:
        return Ruling(FAILS_WHEN_FLOWN)
    if behind or _named(flown, WORSE) or any(one.verdict == OPEN for one in (*rails, *flown)):
        return Ruling(HOLDS_ONLY_IF, f"superior means {listed(left)}")
    return Ruling(HOLDS)


def _named(found: list[Criterion], verdict: str) -> list[str]:
    return [one.name for one in found if one.verdict == verdict]


def superior(flights: Flights) -> Claim:
    """The claim of section 5.2, with the paired difference in clearance when flown as its effect."""
    rails, flown = criteria(flights, Rung.KINEMATIC), criteria(flights, Rung.JSBSIM)
    first = rule(rails, flown)
    nominal, words = draw_words(flights, CLEARANCE, DROAM, MULTI_DRAWN)
    agree = agreement(first.word, nominal, words)
    ruling = robust(first, agree)
    rung = Rung.JSBSIM if flown and first.word != FAILS_KINEMATICALLY else Rung.KINEMATIC
    return Claim(
        "words.superior",
        "Section 5.2",
        "SCOAM is superior to DROAM in a plane",
        "the superiority of the space SCOAM",
        "m",
        "least clearance of SCOAM minus that of the better DROAM",
        MULTI_DRAWN,
        MAIN,
        _nominal(flights, Rung.KINEMATIC),
        _nominal(flights, Rung.POINT_MASS),
        _nominal(flights, Rung.JSBSIM),
        NO_SPREAD,
        ruling.word,
        ruling.condition,
        _effect(flights, rung),
        agree.share,
        agree.n,
        "",
        _why(flights, rails, flown, ruling),
    )


def _effect(flights: Flights, rung: str) -> Effect:
    """SCOAM's clearance minus that of the plane that does better in the median."""
    found = [
        median(
            f"median of SCOAM's clearance minus that of {METHOD_WORDS[plane]}, {RUNG_WORDS[rung]}",
            "m",
            (clearance(a) - clearance(b) for a, b in with_scoam(flights, plane, rung)),
        )
        for plane in DROAM
    ]
    told = [effect for effect in found if effect.n]
    return min(told, key=lambda effect: effect.value) if told else NO_EFFECT


def _nominal(flights: Flights, rung: str) -> float:
    """In the encounter of section 5.2 that is one, in calm air: against the better of all four sides."""
    found = paired(flights, CLEARANCE, Part.CALM, rung, DROAM, encounter=MULTI_DRAWN, flown_by=MAIN)
    return found.differences[0] if found.differences else NAN


def _why(flights: Flights, rails: list[Criterion], flown: list[Criterion], ruling: Ruling) -> str:
    said = []
    for rung, name, found in ((Rung.KINEMATIC, "On rails", rails), (Rung.JSBSIM, "Flown", flown)):
        if found:
            shares = [f"{percent(_share(flights, method, rung))} ({METHOD_WORDS[method]})" for method in (Method.SCOAM, *DROAM)]
            told = [f"{verdict} in {listed(_named(found, verdict))}" for verdict in (BETTER, WORSE) if _named(found, verdict)]
            said.append(
                f"{name} {listed(shares)} of the threats are kept clear; SCOAM is {' and '.join(told) or 'neither better nor worse'}."
            )
            said.append(f"Medians of its gain over HP and VP: {'; '.join(one.figures for one in found[1:])}; {found[0].figures}.")
    if not said:
        told = [f"{say(_nominal(flights, rung), 'm')} {name}" for rung, name in ((Rung.KINEMATIC, "on rails"), (Rung.JSBSIM, "flown"))]
        said.append(
            f"In the one encounter of section 5.2 SCOAM's clearance minus the best DROAM's is {listed(told)}; one case ranks nothing."
        )
    return " ".join([*said, *([f"{ruling.reason[:1].upper()}{ruling.reason[1:]}."] if ruling.reason else [])])


def _share(flights: Flights, method: str, rung: str) -> float:
    rows = threats(flights, method, rung)
    return sum(map(keeps, rows)) / len(rows) if rows else NAN
