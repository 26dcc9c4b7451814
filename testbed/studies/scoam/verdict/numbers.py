"""The claims in numbers: Tables 2 and 4, each number under each reading of its encounter, and the word that follows from all."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final

from testbed.results.statistics import NAN, Effect, Spread, spread
from testbed.show.words import listed
from testbed.studies.scoam.audit.audit import AuditRow, audit
from testbed.studies.scoam.audit.printed import PRINTED
from testbed.studies.scoam.audit.readings import UNPRINTED, UNREAD
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS, HOLDS_ONLY_IF, NOT_DETERMINED, TOO_FEW, Claim, Word
from testbed.studies.scoam.labels import DRAWN, MAIN, SIDES, Axis, Encounter, Method, Part, Rung
from testbed.studies.scoam.verdict import robustness
from testbed.studies.scoam.verdict.ablation import in_turbulence, in_wind, lesser_side
from testbed.studies.scoam.verdict.csv_words import METHOD_WORDS, percent, reading, say
from testbed.studies.scoam.verdict.flights import Flights, Row, number
from testbed.studies.scoam.verdict.rulings import AS_TAKEN, SHARE, Agreement, agreement, settles, takes

AUDIT_READINGS: Final[Mapping[str, Mapping[str, str]]] = {
    "table2": {Encounter.SINGLE_AS_PRINTED: "as_printed", Encounter.SINGLE_106: "azimuth_106", Encounter.SINGLE_106_10: "direction_106_10"},
    "table4": {Encounter.MULTI_AS_PRINTED: "as_printed", Encounter.MULTI_O2_UP: "o2_elevation_plus"},
}
"""Encounters of a table and the audit's reading that each of them flies."""

AUDIT_METHODS: Final[Mapping[str, str]] = {Method.SCOAM: "scoam", Method.DROAM_HP: "hp", Method.DROAM_VP: "vp"}
AUDIT_QUANTITIES: Final = {"deflection": "deflection", "path_length": "length", "time": "time"}
BESIDE: Final = {"deflection": ("flown_deflection_deg", "peak_deflection_deg"), "time": ("clear_time_s",), "path_length": ()}
QUANTITY_NAMES: Final = {
    "deflection": ("commanded deflection", "deg"),
    "path_length": ("path length from the route's start", "m"),
    "time": ("time from the trigger to the insertion point", "s"),
}
NOT_VARIED: Final = UNREAD | {"common_q"}
"""What the paper leaves open about DROAM and the draws do not vary: a number of DROAM that is missed decides nothing."""

FROM_RESULTS: Final = frozenset({"printed_results", "component_angle"})
"""The audit's readings that compute a result from printed results instead of from the inputs."""


@dataclass(frozen=True)
class Printed:
    """A printed number: which it is, and how far from it a computed one may lie under a reading."""

    table: str
    method: str
    quantity: str

    @property
    def key(self) -> str:
        return f"{self.table}.{self.method}.{self.quantity}"

    @property
    def audit_key(self) -> str:
        return f"t{self.table[-1]}.{AUDIT_METHODS[self.method]}_{AUDIT_QUANTITIES[self.quantity]}"

    @property
    def value(self) -> float:
        return PRINTED[self.audit_key].value

    @property
    def audited(self) -> AuditRow:
        return _audited()[self.audit_key]

    def tolerance(self, encounter: str) -> float:
        """Half a unit in the last printed place plus what the rounding of the inputs changes, by the audit."""
        figure = self.audited.figures[AUDIT_READINGS[self.table][encounter]]
        return PRINTED[self.audit_key].half_ulp + (figure.half_width if math.isfinite(figure.half_width) else 0.0)

    def figure(self, row: Row | None) -> float:
        """The quantity of a flight; a flight that begins late on its route is given the arc before its start."""
        if self.quantity == "path_length":
            return number(row, "path_length_m") + number(row, "begin_s_m") if number(row, "replans") > 0 else NAN
        return number(row, "deflection_deg" if self.quantity == "deflection" else "avoidance_time_s")


@lru_cache(maxsize=1)
def _audited() -> Mapping[str, AuditRow]:
    return {row.key: row for row in audit()}


@dataclass(frozen=True)
class One:
    """A number under one reading, flown by gtm_t2."""

    encounter: str
    side: str  # the method as flown: a side of DROAM
    lesser: bool  # whether it is the side with the lesser deflection
    rails: float
    point: float
    calm: float
    air: Spread
    beside: str
    tolerance: float
    drawn_range: tuple[float, float]  # of the draws on rails
    drawn_n: int
    words: tuple[Word | None, tuple[Word, ...]]

    def meets(self, printed: float) -> bool:
        return abs(self.rails - printed) <= self.tolerance

    @property
    def excludes(self) -> bool:
        """Whether draws of which none comes to the print settle that fewer than 5 % would; without draws nothing speaks against it."""
        return not self.drawn_n or settles(0, self.drawn_n, 1.0 - SHARE) is False

    def met_when_flown(self, printed: float) -> bool:
        return abs(self.calm - printed) <= self.tolerance or self.air.p05 <= printed <= self.air.p95


