"""The flights behind a promise: on rails, flown in calm air, flown in wind and turbulence, and where it is kept."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from testbed.results.statistics import Effect, share
from testbed.show.words import listed
from testbed.studies.scoam.labels import DRAWN, MAIN, Axis, Design, Method, Part, Rung, Severity
from testbed.studies.scoam.verdict.ablation import in_turbulence, in_wind
from testbed.studies.scoam.verdict.csv_words import reading
from testbed.studies.scoam.verdict.flights import Flights, Row, label, marginal
from testbed.studies.scoam.verdict.robustness import Test, method_words
from testbed.studies.scoam.verdict.rulings import Agreement, PromiseEvidence, Ruling, agreement, promise, robust

SEVERITIES: Final = tuple(Severity)
Cell = tuple[str, str]  # encounter, aircraft


@dataclass(frozen=True)
class Promise:
    """What is promised for every flight of SCOAM, as two tests: of a flight on rails and of a flown one."""

    encounters: tuple[str, ...]
    rails: Test
    flown: Test
    passed: str  # "keep every radius", of flown flights
    passed_on_rails: str = ""  # where that is another thing


@dataclass(frozen=True)
class Found:
    """The flights of a promise, and its ruling."""

    rails: dict[Cell, bool]
    calm: dict[Cell, bool]
    wind: tuple[tuple[Row, bool], ...]
    turbulence: tuple[tuple[Row, bool], ...]
    fail_on_rails: int  # flights in wind whose partner on rails fails already: in neither of the two above
    no_threat: int  # flights in anchored wind and turbulence in which no planner is needed
    marginal: int
    evidence: PromiseEvidence
    on_rails: Effect
    first: Ruling  # before the draws
    ruling: Ruling
    agreement: Agreement


def gather(flights: Flights, it: Promise) -> Found:
    """Everything that a promise rests on."""
    rails = _cells(flights, it, Rung.KINEMATIC, it.rails)
    kept = [cell for cell, ok in rails.items() if ok]
    every = _cells(flights, it, Rung.JSBSIM, it.flown)
    calm = {cell: ok for cell, ok in every.items() if cell in kept}
    wind, failing = _in_air(flights, it, kept, in_wind)
    turbulence, _ = _in_air(flights, it, kept, in_turbulence)
    air = (*wind, *turbulence)
    flown = (*calm.values(), *(ok for _, ok in air))
    evidence = PromiseEvidence(
        tuple(rails.values()),
        tuple(calm.values()),
        tuple(ok for _, ok in air),
        share(f"flown flights that {it.passed}", sum(flown), len(flown)),
        conditions(rails, calm, wind, turbulence),
    )
    on_rails = share(f"flights on rails that {it.passed_on_rails or it.passed}", sum(rails.values()), len(rails))
    ruling = promise(evidence)
    drawn = next((e for e in DRAWN if e in it.encounters), "")
    nominal, words = method_words(flights, drawn, it.rails, it.flown)
    agree = agreement(ruling.word, nominal, words)
    rows = [row for e in it.encounters for row in _flown_rows(flights, e)]
    return Found(
        rails,
        calm,
        wind,
        turbulence,
        failing,
        sum(label(row, Axis.PART) != Part.CALM and not flights.is_threat(row) for row in rows),
        sum(marginal(row) for row in rows),
        evidence,
        on_rails,
        ruling,
        robust(ruling, agree),
        agree,
    )


def _cells(flights: Flights, it: Promise, rung: str, test: Test) -> dict[Cell, bool]:
    """Calm flights of SCOAM at threats, by encounter and aircraft, judged by the test."""
    out = {}
    for encounter in it.encounters:
        for row in flights.pick(Part.CALM, Method.SCOAM, rung, encounter=encounter):
            if flights.is_threat(row) and (ok := test(row)) is not None:
                out[(encounter, label(row, Axis.FLOWN_BY))] = ok
    return out


def _in_air(
    flights: Flights, it: Promise, kept: Sequence[Cell], rows_of: Callable[..., list[Row]]
) -> tuple[tuple[tuple[Row, bool], ...], int]:
    """Flights in air of the cells that pass on rails, judged; and how many are left out because the point on rails fails in that air."""
    judged, failing = [], 0
    for encounter, aircraft in kept:
        for row in rows_of(flights, Method.SCOAM, encounter=encounter, flown_by=aircraft):
            partner = flights.on_rails(row)
            if partner is not None and it.rails(partner) is False:
                failing += 1
            elif (ok := it.flown(row)) is not None:
                judged.append((row, ok))
    return tuple(judged), failing


def _flown_rows(flights: Flights, encounter: str) -> list[Row]:
    calm = flights.pick(Part.CALM, Method.SCOAM, Rung.JSBSIM, encounter=encounter)
    wind = flights.pick(Part.WIND, Method.SCOAM, Rung.JSBSIM, encounter=encounter, design=Design.ANCHORED)
    return [*calm, *wind, *flights.pick(Part.TURBULENCE, Method.SCOAM, Rung.JSBSIM, encounter=encounter)]


def conditions(
    rails: dict[Cell, bool], calm: dict[Cell, bool], wind: Sequence[tuple[Row, bool]], turbulence: Sequence[tuple[Row, bool]]
) -> str:
    """Which encounters, aircraft and airs pass: what completes "holds only if"."""
    good = {cell for cell, ok in calm.items() if ok}
    parts = [_cells_named(good, set(rails))] if good != set(rails) else []
    inside = [(row, ok) for row, ok in (*wind, *turbulence) if (label(row, Axis.ENCOUNTER), label(row, Axis.FLOWN_BY)) in good]
    if not inside or not all(ok for _, ok in inside):
        parts.append(_air_named(inside))
    return ", ".join(part for part in parts if part)


def _cells_named(good: set[Cell], every: set[Cell]) -> str:
    """Aircraft and readings by name; a factor that makes no difference is left out."""
    aircraft = _ordered({a for _, a in good})
    encounters = sorted({e for e, _ in good})
    if good != {(e, a) for e in encounters for a in aircraft}:
        return "flown as " + listed([f"{reading(e)} by {a}" for e, a in sorted(good)])
    parts = []
    if set(aircraft) != {a for _, a in every}:
        parts.append(f"flown by {listed(aircraft)}")
    if set(encounters) != {e for e, _ in every}:
        parts.append(f"the encounter is that of {listed([reading(e) for e in encounters])}")
    return ", ".join(parts)


def _air_named(inside: Sequence[tuple[Row, bool]]) -> str:
    """Up to which wind and which turbulence every flight passes."""
    wind = [(float(label(row, Axis.WIND_MPS) or "nan"), ok) for row, ok in inside if label(row, Axis.WIND_MPS)]
    turbulence = [(_severity(row), ok) for row, ok in inside if label(row, Axis.SEVERITY)]
    calmest = [f"wind up to {most:g} m/s"] if (most := _up_to(wind)) is not None else []
    if (worst := _up_to(turbulence)) is not None:
        calmest.append(f"turbulence up to {SEVERITIES[int(worst)]}")
    return f"in {listed(['calm air', *calmest])}"


def _severity(row: Row) -> float:
    name = label(row, Axis.SEVERITY)
    return float(SEVERITIES.index(name)) if name in SEVERITIES else float("nan")


def _up_to(judged: Sequence[tuple[float, bool]]) -> float | None:
    """The greatest strength up to which all pass; nothing where the least one fails."""
    best = None
    for strength in sorted({s for s, _ in judged}):
        if not all(ok for s, ok in judged if s == strength):
            break
        best = strength
    return best


def _ordered(aircraft: set[str]) -> list[str]:
    return sorted(aircraft, key=lambda name: (name != MAIN, name))
