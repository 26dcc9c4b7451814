"""What the paper can be read as: its path is safe, or not, for each reading by itself, beside the paper's own.

One thing differs at a time. A reading is judged by the rules of the promises; it has no draws.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from testbed.flight.record import TOUCH_M, Decision
from testbed.results.statistics import NAN, NO_EFFECT, mcnemar, median, share, share_interval, spread
from testbed.show.words import listed
from testbed.studies.scoam.claim import Claim
from testbed.studies.scoam.labels import DRAWN, MAIN, READING_PARTS, READINGS, Axis, Method, Part, Rung
from testbed.studies.scoam.verdict.csv_words import percent, reading, say
from testbed.studies.scoam.verdict.evidence import conditions
from testbed.studies.scoam.verdict.flights import Flights, Row, air_of, clearance, keeps, label
from testbed.studies.scoam.verdict.judged import ReadingCell
from testbed.studies.scoam.verdict.rulings import Agreement, PromiseEvidence, Ruling, promise, robust

KEY: Final = "readings"
RUNGS: Final = (Rung.KINEMATIC, Rung.POINT_MASS, Rung.JSBSIM)
WITHIN: Final = "aircraft's limits: "  # what a planner says before the limits that forbid a path


@dataclass(frozen=True)
class Text:
    """Where the paper leaves the choice, and what is chosen."""

    where: str
    text: str


TEXTS: Final = {
    Method.SCOAM: Text("Sections 4, 5", "as the verdict flies it: every formula as it is printed"),
    Method.SCOAM_NEARER: Text("Eq. 14", "the nearer of two roots, instead of the larger"),
    Method.SCOAM_CORRECTED: Text("Eq. 28", "a cap may be more than half of the sphere"),
    Method.SCOAM_BEHIND: Text("Section 4.3.1", "the insertion point lies behind the obstacle, as its words say"),
    Method.SCOAM_FORWARD: Text("Section 4.3.1", "the insertion point is met ahead of the aircraft"),
    Method.SCOAM_FLYABLE: Text("Section 5, step (iii)", "the paper's own step 5 (iii) taken seriously"),
}
"""Reading to its words."""


def reading_cells(flights: Flights) -> tuple[ReadingCell, ...]:
    """Every reading in every encounter, by aircraft and rung, where a flight of it is at a threat."""
    found = []
    for method in READINGS:
        for part in READING_PARTS:
            for rung in RUNGS:
                groups: dict[tuple[str, str], list[Row]] = {}
                for row in _threats(flights, part, method, rung):
                    groups.setdefault((label(row, Axis.ENCOUNTER), label(row, Axis.FLOWN_BY)), []).append(row)
                found += [_cell(flights, (method, part, *where, rung), rows) for where, rows in groups.items()]
    return tuple(found)


def _threats(flights: Flights, part: str, method: str, rung: str, **where: str) -> list[Row]:
    return [row for row in flights.pick(part, method, rung, **where) if flights.is_threat(row)]


def _pairs(flights: Flights, rows: Sequence[Row]) -> list[tuple[Row, Row]]:
    """Each flight with that of the paper's own reading in the same encounter and air."""
    if not rows or label(rows[0], Axis.METHOD) == Method.SCOAM:
        return []
    part, rung = label(rows[0], Axis.PART), label(rows[0], Axis.RUNG)
    own = {_place(row): row for row in flights.pick(part, Method.SCOAM, rung)}
    return [(row, own[_place(row)]) for row in rows if _place(row) in own]


def _place(row: Row) -> tuple[str, ...]:
    return (label(row, Axis.ENCOUNTER), label(row, Axis.FLOWN_BY), str(row.get("replicate")), *air_of(row))


def _cell(flights: Flights, who: tuple[str, str, str, str, str], rows: Sequence[Row]) -> ReadingCell:
    kept, pairs = sum(map(keeps, rows)), _pairs(flights, rows)
    only_this, only_own = _one_sided(pairs)
    differences = [clearance(a) - clearance(b) for a, b in pairs]
    forbidden = _forbidden(rows)
    return ReadingCell(
        *who,
        len(rows),
        kept,
        *share_interval(kept, len(rows)),
        spread(map(clearance, rows)),
        len(pairs),
        sum(abs(d) > TOUCH_M for d in differences),
        only_this,
        only_own,
        mcnemar(only_this, only_own) if pairs else NAN,
        median("median of the reading's clearance minus the paper's own", "m", differences) if pairs else NO_EFFECT,
        sum(forbidden.values()),
        "; ".join(f"{limit} {n}" for limit, n in sorted(forbidden.items(), key=lambda item: (-item[1], item[0]))),
    )


def _one_sided(pairs: Sequence[tuple[Row, Row]]) -> tuple[int, int]:
    return sum(keeps(a) and not keeps(b) for a, b in pairs), sum(keeps(b) and not keeps(a) for a, b in pairs)


def _forbidden(rows: Sequence[Row]) -> Counter[str]:
    """Flights in which the planner found no path, by what forbade it the first time."""
    firsts = [next((e for e in row.get("events", []) if e.get("decision") == Decision.NO_PATH), None) for row in rows]
    return Counter(_limit(str(event.get("reason") or "not said")) for event in firsts if event is not None)


def _limit(reason: str) -> str:
    """``climb angle and roll rate`` of the sentence that a planner gives."""
    return reason.partition(WITHIN)[2].partition(",")[0] or reason


# ---- the words ---------------------------


