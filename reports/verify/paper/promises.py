"""Claims that a path keeps a promise: safe, flyable, within the load."""

from collections.abc import Sequence

from .flights import MULTI, SINGLE, Flight, Flights, Test, cell_of, keeps_radius, label, number
from .intervals import share_bounds
from .rungs import on_rungs
from .sources import limits_of
from .words import ENOUGH, FEW, FLOWN, HOLDS, ON_RAILS, ONLY_IF, OPEN, Judged, draw_words, settled


def lift_within(row: Flight) -> bool:
    """The load factor stays within the aircraft's limits, both ways."""
    limits = limits_of(str(row["aircraft"]))
    return number(row, "max_load_factor") <= limits["load_factor_max"] and number(row, "min_load_factor") >= limits["load_factor_min"]


def demand_within(row: Flight) -> bool:
    """Bank, load factor and roll rate that a path demands are within the limits."""
    limits = limits_of(str(row["aircraft"]))
    turns = number(row, "max_bank_deg") <= limits["bank_deg"] and number(row, "max_roll_rate_dps") <= limits["roll_rate_dps"]
    return turns and lift_within(row)


PROMISES: dict[str, tuple[tuple[str, ...], Test, Test]] = {
    "words.single.safe": (SINGLE, keeps_radius, keeps_radius),
    "words.single.flyable": (SINGLE, demand_within, lambda row: number(row, "cross_track_max_m") <= 5.0),
    "words.multi.safe": (MULTI, keeps_radius, keeps_radius),
    "words.overload": (("multi_as_printed", "multi_o2_up"), lift_within, lift_within),
}


def judge_promise(flights: Flights, key: str) -> Judged:
    """Rails first, then calm air, then air."""
    encounters, on_rails, flown = PROMISES[key]
    calm = flights.pick(part="calm", method="scoam", encounter=encounters, rung=("kinematic", "jsbsim"))
    calm = [row for row in calm if flights.is_threat(row)]
    rails = {cell_of(row): on_rails(row) for row in calm if label(row, "rung") == "kinematic"}
    passed = {cell for cell, good in rails.items() if good}
    still = [flown(row) for row in calm if label(row, "rung") == "jsbsim" and cell_of(row) in passed]
    windy = flights.pick(part="wind", design="anchored", method="scoam", encounter=encounters, rung="jsbsim")
    windy += flights.pick(part="turbulence", method="scoam", encounter=encounters, rung="jsbsim")
    air = [flown(row) for row in windy if cell_of(row) in passed and flights.is_threat(row) and not flights.partner_fails(row)]
    word = promise_word(list(rails.values()), still, air)
    told = list(rails.values()) if word == ON_RAILS else [*still, *air]
    share = {"effect": sum(told) / len(told), "effect_n": len(told)} if told else {}
    share |= dict(zip(("effect_low", "effect_high"), share_bounds(sum(told), len(told)), strict=True)) if told else {}
    if on_rails is keeps_radius:
        where = {"encounter": encounters[0], "flown_by": "gtm_t2", "method": "scoam"}
        share |= on_rungs(flights, lambda row: number(row, "least_clearance_m"), **where)
    judged = settled(word, draw_words(flights.draws(encounters[-1] if key == "words.overload" else encounters[0]), on_rails, flown))
    return Judged(judged.word, {**share, **judged.columns})


def promise_word(rails: Sequence[bool], still: Sequence[bool], air: Sequence[bool]) -> str:
    """The word of what keeps the promise on rails, then in calm air, then in moving air."""
    for flown, failure in ((rails, ON_RAILS), (still, FLOWN)):
        if not flown:
            return OPEN
        if not any(flown):
            return failure
    if not all(rails) or not all(still) or not air:
        return ONLY_IF
    together = [*still, *air]
    if share_bounds(sum(together), len(together))[0] >= ENOUGH:
        return HOLDS
    return FEW if all(air) else ONLY_IF
