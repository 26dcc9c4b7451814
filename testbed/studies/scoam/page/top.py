"""What leads the page of a verdict: the answer in one sentence, the claims as badges, the waterfall, and what all of it rests on."""

import math
from collections import Counter
from typing import TYPE_CHECKING

from markupsafe import Markup

from testbed.show import words
from testbed.show.hero import Hero, Tag
from testbed.show.words import named
from testbed.studies.scoam.claim import (
    FAILS_KINEMATICALLY,
    FAILS_WHEN_FLOWN,
    HOLDS,
    HOLDS_ONLY_IF,
    NOT_DETERMINED,
    TOO_FEW,
    VERDICT_WORDS,
    Claim,
    Waterfall,
)
from testbed.studies.scoam.labels import MAIN, Part
from testbed.studies.scoam.page import bars, reference
from testbed.studies.scoam.page.paper_names import AIRCRAFT_NAMES, ENCOUNTER, METHOD, READING_NAMES, SHORT_CLAIMS, WORD_CLASS
from testbed.studies.scoam.page.table import DEPENDS, Block, blocks

if TYPE_CHECKING:
    from testbed.studies.scoam.verdict.judged import Verdict

LEADING = "words.single.safe"
SHORT_ANSWER = {
    HOLDS: "Yes",
    HOLDS_ONLY_IF: "Only under a condition",
    FAILS_KINEMATICALLY: "No, not even on rails",
    FAILS_WHEN_FLOWN: "No",
    NOT_DETERMINED: "It is not determined",
}


def hero(verdict: "Verdict") -> Hero:
    """That of the page; what was not flown is left out."""
    made = blocks(verdict.claims)
    fall = next((one for one in verdict.waterfalls if (one.encounter, one.method) == (ENCOUNTER, METHOD) and one.steps), None)
    return Hero(
        answer=answer(verdict.claims, made),
        rests=rests(verdict, made),
        tags=_tags(made),
        picture=bars.waterfall_svg(fall) if fall else Markup(),
        caption=_caption(fall),
        notes=tuple(n for n in (reference.note(verdict.claims),) if n),
    )


def answer(claims: "tuple[Claim, ...]", made: list[Block]) -> str:
    """Of the claim that leads: what is left on rails and when flown, and in how many flights the radius is kept."""
    safe = next((claim for claim in claims if claim.key == LEADING), None)
    if safe is None or not math.isfinite(safe.kinematic):
        words_of = Counter(block.word for block in made if block.in_words)
        told = [f"{n} {word}" for word, n in words_of.items()]
        return (
            f"Of the paper's {words.counted(sum(words_of.values()), 'claim')} in words: {words.listed(told)}."
            if told
            else "No flight was flown."
        )
    said = f"{_short(safe)}: on rails the re-planned path {_stands(safe.kinematic)}"
    if math.isfinite(safe.flown_calm):
        said += f", flown in calm air it {_stands(safe.flown_calm)}"
    kept = safe.effect
    if kept.n > 1 and math.isfinite(kept.value) and safe.word != FAILS_KINEMATICALLY:
        interval = words.interval(kept.low, kept.high, "share")
        n = f"{round(kept.value * kept.n)} of {kept.n:,} flights"
        said += f", and in calm air, wind and turbulence together {n} keep every radius (95 % interval {interval})"
    return f"{said}."


def _short(safe: Claim) -> str:
    """The word as an answer; one that is withheld still says what these flights did."""
    if safe.word == TOO_FEW:
        failed = min(safe.kinematic, safe.flown_calm if math.isfinite(safe.flown_calm) else math.inf) < 0.0
        return f"{'Not in' if failed else 'In'} these flights, which are too few for a verdict"
    return SHORT_ANSWER.get(safe.word, words.capital(safe.word))


def _stands(clearance_m: float) -> str:
    amount = words.amount(abs(clearance_m), "m")
    return f"passes {amount} inside the obstacle" if clearance_m < 0.0 else f"clears the obstacle by {amount}"


def _tags(made: list[Block]) -> tuple[Tag, ...]:
    """The claims in words, by their word."""
    tags = []
    for word in (*VERDICT_WORDS, DEPENDS):
        mine = [block for block in made if block.in_words and block.word == word]
        if mine:
            items = tuple((SHORT_CLAIMS.get(block.key, block.first.text), f"claim-{block.key}") for block in mine)
            tags.append(Tag(f"word word-{WORD_CLASS.get(word, 'not-determined')}", word, items))
    return tuple(tags)


def rests(verdict: "Verdict", made: list[Block]) -> str:
    """How much was flown and drawn, and what became of the printed numbers."""
    flights = sum(part.flights for part in verdict.counted)
    most = {part.part: part.replicates for part in verdict.counted}
    draws = max(0, max((most.get(part, 0) for part in (Part.ROBUSTNESS_SINGLE, Part.ROBUSTNESS_MULTI)), default=0) - 1)
    drawn = [
        f"{n:,} {noun if n == 1 else noun.replace(' of', 's of', 1)}"
        for n, noun in (
            (most.get(Part.TURBULENCE, 0), "seed of turbulence"),
            (most.get(Part.POPULATION, 0), "encounter of the paper's class"),
            (draws, "draw of what it leaves open"),
        )
        if n > 0
    ]
    said = [f"Rests on {flights:,} flights: {words.listed(drawn)}." if drawn else f"Rests on {flights:,} flights."] if flights else []
    numbers = Counter(block.word for block in made if not block.in_words)
    if numbers:
        told = words.listed([f"{n} {word}" for word in (*VERDICT_WORDS, DEPENDS) if (n := numbers[word])])
        said.append(f"Of the {sum(numbers.values())} printed numbers: {told}.")
    return " ".join([*said, *filter(None, (reference.same_as(verdict.claims),))])


def _caption(fall: Waterfall | None) -> str:
    if fall is None:
        return ""
    who = f"{named(AIRCRAFT_NAMES, fall.aircraft or MAIN)}, {named(READING_NAMES, fall.encounter)}, SCOAM"
    return f"What each step costs in least clearance: {who}. Shaded: inside the obstacle."