def readings(flights: Flights) -> tuple[Claim, ...]:
    """One claim a reading that was flown."""
    return tuple(_claim(flights, method) for method in READINGS if any(flights.pick(Part.READINGS, method, rung) for rung in RUNGS))


def _claim(flights: Flights, method: Method) -> Claim:
    rails, calm, air = _evidence(flights, method)
    flown = [*calm.values(), *(ok for _, ok in air)]
    evidence = PromiseEvidence(
        tuple(rails.values()),
        tuple(calm.values()),
        tuple(ok for _, ok in air),
        share("flown flights that keep every radius", sum(flown), len(flown)),
        conditions(rails, calm, air, ()),
    )
    ruling = robust(promise(evidence), Agreement())
    where = {Axis.ENCOUNTER: DRAWN[0], Axis.FLOWN_BY: MAIN}
    on_rails, point, flown_calm = (clearance(flights.one(Part.READINGS, method, rung, **where)) for rung in RUNGS)
    drawn = _threats(flights, Part.READINGS_POPULATION, method, Rung.JSBSIM, flown_by=MAIN)
    every = [row for part in READING_PARTS for row in _threats(flights, part, method, Rung.KINEMATIC)]
    most = max(sorted((forbidden := _forbidden(every)).items()), key=lambda item: item[1], default=("", 0))[0]
    return Claim(
        f"{KEY}.{method}",
        TEXTS[method].where,
        TEXTS[method].text,
        "",
        "m",
        "least clearance",
        DRAWN[0],
        MAIN,
        on_rails,
        point,
        flown_calm,
        spread(map(clearance, _threats(flights, Part.READINGS_WIND, method, Rung.JSBSIM, **where))),
        ruling.word,
        ruling.condition,
        share("flown encounters of the population that keep every radius", sum(map(keeps, drawn)), len(drawn)),
        NAN,
        0,
        most,
        " ".join([_judged(rails, calm, air, ruling), *_population(flights, method), *_without(forbidden, len(every))]),
    )


Cells = dict[tuple[str, str], bool]


def _evidence(flights: Flights, method: str) -> tuple[Cells, Cells, list[tuple[Row, bool]]]:
    """On rails; flown in calm air where it passes on rails; flown in wind where it passes there on rails too. By encounter and aircraft."""
    judged = {rung: [row for e in DRAWN for row in _threats(flights, Part.READINGS, method, rung, encounter=e)] for rung in RUNGS}
    rails, every = ({_cell_of(row): keeps(row) for row in judged[rung]} for rung in (Rung.KINEMATIC, Rung.JSBSIM))
    calm = {cell: ok for cell, ok in every.items() if rails.get(cell)}
    windy = [row for row in _threats(flights, Part.READINGS_WIND, method, Rung.JSBSIM) if rails.get(_cell_of(row))]
    partners = [(row, flights.on_rails(row)) for row in windy]
    return rails, calm, [(row, keeps(row)) for row, partner in partners if partner is None or keeps(partner)]


def _cell_of(row: Row) -> tuple[str, str]:
    return label(row, Axis.ENCOUNTER), label(row, Axis.FLOWN_BY)


def _judged(rails: Cells, calm: Cells, air: Sequence[tuple[Row, bool]], ruling: Ruling) -> str:
    """What the word rests on."""
    if not rails:
        return f"{ruling.reason[:1].upper()}{ruling.reason[1:]}."
    passing = [f"{reading(e)} by {a}" for (e, a), ok in rails.items() if ok]
    said = [f"On rails {sum(rails.values())} of {len(rails)} keep every radius{f' ({listed(passing)})' if passing else ''}."]
    if calm:
        wind = f", {sum(ok for _, ok in air)} of {len(air)} in anchored wind" if air else ""
        said.append(f"Of these {sum(calm.values())} of {len(calm)} do when flown in calm air{wind}.")
    return " ".join(said)


def _population(flights: Flights, method: str) -> list[str]:
    """The share of encounters of the paper's class in which every radius is kept, beside the paper's own reading."""
    said = []
    for rung, where in ((Rung.KINEMATIC, "on rails"), (Rung.JSBSIM, "flown")):
        rows = _threats(flights, Part.READINGS_POPULATION, method, rung, flown_by=MAIN)
        if rows:
            cell = _cell(flights, (method, Part.READINGS_POPULATION, "", MAIN, rung), rows)
            beside = f"; {_beside(cell, sum(keeps(b) for _, b in _pairs(flights, rows)))}" if cell.pairs else ""
            bounds = f"95 % interval {percent(cell.low)} to {percent(cell.high)}"
            said.append(f"{where} {cell.kept} of {cell.n} encounters of the population keep every radius ({bounds}{beside})")
    return [f"{said[0][:1].upper()}{'; '.join(said)[1:]}."] if said else []


def _beside(cell: ReadingCell, own: int) -> str:
    """The pairs with the paper's own reading."""
    if not cell.other:
        return f"in all {cell.pairs} it flies as the paper's own does"
    gap = cell.difference.value
    apart = f"{say(abs(gap), 'm')} {'less' if gap < 0.0 else 'more'} clearance in the median"
    return f"the paper's own {own} of {cell.pairs}, McNemar p = {cell.mcnemar_p:.2g}; {apart}, another one in {cell.other}"


def _without(forbidden: Counter[str], n: int) -> list[str]:
    """How often no path is found on rails, and what forbids it."""
    if not forbidden:
        return []
    told = [f"{limit} in {count}" for limit, count in sorted(forbidden.items(), key=lambda item: (-item[1], item[0]))]
    return [f"On rails no path is found in {sum(forbidden.values())} of {n} flights: {'; '.join(told)}."]
