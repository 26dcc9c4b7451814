"""What became of the paper's claims, in three lines."""

import math
from collections import Counter
from typing import Final

from testbed.show import words
from testbed.show.answer import BAD, KEPT, UNSURE, Answer, counted_bars
from testbed.studies.scoam.claim import (
    FAILS_KINEMATICALLY,
    FAILS_WHEN_FLOWN,
    HOLDS,
    HOLDS_ONLY_IF,
    NOT_DETERMINED,
    TOO_FEW,
    VERDICT_WORDS,
    Claim,
)
from testbed.studies.scoam.page import top
from testbed.studies.scoam.page.table import blocks
from testbed.studies.scoam.verdict.judged import Verdict

TONES: Final = {HOLDS: KEPT, HOLDS_ONLY_IF: UNSURE, FAILS_KINEMATICALLY: BAD, FAILS_WHEN_FLOWN: BAD, NOT_DETERMINED: "", TOO_FEW: ""}
FLYABLE: Final = "words.single.flyable"
"""The claim that is told by itself: that the new path can be flown. That it is safe leads."""


def answer(verdict: Verdict) -> Answer:
    """The sentence that leads the page, how many claims have which word, and whether the path can be flown."""
    count = Counter(claim.word for claim in verdict.claims)
    told = [f"{word} {count[word]}" for word in VERDICT_WORDS if count[word]]
    lines = [top.answer(verdict.claims, blocks(verdict.claims))]
    lines += [f"Of {words.counted(len(verdict.claims), 'claim')} of the paper: {', '.join(told)}."] if told else []
    lines += [_told(claim) for claim in verdict.claims if claim.key == FLYABLE]
    bars = counted_bars((word, count[word], TONES[word]) for word in VERDICT_WORDS if count[word])
    return Answer(tuple(lines), bars, of="count")


def _told(claim: Claim) -> str:
    air = claim.flown_air
    figures = [("on rails", claim.kinematic), ("flown in calm air", claim.flown_calm)]
    said = [f"{name} {words.amount(value, claim.unit)}" for name, value in figures if math.isfinite(value)]
    if air.n:
        interval = words.interval(air.p05, air.p95, claim.unit)
        said.append(f"in wind and turbulence {interval} (5 to 95 % of {words.counted(air.n, 'flight')})")
    verdict = f"{claim.word} {claim.condition}".strip()
    return words.sentence(
        f"\N{LEFT DOUBLE QUOTATION MARK}{words.capital(claim.text)}\N{RIGHT DOUBLE QUOTATION MARK} {verdict}: {', '.join(said)}"
    )
