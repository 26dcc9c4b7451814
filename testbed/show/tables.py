"""The tables of flights, cells and re-plans: which columns they have, and the text of each of their cells."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from testbed.core.frames import direction_deg
from testbed.core.units import DEG
from testbed.flight.record import NEW_PATH, PathFault
from testbed.results.flight_row import collided, value
from testbed.show import campaign_summary, words
from testbed.show.explorer import Explorer, Field, spark
from testbed.show.flight_summary import level_turn, radius_m
from testbed.show.gathered import Gathered, Row, flyer, method
from testbed.show.shown_columns import SHOWN_COLUMNS, SUMMARISED, text
from testbed.show.words import number

REPLAY: Final = "testbed replay . {}"
Series = Mapping[str, Mapping[str, Any] | None]


def flights_table(of: Gathered, axes: Sequence[str], listed_axes: Sequence[str], series: Series) -> Explorer:
    """The flights: those with a recording first, with the command that opens it; of the others that which flies them again."""
    rows = [one.row() for one in of.listed]
    several = len({row["aircraft"] for row in rows}) > 1
    lead, *rest = SHOWN_COLUMNS
    fields = (
        Field("flight", kind="flight", shown=True),
        Field("outcome", kind="badge", shown=True, facet=True),
        Field("flown by", shown=True, facet=True),
        Field("method", shown=True, facet=True),
        Field(lead.heading, lead.unit, lead.definition, "bad", shown=True),
        *([Field("aircraft", facet=True)] if several else []),
        *(Field(words.axis_heading(axis), facet=True) for axis in listed_axes),
        *(Field(column.heading, column.unit, column.definition, "number") for column in rest),
    )
    texts = [
        [
            f"{row['flight_id']}\n{with_replicate(row, axes)}",
            words.outcome(str(row["outcome"])),
            flyer(row),
            method(row),
            text(lead, row),
            *([str(row["aircraft"])] if several else []),
            *(str(row["labels"].get(axis, "")) for axis in listed_axes),
            *(text(column, row) for column in rest),
        ]
        for row in rows
    ]
    recorded = {k: str(row["recording"]) for k, row in enumerate(rows) if row["recording"]}
    curves = {k: found for k, row in enumerate(rows) if (found := series.get(row["flight_id"])) and found["time_s"]}
    return Explorer(
        "flights",
        fields,
        texts,
        tones={words.outcome(name): words.tone(name) for name in of.outcomes},
        marked=[k for k, row in enumerate(rows) if collided(row)],
        links=recorded,
        notes={k: str(row["message"]) for k, row in enumerate(rows) if row["message"]},
        commands={k: f"rerun {file}" for k, file in recorded.items()},
        command=REPLAY,
        sparks={k: picture for k, found in curves.items() if (picture := spark(found))},
    )


def with_replicate(row: Row, axes: Sequence[str]) -> str:
    """The circumstances of one flight among those of its cell."""
    said = campaign_summary.circumstances(row, axes)
    return ", ".join(part for part in (said, f"no. {row['replicate']}" if row["replicate"] else "") if part)


def cells_table(cells: Sequence[dict[str, Any]], axes: Sequence[str]) -> Explorer:
    """The cells: median and worst of what is summarised."""
    lead, *rest = SUMMARISED
    fields = (
        Field("cell", shown=True),
        Field("flown by", shown=True, facet=True),
        Field("method", shown=True, facet=True),
        Field("closer than R", kind="number", shown=True),
        Field(lead.heading, lead.unit, lead.definition, "number", shown=True),
        *(Field(words.axis_heading(axis), facet=True) for axis in axes),
        Field("flights", kind="number"),
        Field("outcomes"),
        *(Field(column.heading, column.unit, column.definition, "number") for column in rest),
    )
    texts = [
        [
            cell["circumstances"] or "all",
            cell["flyer"],
            cell["method"],
            cell["collided"],
            _median_and_worst(cell, lead.name),
            *(str(cell["labels"].get(axis, "")) for axis in axes),
            str(cell["n"]),
            cell["outcomes"],
            *(_median_and_worst(cell, column.name) for column in rest),
        ]
        for cell in cells
    ]
    return Explorer("cells", fields, texts)


def _median_and_worst(cell: Mapping[str, Any], name: str) -> str:
    return "{} ({})".format(*cell["summary"][name][:2])


DECISION_FIELDS: Final = (
    ("time", "s", True),
    ("own velocity", "m/s (deg)", False),
    ("obstacle's velocity", "m/s (deg)", False),
    ("alpha", "deg", False),
    ("alpha_0", "deg", False),
    ("would miss by", "m", False),
    ("in", "s", False),
    ("cap's centre", "deg", False),
    ("cap's half-angle", "deg", False),
    ("command", "deg", False),
    ("deflection", "deg", True),
    ("margin", "deg", False),
    ("insertion point", "m", False),
    ("insertion after", "s", False),
    ("least radius of the path", "m", False),
    ("bank it needs", "deg", False),
    ("load factor it needs", "g", True),
)


def decisions_table(of: Gathered, axes: Sequence[str]) -> Explorer:
    """Every decision of the planner with its inputs and its result."""
    fields = (
        Field("decision", kind="badge", shown=True, facet=True),
        Field("encounter", shown=True),
        Field("flown by", shown=True, facet=True),
        Field("method", shown=True, facet=True),
        *(Field(heading, unit, "", "number", shown) for heading, unit, shown in DECISION_FIELDS),
    )
    texts = [_decision(row, event, axes) for row, event in of.decisions]
    faults = set(PathFault)
    avoiding = ((event, event["decision"] in NEW_PATH and event["status"] not in faults) for _, event in of.decisions)
    tones = {_decided(event): "good" if avoids else "warn" for event, avoids in avoiding}
    return Explorer("re-plans", fields, texts, tones)


def _decided(event: Row) -> str:
    """The decision in words; of a path that does not avoid what it does instead, and of none why."""
    told = words.read_aloud(str(event["decision"]))
    more = words.read_aloud(str(event["status"])) if event["status"] in set(PathFault) else str(event["reason"])
    return f"{told}: {more}" if more else told


def _vector(event: Row, key: str) -> tuple[float, float, float]:
    """A vector of an event; NaN for what is missing."""
    x, y, z = (math.nan if part is None else float(part) for part in event.get(key) or (None, None, None))
    return x, y, z


def _decision(row: Row, event: Row, axes: Sequence[str]) -> list[str]:
    """One line of the table of re-plans."""

    def motion(key: str) -> str:
        vector = _vector(event, key)
        return f"{number(math.hypot(*vector), 1)} ({angles(vector)})"

    def angles(vector: tuple[float, float, float]) -> str:
        return ", ".join(number(angle, 1) for angle in direction_deg(vector))

    def deg(key: str, digits: int = 2) -> str:
        return number(value(event, key) / DEG, digits)

    curvature = value(event, "max_curvature_to_insertion_1pm")
    bank_deg, load = level_turn(math.hypot(*_vector(event, "own_vel_enu_mps")), curvature)
    radius = radius_m(curvature)
    name = method(row) if event["method"] == row["method"] else words.method(str(event["method"]))
    return [
        _decided(event),
        campaign_summary.circumstances(row, axes) or "the encounter",
        flyer(row),
        f"{name} against {event['obstacle']}" if event["obstacle"] else name,
        number(value(event, "time_s"), 2),
        motion("own_vel_enu_mps"),
        motion("obstacle_vel_enu_mps"),
        deg("alpha_rad"),
        deg("alpha0_rad"),
        number(value(event, "miss_m"), 1),
        number(value(event, "time_to_cpa_s"), 2),
        f"{deg('cap_azimuth_rad', 1)}, {deg('cap_elevation_rad', 1)}",
        deg("cap_half_angle_rad"),
        angles(_vector(event, "command_enu_mps")),
        deg("deflection_rad"),
        deg("margin_rad"),
        ", ".join(number(x, 1) for x in _vector(event, "insertion_enu_m")),
        number(value(event, "insertion_time_s"), 2),
        "straight" if math.isinf(radius) else number(radius, 0),
        number(bank_deg, 0),
        number(load, 2),
    ]
