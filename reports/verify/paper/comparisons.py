"""Claims that SCOAM is the least of its field."""

import math
from collections.abc import Sequence

from .flights import DRAWN, DROAM, SINGLE, Figure, Flight, Flights, label, number, route_length
from .intervals import LEAST_PAIRS, median_bounds, settled_at
from .words import ENOUGH, FEW, FLOWN, HOLDS, ON_RAILS, ONLY_IF, OPEN, Judged, settled

COMPARED: dict[str, tuple[Figure, Figure, float]] = {  # figure on rails, figure flown, margin
    "words.deflection_least": (lambda row: number(row, "deflection_deg"), lambda row: number(row, "flown_deflection_deg"), 0.05),
    "words.path_shortest": (route_length, route_length, 0.05),
    "words.time_least": (lambda row: number(row, "avoidance_time_s"), lambda row: number(row, "avoidance_time_s"), 0.01),
}


def gains(flights: Flights, rivals: Sequence[str], figure: Figure, **where: str | tuple[str, ...]) -> list[float]:
    """Best rival's figure minus SCOAM's for each encounter at a threat that has both."""
    best: dict[tuple[str, ...], dict[bool, float]] = {}
    for row in flights.pick(method=("scoam", *rivals), **where):
        value = figure(row)
        if not math.isnan(value) and flights.is_threat(row):
            ours = best.setdefault(Flights.place(row), {})
            mine = label(row, "method") == "scoam"
            ours[mine] = min(value, ours.get(mine, math.inf))
    return [pair[False] - pair[True] for pair in best.values() if len(pair) == 2]


def stand(differences: Sequence[float], margin: float) -> str:
    """Worse, open, better, typical, or one of the last two."""
    _, low, high = median_bounds(differences)
    if len(differences) < LEAST_PAIRS:
        return "open"
    if high < -margin:
        return "worse"
    if low < -margin:
        return "open"
    kept = sum(d >= -margin for d in differences)
    return {True: "better", False: "typical", None: "unsettled"}[settled_at(kept, len(differences), ENOUGH)]


def judge_comparison(flights: Flights, key: str) -> Judged:
    """Against the paper's rivals, and then against the wider field."""
    on_rails, flown, margin = COMPARED[key]
    narrow, wide = (_field_word(flights, key, rivals) for rivals in (DROAM, (*DROAM, "least_deflection")))
    word = ONLY_IF if narrow in (HOLDS, ONLY_IF) and wide not in (narrow, FEW) else narrow
    if narrow == HOLDS and wide == FEW:
        word = FEW
    here = {"part": "calm", "encounter": "single_106", "flown_by": "gtm_t2"}
    calm = {
        column: next(iter(gains(flights, DROAM, figure, rung=rung, **here)), math.nan)
        for column, rung, figure in (("kinematic", "kinematic", on_rails), ("flown_calm", "jsbsim", flown))
    }
    said = {}
    for n, pair in drawn_pairs(flights, on_rails, flown).items():
        said[n] = ON_RAILS if pair[0] < -margin else HOLDS if pair[1] >= -margin else FLOWN
    judged = settled(word, said)
    return Judged(judged.word, {**calm, **judged.columns})


def drawn_pairs(flights: Flights, on_rails: Figure, flown: Figure, encounter: str = "single_106") -> dict[int, tuple[float, float]]:
    """What SCOAM gains on DROAM in each draw, on rails and flown, of the draws that have both."""
    by_draw: dict[int, list[Flight]] = {}
    for row in flights.pick(part=DRAWN, encounter=encounter, flown_by="gtm_t2"):
        by_draw.setdefault(int(row["replicate"]), []).append(row)
    found = {}
    for n, rows in by_draw.items():
        only = Flights(rows)
        pair = [gains(only, DROAM, figure, rung=rung) for rung, figure in (("kinematic", on_rails), ("jsbsim", flown))]
        if all(pair):
            found[n] = (pair[0][0], pair[1][0])
    return found


def _field_word(flights: Flights, key: str, rivals: Sequence[str]) -> str:
    on_rails, flown, margin = COMPARED[key]
    rails, air = (
        gains(flights, rivals, figure, part="population", rung=rung) for rung, figure in (("kinematic", on_rails), ("jsbsim", flown))
    )
    if len(rails) < LEAST_PAIRS:
        two = gains(flights, rivals, on_rails, part="calm", encounter=SINGLE, rung="kinematic", flown_by="gtm_t2")
        refuted = len(two) == 2 and max(two) < -margin and drawn_pairs(flights, on_rails, flown)
        return ON_RAILS if refuted else OPEN
    first, second = stand(rails, margin), stand(air, margin)
    for pairs, found, failure in ((rails, first, ON_RAILS), (air, second, FLOWN)):
        if found == "worse":
            return failure
        if found == "open":
            return FEW if pairs else OPEN
    if "typical" in (first, second):
        return ONLY_IF
    return FEW if "unsettled" in (first, second) else HOLDS
