"""The rules that turn evidence into one of the five words, or withhold it: ``docs/verdict.md``, section Words, and nothing else.

Pure: counts, intervals and shares go in, a ruling comes out.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy import special

from testbed.results.statistics import LEAST_PAIRS, LEVEL, Effect, share_interval
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS, HOLDS_ONLY_IF, NOT_DETERMINED, TOO_FEW, Word
from testbed.studies.scoam.verdict.csv_words import percent

SHARE: Final = 0.95  # of flights, and of draws, that "holds" needs
MAJORITY: Final = 0.5  # of draws, below which a failure is put down to what the paper does not print
AS_TAKEN: Final = "what the paper does not print is as taken here"
MOST_LOOKED_AT: Final = 20_000
"""Flights beyond which it is not looked for how many would settle a share."""


@dataclass(frozen=True)
class Ruling:
    """A word, what completes ``holds only if``, and the reason where the figures do not speak for themselves."""

    word: Word
    condition: str = ""
    reason: str = ""


@dataclass(frozen=True)
class Agreement:
    """Share of the robustness draws that say the same, and how many there are; NaN and 0 without draws."""

    share: float = math.nan
    n: int = 0


def settles(count: int, n: int, least: float) -> bool | None:
    """Whether a share is at least so large: by where its 95 % interval lies; None where that lies on both sides, and so few cannot say."""
    if n == 0:
        return None
    low, high = share_interval(count, n)
    return True if low >= least else False if high < least else None


def takes(count: int, n: int, least: float) -> str:
    """How many flights or draws of the same share would settle it."""
    more = np.arange(n + 1, MOST_LOOKED_AT + 1)
    same = np.rint(more * (count / n)) if n else more
    tail = 0.5 * (1.0 - LEVEL)
    with np.errstate(invalid="ignore"):
        low = np.where(same > 0, special.betaincinv(same, more - same + 1, tail), 0.0)
        high = np.where(same < more, special.betaincinv(same + 1, more - same, 1.0 - tail), 1.0)
    enough = more[(low >= least) | (high < least)]
    return f"about {enough[0]:,}" if len(enough) else f"more than {MOST_LOOKED_AT:,}"


def withheld(count: int, n: int, least: float, noun: str, what: str) -> "Ruling":
    """No word: ``3 of 5 draws say so, ...``."""
    short = f"which does not settle whether {percent(least)} of all would: it takes {takes(count, n, least)}"
    return Ruling(TOO_FEW, reason=f"{count} of {n} {noun} {what}, {short}")


def of_one(rails: bool, flown: bool) -> Word:
    """The word of one pair of flights, on rails and flown."""
    if not rails:
        return FAILS_KINEMATICALLY
    return HOLDS if flown else FAILS_WHEN_FLOWN


def agreement(word: Word, nominal: Word | None, draws: Sequence[Word]) -> Agreement:
    """How many draws say the word; where it is not one that a single draw can say, how many say what the nominal flight says."""
    target = word if word in (FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS) else nominal
    if not draws or target is None:
        return Agreement()
    return Agreement(sum(draw == target for draw in draws) / len(draws), len(draws))


def robust(ruling: Ruling, found: Agreement) -> Ruling:
    """The ruling after the draws: ``holds`` needs 95 % of them, a failure half of them; draws that settle neither leave no word."""
    least = {HOLDS: SHARE, FAILS_KINEMATICALLY: MAJORITY, FAILS_WHEN_FLOWN: MAJORITY}.get(ruling.word)
    if least is None:
        return ruling
    if not found.n:
        return Ruling(NOT_DETERMINED, reason="what the paper does not print was not varied") if ruling.word == HOLDS else ruling
    count = round(found.share * found.n)
    said = settles(count, found.n, least)
    if said is None:
        return withheld(count, found.n, least, "draws", f'say "{ruling.word}"')
    if said:
        return ruling
    if ruling.word == HOLDS:
        return Ruling(HOLDS_ONLY_IF, AS_TAKEN, f"only {percent(found.share)} of the draws say so")
    return Ruling(NOT_DETERMINED, reason=f"only {percent(found.share)} of the draws fail like that: it depends on what is not printed")


@dataclass(frozen=True)
class PromiseEvidence:
    """What a promise for every flight rests on. Cells are pairs of encounter and aircraft; the air is that of cells that pass on rails.

    ``conditions`` completes "holds only if" for the cells and the air in which every flight passes.
    """

    rails: tuple[bool, ...]
    flown: tuple[bool, ...]  # calm, of the cells that pass on rails
    air: tuple[bool, ...]
    share: Effect  # of the flown flights, calm and in air
    conditions: str


def promise(found: PromiseEvidence) -> Ruling:
    """Safe, flyable, within the overload: said of every flight."""
    if not found.rails:
        return Ruling(NOT_DETERMINED, reason="no flight on rails")
    if not any(found.rails):
        return Ruling(FAILS_KINEMATICALLY)
    if not found.flown:
        return Ruling(NOT_DETERMINED, reason="no flight of an aircraft in calm air")
    if not any(found.flown):
        return Ruling(FAILS_WHEN_FLOWN)
    return _partly(found)


def _partly(found: PromiseEvidence) -> Ruling:
    """A promise that is kept in calm air, by some flights or by all."""
    if not (all(found.rails) and all(found.flown)):
        return Ruling(HOLDS_ONLY_IF, found.conditions)
    if not found.air:
        return Ruling(HOLDS_ONLY_IF, found.conditions, "no wind and no turbulence was flown")
    if found.share.low >= SHARE:
        return Ruling(HOLDS)
    if not all(found.air):
        return Ruling(HOLDS_ONLY_IF, found.conditions)
    return withheld(found.share.n, found.share.n, SHARE, "flights", "pass")


BETTER: Final = "better"
TYPICAL: Final = "typical"
UNSETTLED: Final = "better or typical"
WORSE: Final = "worse"
OPEN: Final = "open"


@dataclass(frozen=True)
class Side:
    """Where a rung lies, the pairs it is judged by, and the pairs in which SCOAM is least."""

    lies: str
    n: int = 0
    kept: int = 0


def side(difference: Effect, margin: float, least: Effect) -> Side:
    """Where a median of paired differences lies: rival minus SCOAM, so that positive favours the claim; equal counts as least.

    ``better``: the interval is at or above ``-margin`` and SCOAM is least in at least 95 %; ``typical``: only the first.
    """
    n = difference.n
    kept = round(least.value * n) if n else 0
    if n < LEAST_PAIRS or difference.low < -margin <= difference.high:
        return Side(OPEN, n, kept)
    if difference.high < -margin:
        return Side(WORSE, n, kept)
    lies = {True: BETTER, False: TYPICAL, None: UNSETTLED}[settles(kept, n, SHARE)]
    return Side(lies, n, kept)


def comparison(rails: Side, flown: Side, share: float) -> Ruling:
    """The word of "least" and "shortest" from the two rungs' sides; ``share``: of encounters in which SCOAM is least, when flown."""
    failures: tuple[tuple[Side, Word, str], ...] = (
        (rails, FAILS_KINEMATICALLY, "on rails"),
        (flown, FAILS_WHEN_FLOWN, "when flown"),
    )
    for one, failure, where in failures:
        if one.lies == WORSE:
            return Ruling(failure)
        if one.lies == OPEN:
            if not one.n:
                return Ruling(NOT_DETERMINED, reason=f"there are no pairs {where}")
            return withheld(one.kept, one.n, MAJORITY, "pairs", f"have SCOAM least {where}")
    if TYPICAL in (rails.lies, flown.lies):
        return Ruling(HOLDS_ONLY_IF, f"the typical encounter is meant: SCOAM is least in {percent(share)} of them")
    unsettled = next((one for one in (rails, flown) if one.lies == UNSETTLED), None)
    return withheld(unsettled.kept, unsettled.n, SHARE, "pairs", "have SCOAM least") if unsettled else Ruling(HOLDS)