def numbers(flights: Flights) -> tuple[Claim, ...]:
    """Every printed number: the word that counts, then its readings (keys with ``@``)."""
    out: list[Claim] = []
    for table in AUDIT_READINGS:
        for method in AUDIT_METHODS:
            for quantity in AUDIT_QUANTITIES:
                printed = Printed(table, method, quantity)
                by_reading = [(one, _claim(printed, one)) for e in AUDIT_READINGS[table] for one in [_one(flights, printed, e)]]
                out += [_merged(printed, by_reading), *(claim for _, claim in by_reading)]
    return tuple(out)


def _one(flights: Flights, printed: Printed, encounter: str) -> One:
    """The side of DROAM with the lesser deflection, or the other one where only that meets the print on rails."""
    names = SIDES.get(printed.method, (printed.method,))
    lesser = lesser_side(flights, printed.method, encounter, MAIN) if printed.method in SIDES else printed.method
    every = [_of_side(flights, printed, encounter, name, name == lesser) for name in (lesser, *(n for n in names if n != lesser))]
    return next((one for one in every if one.meets(printed.value)), every[0])


def _of_side(flights: Flights, printed: Printed, encounter: str, name: str, lesser: bool) -> One:
    where = {Axis.ENCOUNTER: encounter, Axis.FLOWN_BY: MAIN}
    calm = {rung: flights.one(Part.CALM, name, rung, **where) for rung in (Rung.KINEMATIC, Rung.POINT_MASS, Rung.JSBSIM)}
    air = [*in_wind(flights, printed.method, **where), *in_turbulence(flights, printed.method, **where)] if lesser else []
    tolerance = printed.tolerance(encounter)
    drawn: list[float] = []
    words: tuple[Word | None, tuple[Word, ...]] = (None, ())
    if encounter in DRAWN and lesser:
        rails, flown = (
            {n: printed.figure(row) for n, row in robustness.replicates(flights, printed.method, rung, encounter).items()}
            for rung in (Rung.KINEMATIC, Rung.JSBSIM)
        )
        drawn = [x for n, x in rails.items() if n != robustness.NOMINAL and math.isfinite(x)]
        nominal, said = robustness.pair_words(
            *({n: _near(x, printed.value, tolerance) for n, x in found.items()} for found in (rails, flown))
        )
        words = (nominal, tuple(said))
    unit = QUANTITY_NAMES[printed.quantity][1]
    beside = [say(number(calm[Rung.JSBSIM], metric), unit) for metric in BESIDE[printed.quantity]]
    return One(
        encounter=encounter,
        side=name,
        lesser=lesser,
        rails=printed.figure(calm[Rung.KINEMATIC]),
        point=printed.figure(calm[Rung.POINT_MASS]),
        calm=printed.figure(calm[Rung.JSBSIM]),
        air=spread(printed.figure(row) for row in air),
        beside=listed(beside),
        tolerance=tolerance,
        drawn_range=(min(drawn), max(drawn)) if drawn else (NAN, NAN),
        drawn_n=len(drawn),
        words=words,
    )


def _near(x: float, printed: float, tolerance: float) -> bool | None:
    return abs(x - printed) <= tolerance if math.isfinite(x) else None


def _word(printed: Printed, one: One) -> tuple[Word, str, Agreement]:
    """The word of a number under one reading, what completes it, and the draws' agreement."""
    value, audited = printed.value, printed.audited
    if not math.isfinite(one.rails):
        return NOT_DETERMINED, "", Agreement()
    if not one.meets(value):
        low, high = one.drawn_range
        half = PRINTED[printed.audit_key].half_ulp
        open_still = NOT_VARIED.intersection(audited.assumptions) or low - half <= value <= high + half
        unknown = math.isnan(low) and UNPRINTED.intersection(audited.assumptions)
        if open_still or unknown:
            return NOT_DETERMINED, "", agreement(NOT_DETERMINED, *one.words)
        return FAILS_KINEMATICALLY if one.excludes else TOO_FEW, "", agreement(FAILS_KINEMATICALLY, *one.words)
    if not math.isfinite(one.calm):
        return NOT_DETERMINED, "", agreement(NOT_DETERMINED, *one.words)
    if not one.met_when_flown(value):
        return FAILS_WHEN_FLOWN, "", agreement(FAILS_WHEN_FLOWN, *one.words)
    agree = agreement(HOLDS, *one.words)
    conditions = (
        [] if AUDIT_READINGS[printed.table][one.encounter] == "as_printed" else [f"the encounter is that of {reading(one.encounter)}"]
    )
    conditions += [] if one.lesser else ["DROAM takes the side with the greater deflection"]
    if UNPRINTED.intersection(audited.assumptions) or not (agree.n and agree.share >= SHARE):
        conditions.append(AS_TAKEN)
    return (HOLDS_ONLY_IF, ", ".join(conditions), agree) if conditions else (HOLDS, "", agree)


