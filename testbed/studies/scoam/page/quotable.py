"""The verdict in sentences that can be quoted: every number in them comes from the verdict, and what is missing is left out."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from testbed.show import words
from testbed.show.words import capital, counted, listed, named, sentence
from testbed.studies.scoam.claim import (
    FAILS_KINEMATICALLY,
    FAILS_WHEN_FLOWN,
    HOLDS,
    HOLDS_ONLY_IF,
    NOT_DETERMINED,
    TOO_FEW,
    VERDICT_WORDS,
    Rank,
    Waterfall,
)
from testbed.studies.scoam.labels import Part, Rung
from testbed.studies.scoam.page import paper_names
from testbed.studies.scoam.page.paper_names import AIRCRAFT_NAMES, ENCOUNTER, METHOD, METHOD_NAMES, RUNG_NAMES, SHORT_CLAIMS
from testbed.studies.scoam.page.table import DEPENDS, Block, blocks

if TYPE_CHECKING:
    from testbed.studies.scoam.verdict.judged import Verdict

Paragraph = tuple[str, list[str], bool]  # heading, sentences, and whether they are a list

WAYS: Mapping[str, str] = {
    Rung.VO_INSTANT: "with the velocity turned at once",
    Rung.KINEMATIC: "through the insertion point, kinematically",
    Rung.POINT_MASS: "for the point mass",
    Rung.JSBSIM: "flown in calm air",
    Part.WIND: "in steady wind (median)",
    Part.TURBULENCE: "in turbulence (median)",
}
COUNTED = {
    HOLDS: ("holds", "hold"),
    HOLDS_ONLY_IF: ("holds only under a condition", "hold only under a condition"),
    FAILS_KINEMATICALLY: ("fails kinematically, before any flight dynamics", "fail kinematically, before any flight dynamics"),
    FAILS_WHEN_FLOWN: ("fails when flown", "fail when flown"),
    NOT_DETERMINED: ("is not determined", "are not determined"),
    TOO_FEW: ("is withheld for want of flights", "are withheld for want of flights"),
    DEPENDS: ("depends on how the paper is read", "depend on how the paper is read"),
}


def paragraphs(verdict: "Verdict") -> list[Paragraph]:
    """Headings and their sentences; a part without data has no heading. What is behind a sentence stands in the tables."""
    made = blocks(verdict.claims)
    falls = [fall for fall in verdict.waterfalls if fall.steps and (fall.encounter, fall.method) == (ENCOUNTER, METHOD)]
    told: list[Paragraph] = [
        ("In short", _counts(made), False),
        ("Claim by claim", [_claim(block) for block in made if block.in_words], True),
        ("Where the metres go", [_waterfall(fall) for fall in falls], True),
        ("Against the other methods", _ranking(verdict.ranks), True),
        ("Can the flights be trusted?", _controls(verdict), False),
    ]
    return [paragraph for paragraph in told if paragraph[1]]


def _counts(made: Sequence[Block]) -> list[str]:
    said = []
    for noun, in_words in (("the paper's claims in words", True), ("the numbers in its tables", False)):
        members = [block for block in made if block.in_words == in_words]
        if members:
            count = Counter(block.word for block in members)
            parts = [f"{count[word]} {COUNTED[word][count[word] != 1]}" for word in (*VERDICT_WORDS, DEPENDS) if count[word]]
            said.append(f"Of {noun}, {len(members)} in all, {listed(parts)}.")
    return said


def _claim(block: Block) -> str:
    """What became of one claim in words, whichever reading leads, with its figures."""
    claim = block.first
    condition = paper_names.typeset(claim.condition).rstrip(".") if claim.condition and block.word == HOLDS_ONLY_IF else ""
    said = f"{claim.where}, {SHORT_CLAIMS.get(block.key, claim.text)}: {' '.join(filter(None, (block.word, condition)))}"
    figures = [
        f"{words.amount(value, claim.unit)} {where}"
        for value, where in ((claim.kinematic, "on rails"), (claim.flown_calm, "flown in calm air"))
        if math.isfinite(value)
    ]
    return sentence(f"{said}; {claim.quantity} {listed(figures)}" if figures else said)


def _waterfall(fall: Waterfall) -> str:
    parts = [f"{words.amount(step.clearance_m, 'm')} {WAYS[step.rung]}" for step in fall.steps if step.rung in WAYS]
    return f"{named(AIRCRAFT_NAMES, fall.aircraft)}: the least clearance is {listed(parts)}."


def _ranking(ranks: Sequence[Rank]) -> list[str]:
    said = []
    for rung in dict.fromkeys(rank.rung for rank in ranks):
        mine = [rank for rank in ranks if rank.rung == rung and rank.n]
        if not mine:
            continue
        best_first = sorted(mine, key=lambda rank: (-rank.safe / rank.n, rank.method))
        shares = [
            f"{named(METHOD_NAMES, rank.method)} in {words.percent(rank.safe / rank.n)} "
            f"({words.interval(rank.safe_low, rank.safe_high, 'share')})"
            for rank in best_first
        ]
        total = listed(sorted({str(rank.n) for rank in mine}, key=int))
        said.append(f"On {total} encounters of the paper's class ({named(RUNG_NAMES, rung)}), the radius is kept by {listed(shares)}.")
    return said


def _controls(verdict: "Verdict") -> list[str]:
    said = []
    flown = [control for control in verdict.controls if control.n]
    if flown:
        missed = [control for control in flown if control.met < control.n]
        said.append(f"Of {counted(len(flown), 'control')}, {len(flown) - len(missed)} came out as expected in every flight.")
        for control in missed:
            count = f"{control.met} of {counted(control.n, 'flight')}"
            said.append(sentence(f"{capital(control.name)} (expected: {control.expected}) came out so in {count}"))
    flights, silent, marginal = (sum(getattr(part, name) for part in verdict.counted) for name in ("flights", "silent", "marginal"))
    if flights:
        said.append(
            f"Of {counted(flights, 'flight')}, {silent} said nothing (the program failed, or the aircraft could not be trimmed) "
            f"and are left out, and {marginal} came so near to zero clearance that the step of the computation could decide."
        )
    return said
