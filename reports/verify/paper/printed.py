"""Numbers that the paper prints, under each reading of its tables."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ..run import figure_of, read_csv
from .flights import SIDES, Draws, Figure, Flights, label, number, replanned, route_length
from .intervals import settled_at
from .rungs import in_air, on_rungs
from .sources import AUDIT
from .words import ENOUGH, FEW, FLOWN, HOLDS, KINDEST, ON_RAILS, ONLY_IF, OPEN, Judged, agreeing, draw_words

READINGS = {  # table -> encounter -> column of the audit
    "table2": {"single_as_printed": "as_printed", "single_106": "azimuth_106", "single_106_10": "direction_106_10"},
    "table4": {"multi_as_printed": "as_printed", "multi_o2_up": "o2_elevation_plus"},
}
DRAWN_FOR = {"table2": "single_106", "table4": "multi_o2_up"}
METHODS = {"scoam": "SCOAM", "droam_hp": "DROAM/HP", "droam_vp": "DROAM/VP"}
QUANTITIES: dict[str, tuple[str, Figure]] = {
    "deflection": ("deflection", lambda row: replanned(row, number(row, "deflection_deg"))),
    "path_length": ("path length", lambda row: replanned(row, route_length(row))),
    "time": ("avoidance time", lambda row: replanned(row, number(row, "avoidance_time_s"))),
}
PH_BOUNDARIES, DROAM_OPEN = {"ph_magnitudes", "route_tangents"}, {"droam", "common_q"}


@dataclass(frozen=True)
class Print:
    """A printed number under one reading: what is printed, half a unit of it, and what rounding of the inputs adds."""

    table: str
    method: str
    encounter: str
    figure: Figure
    value: float
    half_unit: float
    tolerance: float
    assumes: frozenset[str]

    def meets(self, value: float) -> bool:
        """Within the tolerance, and that there is a figure."""
        return abs(value - self.value) <= self.tolerance


def printed(key: str, encounter: str) -> Print:
    """What the audit says of a number."""
    which, method, quantity = key.split(".")
    name, figure = QUANTITIES[quantity]
    rows = read_csv(AUDIT)
    row = next(one for one in rows if one["where"] == f"Table {which[-1]}" and one["quantity"] == f"{METHODS[method]} {name}")
    half_unit, more = float(row["tolerance"]), figure_of(row[f"{READINGS[which][encounter]}_pm"])
    tolerance = half_unit + (0.0 if math.isnan(more) else more)
    assumes = frozenset(row["assumptions"].split("; "))
    return Print(which, method, encounter, figure, float(row["printed"]), half_unit, tolerance, assumes)


def judge_reading(flights: Flights, one: Print) -> Judged:
    """One number under one reading."""
    sides = SIDES.get(one.method, (one.method,))
    where = {"encounter": one.encounter, "flown_by": "gtm_t2"}
    rails = [row for row in flights.pick(part="calm", rung="kinematic", method=sides, **where) if not math.isnan(one.figure(row))]
    if not rails:
        return Judged(OPEN, {"kinematic": math.nan})
    rails.sort(key=lambda row: number(row, "deflection_deg"))
    row = next((side for side in rails if one.meets(one.figure(side))), rails[0])
    calm = on_rungs(flights, one.figure, method=label(row, "method"), **where)
    if row is rails[0]:  # in moving air the lesser side alone is flown, under the method's own name
        calm |= in_air(flights, one.figure, method=one.method, **where)
    gap = calm["kinematic"] - one.value
    columns = {**calm, "effect": gap, "effect_low": gap - one.tolerance, "effect_high": gap + one.tolerance}
    # draws are of one encounter of each table and of the lesser side; the other readings and sides have none
    drawn = one.encounter == DRAWN_FOR[one.table] and row is rails[0]
    draws = flights.draws(one.encounter, one.method) if drawn else {}
    said = draw_words(draws, lambda flight: one.meets(one.figure(flight)), lambda flight: one.meets(one.figure(flight)))
    word = _number_word(one, calm, draws, said, row is not rails[0])
    meant = {ONLY_IF: HOLDS, FEW: ON_RAILS}.get(word, word)  # a number that is met; one that is missed by draws that are too few
    share, n = agreeing(meant, said)
    return Judged(word, {**columns, "robustness_share": share, "robustness_n": n})


def _number_word(one: Print, calm: Mapping[str, float], draws: Draws, said: Mapping[int, str], other_side: bool) -> str:
    if not one.meets(calm["kinematic"]):
        on_rails = [one.figure(pair["kinematic"][0]) for n, pair in draws.items() if n and "kinematic" in pair]
        range_of = [value for value in on_rails if not math.isnan(value)]
        reached = bool(range_of) and min(range_of) - one.half_unit <= one.value <= max(range_of) + one.half_unit
        unprinted = not range_of and PH_BOUNDARIES & one.assumes
        if DROAM_OPEN & one.assumes or reached or unprinted:
            return OPEN
        return FEW if range_of and settled_at(0, len(range_of), 1.0 - ENOUGH) is None else ON_RAILS
    if math.isnan(calm["flown_calm"]):
        return OPEN
    if not one.meets(calm["flown_calm"]) and not calm["flown_air_p05"] <= one.value <= calm["flown_air_p95"]:
        return FLOWN
    share, n = agreeing(HOLDS, said)
    conditions = not one.encounter.endswith("as_printed") or other_side or PH_BOUNDARIES & one.assumes or (n and share < ENOUGH)
    return ONLY_IF if conditions else HOLDS


def judge_number(flights: Flights, key: str) -> Judged:
    """A number under a reading (``@encounter``), or the kindest word of all its readings."""
    name, _, encounter = key.partition("@")
    if encounter:
        return judge_reading(flights, printed(name, encounter))
    each = [judge_reading(flights, printed(name, one)) for one in READINGS[name.split(".")[0]]]
    figured = [one for one in each if not math.isnan(one.columns["kinematic"])]
    return min(figured, key=lambda one: KINDEST.index(one.word)) if figured else each[0]
