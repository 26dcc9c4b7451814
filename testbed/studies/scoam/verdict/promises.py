"""The claims in words that promise something of every flight: safe, flyable, several obstacles avoided, within the overload."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from testbed.results.statistics import finite, spread
from testbed.show.words import listed
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS_ONLY_IF, NOT_DETERMINED, TOO_FEW, Claim
from testbed.studies.scoam.labels import DROAM, MAIN, MULTI, SIDES, SINGLE, Axis, Design, Method, Part, Rung
from testbed.studies.scoam.verdict.ablation import costs, in_turbulence, in_wind, kinematic_cause, most_costly, waterfall
from testbed.studies.scoam.verdict.csv_words import METHOD_WORDS, reading, say
from testbed.studies.scoam.verdict.evidence import Found, Promise, gather
from testbed.studies.scoam.verdict.flights import Flights, Row, clearance, keeps, label, number
from testbed.studies.scoam.verdict.reach import Demand, Reach, demand, limits_of, pose

Figure = Callable[[Row | None], float]

PATH_M = 5.0  # a flight that stays this near follows its path


@dataclass(frozen=True)
class Text:
    """Who says what: the columns of a claim that do not depend on flights."""

    key: str
    where: str
    text: str
    paper: str


SAFE_TEXT = Text("words.single.safe", "Section 5.1", "the re-planned path is safe", "the path is safe and flyable")
FLYABLE_TEXT = Text("words.single.flyable", "Section 5.1", "the re-planned path is flyable", "the path is safe and flyable")
SEVERAL_TEXT = Text(
    "words.multi.safe",
    "Section 5.2",
    "several dynamic threats are avoided",
    "can realize the multiple dynamic threat obstacles avoidance",
)
OVERLOAD_TEXT = Text(
    "words.overload",
    "Section 5.2",
    "dynamic limits such as the overload are met easily",
    "can easily meet the dynamic performance constraint, such as the overload",
)


def safe(flights: Flights, text: Text, encounters: tuple[str, ...]) -> Claim:
    """Every flight keeps every radius."""
    found = gather(flights, Promise(encounters, keeps, keeps, "keep every radius"))
    chain = waterfall(flights, encounters[0], Method.SCOAM, MAIN)
    cause, cost = kinematic_cause(chain)
    if found.ruling.word in (FAILS_WHEN_FLOWN, HOLDS_ONLY_IF):
        cause, cost = most_costly(costs(chain)) if chain else ("", math.nan)
    elif found.ruling.word != FAILS_KINEMATICALLY:
        cause = ""
    return _claim(
        flights, text, encounters[0], found, "least clearance", "m", clearance, cause, _why_safe(flights, encounters, found, cause, cost)
    )


def _why_safe(flights: Flights, encounters: tuple[str, ...], found: Found, cause: str, cost: float) -> str:
    if not found.rails:
        return _reason(found) or "No flight on rails."
    said = [f"On rails {_of(found.rails.values())} re-plans keep every radius ({_by_aircraft(flights, encounters, Rung.KINEMATIC)})."]
    if found.first.word == FAILS_KINEMATICALLY:
        at_once = [clearance(flights.one(Part.CALM, Method.SCOAM, Rung.VO_INSTANT, encounter=e, flown_by=MAIN)) for e in encounters]
        shown = finite(at_once)
        if shown:
            said.append(f"The direction flown at once leaves {listed([say(x, 'm') for x in shown])}.")
        if cause:
            said.append(f"What costs most is the {cause}: {say(cost, 'm')}.")
        said.append(f"Flown as well: {_by_aircraft(flights, encounters, Rung.JSBSIM)}; nothing of it is put down to dynamics.")
    else:
        said.append(f"Flown in calm air {_of(found.calm.values())} do ({_by_aircraft(flights, encounters, Rung.JSBSIM)}){_air(found)}.")
        if cause:
            said.append(f"What costs most is {cause}: {say(cost, 'm')} with {MAIN}.")
        if flights.pick(Part.CALM, Method.SCOAM, Rung.DIRECT, encounter=encounters[0]):
            said.append(f"Told the direction at once, without insertion point: {_by_aircraft(flights, encounters, Rung.DIRECT)}.")
    return " ".join(part for part in (*said, _operational(flights, encounters), *_left_out(found), _reason(found)) if part)


def _operational(flights: Flights, encounters: tuple[str, ...]) -> str:
    """Wind with the obstacle where it is printed: how many are threats at all, and how many of those are kept clear. Counts for no word."""
    rows = [row for e in encounters for row in flights.pick(Part.WIND, Method.SCOAM, Rung.JSBSIM, encounter=e, design=Design.GROUND_FIXED)]
    threats = [row for row in rows if flights.is_threat(row)]
    if not rows:
        return ""
    clear = f"{_of(map(keeps, threats))} keep clear"
    return f"With the obstacle fixed to the ground {len(threats)} of {len(rows)} flights in wind are at a threat, and {clear}."


def flyable(flights: Flights, reach: Reach | None) -> Claim:
    """What the path demands is within the aircraft's limits, the pose is not ruled out, and the flight stays on its path."""

    def rails(row: Row) -> bool | None:
        asked, bound = demand(row), pose(row, reach)
        if asked is None:
            return None
        return asked.within and (bound is None or bound.radius_m >= bound.steepest_radius_m)

    def flown(row: Row) -> bool | None:
        off = number(row, "cross_track_max_m")
        return None if math.isnan(off) else off <= PATH_M

    found = gather(
        flights, Promise(SINGLE, rails, flown, f"stay within {PATH_M:g} m of their path", "ask for no more than the aircraft has")
    )
    nominal = flights.one(Part.CALM, Method.SCOAM, Rung.KINEMATIC, encounter=SINGLE[0], flown_by=MAIN)
    asked = demand(nominal)
    cause = asked.worst if asked and found.ruling.word == FAILS_KINEMATICALLY else ""
    if found.ruling.word in (FAILS_WHEN_FLOWN, HOLDS_ONLY_IF):
        chain = waterfall(flights, SINGLE[0], Method.SCOAM, MAIN)
        cause = most_costly(costs(chain))[0] if chain else ""
    why = " ".join(part for part in (_asks(flights), _bound(nominal, reach), _strays(flights), *_left_out(found), _reason(found)) if part)
    what = "greatest of bank, load factor and roll rate over the aircraft's limit"
    return _claim(flights, FLYABLE_TEXT, SINGLE[0], found, what, "times the limit", _ratio, cause, why)


