"""The tables behind the claims: methods case by case in calm air, methods by kind of air, flights by part."""

from testbed.results.statistics import share_at_least, share_interval, spread
from testbed.studies.scoam.labels import Axis, Method, Part, Rung
from testbed.studies.scoam.verdict.flights import Flights, Row, clearance, flew, keeps, label, marginal, number
from testbed.studies.scoam.verdict.judged import AirCell, Case, Counted

CASE_RUNGS = (Rung.KINEMATIC, Rung.POINT_MASS, Rung.JSBSIM, Rung.DIRECT)


def cases(flights: Flights) -> tuple[Case, ...]:
    """Every method in every calm encounter, in order of appearance."""
    names = [flights.values(Part.CALM, name) for name in (Axis.ENCOUNTER, Axis.FLOWN_BY, Axis.METHOD)]
    every = [
        (e, a, m, rung, flights.one(Part.CALM, m, rung, encounter=e, flown_by=a))
        for e in names[0]
        for a in names[1]
        for m in names[2]
        for rung in CASE_RUNGS
    ]
    return tuple(_case(e, a, m, rung, row) for e, a, m, rung, row in every if row is not None)


def _case(encounter: str, aircraft: str, method: str, rung: str, row: Row) -> Case:
    return Case(
        encounter=encounter,
        aircraft=aircraft,
        method=method,
        rung=rung,
        clearance_m=clearance(row),
        deflection_deg=number(row, "deflection_deg"),
        flown_deflection_deg=number(row, "flown_deflection_deg"),
        peak_deflection_deg=number(row, "peak_deflection_deg"),
        path_length_m=number(row, "path_length_m") + number(row, "begin_s_m"),
        avoidance_time_s=number(row, "avoidance_time_s"),
        clear_time_s=number(row, "clear_time_s"),
        load_factor=number(row, "max_load_factor"),
        bank_deg=number(row, "max_bank_deg"),
        roll_rate_dps=number(row, "max_roll_rate_dps"),
        cross_track_m=number(row, "cross_track_max_m"),
        replans=int(row.get("replans") or 0),
    )


def air_cells(flights: Flights) -> tuple[AirCell, ...]:
    """Every method in every kind of air: steady wind by design and speed (all directions), turbulence by severity."""
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row in flights.all:
        part = label(row, Axis.PART)
        if part in (Part.WIND, Part.TURBULENCE) and flew(row) and label(row, Axis.METHOD) != Method.NONE:
            windy = part == Part.WIND
            design, strength = (label(row, Axis.DESIGN), label(row, Axis.WIND_MPS)) if windy else (part, label(row, Axis.SEVERITY))
            who = tuple(label(row, name) for name in (Axis.ENCOUNTER, Axis.METHOD, Axis.FLOWN_BY, Axis.RUNG))
            groups.setdefault((design, strength, *who), []).append(row)
    return tuple(_air_cell(flights, key, rows) for key, rows in groups.items())


def _air_cell(flights: Flights, key: tuple[str, ...], rows: list[Row]) -> AirCell:
    threats = [row for row in rows if flights.is_threat(row)]
    kept = sum(map(keeps, threats))
    partners = [flights.on_rails(row) for row in threats]
    design, strength, encounter, method, aircraft, rung = key
    return AirCell(
        design,
        strength,
        encounter,
        method,
        aircraft,
        rung,
        len(rows),
        len(threats),
        kept,
        *share_interval(kept, len(threats)),
        share_at_least(kept, len(threats)),
        sum(map(marginal, threats)),
        sum(partner is not None and not keeps(partner) for partner in partners),
        spread(map(clearance, threats)),
    )


def counted(flights: Flights) -> tuple[Counted, ...]:
    """Flights by part."""
    parts = list(dict.fromkeys(label(row, Axis.PART) for row in flights.all))
    out = []
    for part in parts:
        rows = [row for row in flights.all if label(row, Axis.PART) == part]
        told = [row for row in rows if flew(row)]
        replicates = len({row.get("replicate") for row in rows})
        out.append(Counted(part, len(rows), len(rows) - len(told), sum(map(marginal, told)), replicates))
    return tuple(out)
