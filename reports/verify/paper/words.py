"""The five words, the one that withholds them, and what draws of what the paper leaves open do to them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from .flights import Draws, Test
from .intervals import settled_at

HOLDS, ONLY_IF, ON_RAILS, FLOWN, OPEN = "holds", "holds only if", "fails kinematically", "fails when flown", "not determined"
FEW = "too few to say"
KINDEST = (HOLDS, ONLY_IF, FLOWN, OPEN, FEW, ON_RAILS)  # of the readings of a number
ENOUGH = 0.95  # a share that stands for all


@dataclass(frozen=True)
class Judged:
    """A word, and columns of ``verdict.csv`` that follow with it."""

    word: str
    columns: Mapping[str, float]


def draw_words(draws: Draws, on_rails: Test, flown: Test) -> dict[int, str]:
    """The word of each draw that has both flights."""
    both = {n: (pair["kinematic"][0], pair["jsbsim"][0]) for n, pair in draws.items() if len(pair) == 2}
    return {n: ON_RAILS if not on_rails(rails) else HOLDS if flown(air) else FLOWN for n, (rails, air) in both.items()}


def agreeing(word: str, said: Mapping[int, str]) -> tuple[float, int]:
    """Share of the draws that say the same as a word (or as the nominal pair, for a word that no pair can say), and how many there are."""
    drawn = [one for n, one in said.items() if n]
    meant = said.get(0) if word in (ONLY_IF, OPEN) else word
    return (drawn.count(meant) / len(drawn) if drawn and meant else math.nan), len(drawn)


def settled(word: str, said: Mapping[int, str]) -> Judged:
    """A word after the rules on robustness."""
    share, n = agreeing(word, said)
    after = word
    if word == HOLDS and not n:
        after = OPEN
    elif word in (HOLDS, ON_RAILS, FLOWN) and n:
        shown = settled_at(round(share * n), n, ENOUGH if word == HOLDS else 0.5)
        after = {None: FEW, True: word, False: ONLY_IF if word == HOLDS else OPEN}[shown]
    return Judged(after, {"robustness_share": share, "robustness_n": n})