def _asks(flights: Flights) -> str:
    """What the path asks for and what the aircraft have."""
    said = []
    for row in flights.pick(Part.CALM, Method.SCOAM, Rung.KINEMATIC, encounter=SINGLE[0]):
        limits = limits_of(str(row.get("aircraft")))
        if limits:
            said.append(
                f"{say(number(row, 'max_load_factor'), 'g')}, {number(row, 'max_bank_deg'):.0f} deg of bank and "
                f"{number(row, 'max_roll_rate_dps'):.0f} deg/s of roll ({label(row, Axis.FLOWN_BY)} has {limits.load_factor_max:g} g, "
                f"{limits.bank_deg:g} deg, {limits.roll_rate_dps:g} deg/s)"
            )
    return f"With {reading(SINGLE[0])} the path asks for {listed(said)}." if said else ""


def _strays(flights: Flights) -> str:
    rows = flights.pick(Part.CALM, Method.SCOAM, Rung.JSBSIM, encounter=SINGLE[0])
    off = [f"{say(number(row, 'cross_track_max_m'), 'm')} ({label(row, Axis.FLOWN_BY)})" for row in rows]
    return f"Flown, it is left by up to {listed(off)}; {PATH_M:g} m are allowed." if off else ""


def _bound(row: Row | None, reach: Reach | None) -> str:
    found = pose(row, reach)
    if found is None:
        return ""
    least = f"a level turn of {label(row or {}, Axis.FLOWN_BY)} needs {say(found.level_turn_radius_m, 'm')}"
    return f"The widest curve to the insertion point without a loop has a radius of {say(found.radius_m, 'm')}; {least}."


def overload(flights: Flights) -> Claim:
    """The load factor that the path of section 5.2 demands, and the flown one, are within the aircraft's limits."""

    def within(row: Row) -> bool | None:
        asked = demand(row)
        return None if asked is None else asked.load_factor <= 1.0 and not asked.unloads

    found = gather(flights, Promise(MULTI, within, within, "stay within the limits of load factor"))
    asked = []
    for row in flights.pick(Part.CALM, Method.SCOAM, Rung.KINEMATIC, encounter=MULTI[0]):
        limits = limits_of(str(row.get("aircraft")))
        if limits:
            asked.append(f"{say(number(row, 'max_load_factor'), 'g')} ({label(row, Axis.FLOWN_BY)} has {limits.load_factor_max:g} g)")
    flown = [
        f"{say(number(row, 'max_load_factor'), 'g')} ({label(row, Axis.FLOWN_BY)})"
        for row in flights.pick(Part.CALM, Method.SCOAM, Rung.JSBSIM, encounter=MULTI[0])
    ]
    said = [
        f"With {reading(MULTI[0])} the path on rails asks for {listed(asked)}{_rivals(flights)}." if asked else "",
        f"Flown: {listed(flown)}." if flown else "",
    ]
    cause = "load factor" if found.ruling.word in (FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN) else ""
    why = " ".join(part for part in (*said, *_left_out(found, threats_only=True), _reason(found)) if part)
    return _claim(
        flights, OVERLOAD_TEXT, MULTI[0], found, "largest load factor", "g", lambda row: number(row, "max_load_factor"), cause, why
    )


