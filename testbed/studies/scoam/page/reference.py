"""The words of the committed run on the paper (``make paper-full``), beside which a quicker run is read."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from markupsafe import Markup

from testbed.core.catalogue import DATA
from testbed.show import words
from testbed.studies.scoam.claim import TOO_FEW, Claim

PACKED, COMMITTED = DATA / "reference" / "verdict.csv", DATA.parents[1] / "reports" / "paper" / "verdict.csv"
MOST_NAMED = 6


@dataclass(frozen=True)
class Size:
    """What a verdict rests on: draws, pairs of the population, flights in moving air."""

    draws: int
    pairs: int
    in_air: int

    def __str__(self) -> str:
        return f"{words.counted(self.draws, 'draw')}, {self.pairs:,} pairs of encounters and {self.in_air:,} flights in wind and turbulence"


@dataclass(frozen=True)
class Reference:
    """Words by the key of their claim."""

    words: Mapping[str, str]
    size: Size


@cache
def reference() -> Reference | None:
    """In a wheel beside the code, in the repository where it is committed; None where it is neither."""
    path = next((file for file in (PACKED, COMMITTED) if file.is_file()), None)
    if path is None:
        return None
    with path.open(newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    told = {line["key"]: line["word"] for line in lines}
    counts = [(line["key"], int(line["robustness_n"] or 0), int(line["effect_n"] or 0), int(line["flown_air_n"] or 0)) for line in lines]
    return Reference(told, _size(counts))


PAIRED = ("words.deflection_least", "words.path_shortest", "words.time_least", "words.superior")
"""Claims whose effect is of pairs of encounters."""


def size_of(claims: Sequence[Claim]) -> Size:
    """Of a verdict that is at hand."""
    return _size([(claim.key, claim.robustness_n, claim.effect.n, claim.flown_air.n) for claim in claims])


def _size(counts: Sequence[tuple[str, int, int, int]]) -> Size:
    return Size(
        max((n for _, n, _, _ in counts), default=0),
        max((n for key, _, n, _ in counts if key in PAIRED), default=0),
        max((n for _, _, _, n in counts), default=0),
    )


def other_word(claim: Claim) -> str:
    """The word that the reference has where it is another one; empty where it is the same, or there is none."""
    beside = reference()
    word = beside.words.get(claim.key, "") if beside else ""
    return word if word != claim.word else ""


def note(claims: Sequence[Claim]) -> Markup:
    """What a reader of a quick run must know of it: how many words are other ones, and which. Empty where all are the same."""
    beside = reference()
    known = [claim for claim in claims if beside and claim.key in beside.words]
    others = [claim for claim in known if other_word(claim)]
    if beside is None or not others:
        return Markup()
    silent = [claim for claim in others if claim.word == TOO_FEW]
    loud = [claim for claim in others if claim.word != TOO_FEW]
    parts = [f"{len(silent)} {'is' if len(silent) == 1 else 'are'} withheld here, for want of flights or draws"] if silent else []
    if loud:
        leading = [f"{claim.where}, {claim.text}" for claim in loud if "@" not in claim.key]
        named = "; ".join(leading[:MOST_NAMED]) or "single readings"
        more = " and others" if len(leading) > MOST_NAMED else ""
        parts.append(f"{len(loud)} {'says' if len(loud) == 1 else 'say'} something else: {named}{more}")
    return Markup(
        "<b>{} of {} words differ from the committed reference.</b> {}. It rests on {}; this run on {}. Both words are in the table."
    ).format(len(others), len(known), words.capital("; ".join(parts)), beside.size, size_of(claims))


def same_as(claims: Sequence[Claim]) -> str:
    """The sentence for a run whose words are all those of the reference."""
    beside = reference()
    known = [claim for claim in claims if beside and claim.key in beside.words]
    return f"All {len(known)} words are those of the committed reference." if known and not any(map(other_word, known)) else ""