def _claim(printed: Printed, one: One) -> Claim:
    word, condition, agree = _word(printed, one)
    what, unit = QUANTITY_NAMES[printed.quantity]
    return Claim(
        f"{printed.key}@{one.encounter}",
        f"Table {printed.table[-1]}",
        f"{METHOD_WORDS[printed.method]} {printed.quantity.replace('_', ' ')}",
        PRINTED[printed.audit_key].text,
        unit,
        what,
        one.encounter,
        MAIN,
        one.rails,
        one.point,
        one.calm,
        one.air,
        word,
        condition,
        Effect(
            "figure on rails minus the print, and what rounding allows",
            unit,
            one.rails - printed.value,
            one.rails - printed.value - one.tolerance,
            one.rails - printed.value + one.tolerance,
            int(math.isfinite(one.rails)),
        ),
        agree.share,
        agree.n,
        "",
        _why(printed, one, word),
    )


def _why(printed: Printed, one: One, word: Word) -> str:
    unit = QUANTITY_NAMES[printed.quantity][1]
    if not math.isfinite(one.rails):
        return f"With {reading(one.encounter)} no re-plan was flown on rails, so there is no such number."
    side = "" if printed.method == Method.SCOAM else f" ({METHOD_WORDS[one.side]})"
    text = PRINTED[printed.audit_key].text
    said = [
        f"With {reading(one.encounter)} the flight on rails has {say(one.rails, unit)}{side} against {text} printed; "
        f"{say(one.tolerance, unit)} may be rounding."
    ]
    if printed.quantity == "deflection":
        said.append(
            f"In calm air an aircraft is told {say(one.calm, unit)}; at the insertion point, and at most, it has turned by {one.beside}."
        )
    elif printed.quantity == "time":
        said.append(f"Flown in calm air {say(one.calm, unit)}; {one.beside} until clear.")
    else:
        said.append(f"Flown in calm air {say(one.calm, unit)}.")
    audited = printed.audited.figures[AUDIT_READINGS[printed.table][one.encounter]]
    if math.isfinite(audited.value) and abs(audited.value - one.rails) > one.tolerance:
        said.append(f"The paper's own equations, with the choices the audit names, give {say(audited.value, unit)}.")
    if not one.meets(printed.value) and FROM_RESULTS.intersection(printed.audited.met_by):
        said.append("It does follow from other results that the paper prints, which its inputs do not give.")
    if word == NOT_DETERMINED:
        said.append(_undecided(printed, one))
    if word == TOO_FEW:
        n = one.drawn_n
        said.append(f"None of {n} draws comes to the print, which does not settle whether 5 % would: it takes {takes(0, n, 1.0 - SHARE)}.")
    return " ".join(said)


def _undecided(printed: Printed, one: One) -> str:
    if not math.isfinite(one.calm) and one.meets(printed.value):
        return "It was not flown by an aircraft."
    if NOT_VARIED.intersection(printed.audited.assumptions):
        return "The paper cites DROAM without its insertion point or its formula: a number that differs decides nothing."
    if math.isnan(one.drawn_range[0]):
        return "It depends on PH end derivatives that the paper does not print, and they were not varied."
    low, high = (say(x, QUANTITY_NAMES[printed.quantity][1]) for x in one.drawn_range)
    return f"Varying what is not printed gives {low} to {high}, which holds the print."


ORDER: Final = (HOLDS, HOLDS_ONLY_IF, FAILS_WHEN_FLOWN, NOT_DETERMINED, TOO_FEW, FAILS_KINEMATICALLY)


def _merged(printed: Printed, readings: list[tuple[One, Claim]]) -> Claim:
    """The reading that is kindest to the paper, of those with a number: the first in ``ORDER``, then in ``AUDIT_READINGS``."""
    told = [(one, claim) for one, claim in readings if math.isfinite(one.rails)]
    if not told:
        _, claim = readings[-1]
        return replace(claim, key=printed.key, reading="", why="No re-plan was flown on rails under any reading.")
    _, claim = min(told, key=lambda both: ORDER.index(both[1].word))
    others = [f"{reading(o.encounter)}: {c.word}" for o, c in told if c is not claim]
    beside = f" Other readings: {'; '.join(others)}." if others else ""
    share = f" {percent(claim.robustness_share)} of {claim.robustness_n} draws say the same." if claim.robustness_n else ""
    return replace(claim, key=printed.key, why=claim.why + share + beside)
