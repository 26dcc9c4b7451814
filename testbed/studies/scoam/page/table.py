"""The table that leads the page: every claim and every printed number of the paper, and what became of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from testbed.show import words
from testbed.show.words import named
from testbed.studies.scoam.claim import HOLDS_ONLY_IF, Claim
from testbed.studies.scoam.page import bars, paper_names, reference
from testbed.studies.scoam.page.paper_names import AIRCRAFT_NAMES, READING_NAMES

IN_WORDS = "words"
DEPENDS = "depends on the reading"
SHORT = 7  # letters of a unit that fits beside every number


@dataclass(frozen=True)
class Block:
    """One claim or printed number: what is said of it, and the readings of the paper behind that (their keys end in ``@reading``)."""

    key: str
    told: tuple[Claim, ...]
    readings: tuple[Claim, ...]

    @property
    def first(self) -> Claim:
        return self.told[0]

    @property
    def in_words(self) -> bool:
        return self.key.split(".")[0] == IN_WORDS

    @property
    def word(self) -> str:
        """The word that it has, whichever way the paper is read and whoever flies."""
        words = {claim.word for claim in self.told}
        return words.pop() if len(words) == 1 else DEPENDS


def blocks(claims: Sequence[Claim]) -> list[Block]:
    """The claims by key: those in words first, then the tables in order."""
    by_key: dict[str, list[Claim]] = {}
    for claim in claims:
        by_key.setdefault(claim.key.partition("@")[0], []).append(claim)
    made = []
    for key, same in by_key.items():
        told = tuple(claim for claim in same if "@" not in claim.key)
        made.append(Block(key, told or tuple(same), tuple(claim for claim in same if told and "@" in claim.key)))
    tables = sorted({block.first.where for block in made if not block.in_words})
    return sorted(made, key=lambda block: -1 if block.in_words else tables.index(block.first.where))


def groups(claims: Sequence[Claim]) -> list[dict[str, Any]]:
    """Headings with the blocks under them, as the template wants them."""
    made: list[dict[str, Any]] = []
    for block in blocks(claims):
        title = "Claims in words" if block.in_words else f"Numbers of {block.first.where}"
        if not made or made[-1]["title"] != title:
            made.append({"title": title, "blocks": []})
        made[-1]["blocks"].append(_block(block))
    return made


def _block(block: Block) -> dict[str, Any]:
    several_aircraft = len({claim.aircraft for claim in (*block.told, *block.readings)}) > 1
    said = {(claim.reading, claim.word) for claim in block.told}
    others = [claim for claim in block.readings if (claim.reading, claim.word) not in said]
    rows = [_row(claim, several_aircraft) for claim in block.told] + [_row(claim, several_aircraft) | {"lesser": True} for claim in others]
    return {
        "where": block.first.where if block.in_words else "",
        "text": block.first.text,
        "quote": block.first.paper if block.in_words else "",
        "place": f"claim-{block.key}",
        "picture": bars.claim_svg(block.first),
        "rows": rows,
        "opens": any(row["why"] or row["effect"] for row in rows),
    }


def _row(claim: Claim, name_aircraft: bool) -> dict[str, Any]:
    digits = max(paper_names.decimals(claim.paper), words.UNIT_DIGITS.get(claim.unit, 2))
    values = (claim.kinematic, claim.point_mass, claim.flown_calm)
    air = claim.flown_air
    unit = claim.unit if len(words.SHOWN_UNITS.get(claim.unit, claim.unit)) <= SHORT else ""  # a long one stands beside the quantity
    under = (named(READING_NAMES, claim.reading), named(AIRCRAFT_NAMES, claim.aircraft) if name_aircraft and claim.aircraft else "")
    printed = "" if claim.key.startswith(IN_WORDS) else claim.paper
    return {
        "lesser": False,
        "reading": ", ".join(part for part in under if part),
        "quantity": ", ".join(part for part in (claim.quantity, claim.unit if not unit else "") if part),
        "paper": f"{printed} {_unit(claim.unit)}".rstrip() if printed else "",
        "cells": [words.amount(value, unit, digits) for value in values],
        "air": paper_names.spread(air, unit, digits),
        "air_note": f"median {words.amount(air.median, unit, digits)}, n = {air.n}" if air.n and math.isfinite(air.median) else "",
        "word": claim.word,
        "other": reference.other_word(claim),
        "word_class": paper_names.WORD_CLASS[claim.word],
        "condition": paper_names.typeset(claim.condition).rstrip(".") if claim.word == HOLDS_ONLY_IF else "",
        "limit": claim.deciding_limit,
        "robustness": paper_names.robustness(claim.robustness_share, claim.robustness_n),
        "why": paper_names.typeset(claim.why),
        "effect": paper_names.effect(claim.effect),
    }


def _unit(unit: str) -> str:
    return "" if unit == "share" else unit