def _rivals(flights: Flights) -> str:
    """The load factors of both sides of DROAM in the same encounter."""
    said = []
    for method in (side for plane in DROAM for side in SIDES[plane]):
        row = flights.one(Part.CALM, method, Rung.KINEMATIC, encounter=MULTI[0], flown_by=MAIN)
        if row is not None:
            said.append(f"{say(number(row, 'max_load_factor'), 'g')} {METHOD_WORDS[method].removeprefix('DROAM/')}")
    return f"; DROAM with {MAIN} for {listed(said)}" if said else ""


def _ratio(row: Row | None) -> float:
    asked: Demand | None = demand(row)
    return asked.most if asked else math.nan


def _claim(
    flights: Flights, text: Text, encounter: str, found: Found, quantity: str, unit: str, figure: Figure, cause: str, why: str
) -> Claim:
    """The claim with the figures of one encounter flown by one aircraft, and the ruling of all."""
    where = {Axis.ENCOUNTER: encounter, Axis.FLOWN_BY: MAIN}
    at = {rung: flights.one(Part.CALM, Method.SCOAM, rung, **where) for rung in (Rung.KINEMATIC, Rung.POINT_MASS, Rung.JSBSIM)}
    air = [*in_wind(flights, Method.SCOAM, **where), *in_turbulence(flights, Method.SCOAM, **where)]
    effect = found.on_rails if found.first.word == FAILS_KINEMATICALLY else found.evidence.share
    return Claim(
        text.key,
        text.where,
        text.text,
        text.paper,
        unit,
        quantity,
        encounter,
        MAIN,
        figure(at[Rung.KINEMATIC]),
        figure(at[Rung.POINT_MASS]),
        figure(at[Rung.JSBSIM]),
        spread([figure(row) for row in air]),
        found.ruling.word,
        found.ruling.condition,
        effect,
        found.agreement.share,
        found.agreement.n,
        cause,
        why,
    )


def _of(judged: Iterable[bool]) -> str:
    values = list(judged)
    return f"{sum(values)} of {len(values)}"


def _by_aircraft(flights: Flights, encounters: tuple[str, ...], rung: str) -> str:
    """Clearances of the readings for each aircraft."""
    said = []
    for aircraft in flights.values(Part.CALM, Axis.FLOWN_BY):
        rows = [flights.one(Part.CALM, Method.SCOAM, rung, encounter=e, flown_by=aircraft) for e in encounters]
        shown = [say(clearance(row), "m") for row in rows if row is not None]
        if shown:
            said.append(f"{aircraft} {listed(shown)}")
    return "; ".join(said) or "none flown"


def _air(found: Found) -> str:
    said = []
    if found.wind:
        said.append(f"{_of(ok for _, ok in found.wind)} in anchored wind")
    if found.turbulence:
        said.append(f"{_of(ok for _, ok in found.turbulence)} in turbulence")
    return f", {listed(said)}" if said else ""


def _left_out(found: Found, threats_only: bool = False) -> list[str]:
    """What is counted apart, so that nobody takes it for a failure or a success."""
    said = []
    if found.fail_on_rails:
        said.append(f"{found.fail_on_rails} flights in wind fail on rails already and are not counted.")
    if found.no_threat:
        said.append(f"{found.no_threat} flights in wind and turbulence are at no threat without planner and are not counted.")
    if found.marginal and not threats_only:
        said.append(f"{found.marginal} flights are marginal (nearer than 0.15 m to a radius).")
    return said


def _reason(found: Found) -> str:
    reason = found.ruling.reason
    return f"{reason[:1].upper()}{reason[1:]}." if reason and (found.ruling.word in (NOT_DETERMINED, HOLDS_ONLY_IF, TOO_FEW)) else ""


def promises(flights: Flights, reach: Reach | None) -> tuple[Claim, ...]:
    """The four of them, in the order of the paper. Several threats are several only where O_2 is one: its reading upwards."""
    return (safe(flights, SAFE_TEXT, SINGLE), flyable(flights, reach), safe(flights, SEVERAL_TEXT, MULTI[1:]), overload(flights))
