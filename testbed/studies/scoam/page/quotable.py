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
    VERDICT_WORDS,
    Claim,
    Rank,
    Waterfall,
)
from testbed.studies.scoam.labels import Method, Part, Rung
from testbed.studies.scoam.page import paper_names
from testbed.studies.scoam.page.paper_names import AIRCRAFT_NAMES, ENCOUNTER, LIMIT_NAMES, METHOD, METHOD_NAMES, READING_NAMES, RUNG_NAMES
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
PHRASES = {
    HOLDS: "This holds",
    HOLDS_ONLY_IF: "This holds only if {condition}",
    FAILS_KINEMATICALLY: "This fails already for a point that flies the path exactly: flight dynamics is not to blame",
    FAILS_WHEN_FLOWN: "This holds for a point that flies the path exactly, and fails when an aircraft flies it",
    NOT_DETERMINED: "This cannot be determined",
}
COUNTED = {
    HOLDS: ("holds", "hold"),
    HOLDS_ONLY_IF: ("holds only under a condition", "hold only under a condition"),
    FAILS_KINEMATICALLY: ("fails kinematically, before any flight dynamics", "fail kinematically, before any flight dynamics"),
    FAILS_WHEN_FLOWN: ("fails when flown", "fail when flown"),
    NOT_DETERMINED: ("is not determined", "are not determined"),
    DEPENDS: ("depends on how the paper is read", "depend on how the paper is read"),
}


def paragraphs(verdict: "Verdict") -> list[Paragraph]:
    """Headings and their sentences; a part without data has no heading."""
    made = blocks(verdict.claims)
    falls = [fall for fall in verdict.waterfalls if fall.steps and (fall.encounter, fall.method) == (ENCOUNTER, METHOD)]
    told: list[Paragraph] = [
        ("In short", _counts(made), False),
        *((f"{block.first.where}: {block.first.text}", _claim(block), False) for block in made if block.in_words),
        ("The numbers of the tables", _numbers([block for block in made if not block.in_words]), True),
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
            parts = []
            for word in (*VERDICT_WORDS, DEPENDS):
                names = "; ".join(block.first.text for block in members if block.word == word)
                parts += [f"{count[word]} {COUNTED[word][count[word] != 1]}" + (f" ({names})" if in_words else "")] if count[word] else []
            said.append(f"Of {noun}, {len(members)} in all, {listed(parts)}.")
    return said


def _claim(block: Block) -> list[str]:
    """What became of one claim in words, reading by reading."""
    said = []
    for claim in block.told:
        under = [named(READING_NAMES, claim.reading)] if claim.reading else []
        under += [named(AIRCRAFT_NAMES, claim.aircraft)] if claim.aircraft and len({c.aircraft for c in block.told}) > 1 else []
        before = f"{', '.join(under)}: " if len(block.told) > 1 and under else ""
        if claim.paper:
            before += f"\N{LEFT DOUBLE QUOTATION MARK}{claim.paper}\N{RIGHT DOUBLE QUOTATION MARK}: "
        condition = paper_names.typeset(claim.condition or "a condition that is not named").rstrip(".")
        said.append(capital(before) + sentence(PHRASES[claim.word].format(condition=condition)))
        said += [paper_names.typeset(text) for text in (claim.why, capital(paper_names.effect(claim.effect))) if text]
        if claim.deciding_limit:
            said.append(f"What decides it: {sentence(claim.deciding_limit)}")
        if claim.robustness_n and math.isfinite(claim.robustness_share):
            said.append(
                f"Of {counted(claim.robustness_n, 'draw')} of the inputs and parameters that the paper leaves open, "
                f"{words.percent(claim.robustness_share)} {'gives' if claim.robustness_n == 1 else 'give'} the same word."
            )
    return said


def _numbers(made: Sequence[Block]) -> list[str]:
    """Table by table: how many numbers there are of each word, and which."""
    said = []
    for where in dict.fromkeys(block.first.where for block in made):
        mine = [block for block in made if block.first.where == where]
        for word in (*VERDICT_WORDS, DEPENDS):
            those = [block for block in mine if block.word == word]
            if those:
                names = listed([f"{block.first.text} ({_printed(block.first)})" for block in those])
                said.append(f"{where}: {len(those)} of {len(mine)} {COUNTED[word][len(those) != 1]}: {names}.")
    return said


def _printed(claim: Claim) -> str:
    """Printed and recomputed."""
    digits = max(paper_names.decimals(claim.paper), words.UNIT_DIGITS.get(claim.unit, 2))
    return f"printed {claim.paper}, kinematic {words.amount(claim.kinematic, claim.unit, digits)}"


def _waterfall(fall: Waterfall) -> str:
    parts = [f"{words.amount(step.clearance_m, 'm')} {WAYS[step.rung]}" for step in fall.steps if step.rung in WAYS]
    who = f"{named(READING_NAMES, fall.encounter)}, {named(METHOD_NAMES, fall.method)}, {named(AIRCRAFT_NAMES, fall.aircraft)}"
    said = f"{who}: the least clearance is {listed(parts)}."
    alone = [
        f"{named(LIMIT_NAMES, limit)} {words.amount(cost, 'm')}" for limit, cost in sorted(fall.alone_m.items()) if math.isfinite(cost)
    ]
    last = [f"{named(LIMIT_NAMES, limit)} {words.amount(gain, 'm')}" for limit, gain in sorted(fall.last_m.items()) if math.isfinite(gain)]
    if alone:
        said += f" Each limit of the point mass alone costs: {listed(alone)}."
    if last:
        said += f" Taken away from all of them, it gives back: {listed(last)}."
    return said


def signed(metres: float) -> str:
    """A change in metres, always with its sign."""
    text = words.amount(metres, "m")
    return f"+{text}" if math.isfinite(metres) and not text.startswith("\N{MINUS SIGN}") else text


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
        said.append(
            f"On {total} encounters of the paper's class ({named(RUNG_NAMES, rung)}), the radius is kept by {listed(shares)}; "
            "in brackets 95 % intervals."
        )
        rivals = [rank for rank in best_first if rank.method not in (Method.SCOAM, Method.NONE)]
        duels = [_duel(rank) for rank in rivals if math.isfinite(rank.versus_scoam.value)]
        if duels:
            said.append(f"SCOAM's clearance less the other's, paired by encounter ({named(RUNG_NAMES, rung)}): {'; '.join(duels)}.")
    return said


def _duel(rank: Rank) -> str:
    """``DROAM/HP 0.4 m (0.1 to 0.9 m; McNemar's p < 0.001)``."""
    told = rank.versus_scoam
    known = [words.interval(told.low, told.high, told.unit)] if math.isfinite(told.low) and math.isfinite(told.high) else []
    known += [f"share that keeps the radius: McNemar's {p_value(rank.mcnemar_p)}"] if math.isfinite(rank.mcnemar_p) else []
    return f"{named(METHOD_NAMES, rank.method)} {words.amount(told.value, told.unit)}" + (f" ({'; '.join(known)})" if known else "")


def p_value(p: float) -> str:
    """``p = 0.03``, ``p < 0.001``."""
    return words.DASH if not math.isfinite(p) else "p < 0.001" if p < 0.001 else f"p = {p:.2g}"


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
