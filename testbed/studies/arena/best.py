"""The best lead of a method, chosen on one half of the encounters and scored on the other.

Who is scored at the lead that did best in the same flights is flattered by chance, the more the more leads there are. So the encounters
are halved by their number, even and odd: the best lead of the odd ones is scored on the even ones, and the other way round. Each encounter
is scored once. Of leads that are as good the longest is taken.
"""

from collections.abc import Sequence
from typing import NamedTuple

from testbed.studies.arena.flights import Flight


class Best(NamedTuple):
    """The flights at a method's own best lead, one for each encounter, and the leads (s) at which the even and the odd ones are scored."""

    flights: list[Flight]
    even_s: float
    odd_s: float


def best(flights: Sequence[Flight]) -> Best:
    """Of the flights of one method in one place, at all leads. With one half alone it is chosen and scored there."""
    halves = [[one for one in flights if one.encounter.replicate % 2 == half] for half in (0, 1)]
    even_s, odd_s = (best_lead(chooses or scored) for scored, chooses in (halves, halves[::-1]))
    return Best([one for one in flights if one.lead_s == (odd_s if one.encounter.replicate % 2 else even_s)], even_s, odd_s)


def best_lead(flights: Sequence[Flight]) -> float:
    """The lead with the largest share of flights that kept every radius; of several the longest."""

    def share(lead_s: float) -> float:
        kept = [one.kept for one in flights if one.lead_s == lead_s]
        return sum(kept) / len(kept)

    return max(sorted({one.lead_s for one in flights}, reverse=True), key=share)
