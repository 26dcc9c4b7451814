"""The tables that are searched and filtered: what is in them is what results.csv says, and without a script the first rows are there."""

import csv
import io
from collections.abc import Callable
from statistics import median
from typing import Any

import pytest

from testbed.flight.record import FlightRecord
from testbed.results import tables
from testbed.results.columns import BY_NAME, METRICS, FlightMetrics
from testbed.show import explorer
from testbed.show.page import render_page
from testbed.show.series import flight_series
from testbed.show.shown_columns import SHOWN_COLUMNS, SUMMARISED
from testbed.show.words import number
from tests.show.test_page import PROVENANCE, campaign, column, flight, parsed
from tests.show.test_page import explorer as packed

Row = dict[str, Any]


@pytest.fixture
def many(make_record: Callable[..., FlightRecord], make_metrics: Callable[[FlightRecord], FlightMetrics]) -> tuple[list[Row], Row]:
    """130 flights of two aircraft in two cells, every third of which has a recording, the first two of which have curves."""
    rows, series = [], {}
    first = make_record(flight_id="f0", cell="0", labels={"severity": "light"}, plant={"kind": "jsbsim"}, method={"kind": "scoam"})
    source = flight(first, make_metrics(first))
    for n in range(130):
        name = f"f{n}"
        told = {"flight_id": name, "cell": str(n % 2), "labels": {"severity": ("light", "severe")[n % 2]}, "replicate": n // 2}
        numbers = {one.name: source[one.name] + 0.37 * n for one in METRICS if isinstance(source[one.name], float)}
        file = f"recordings/{name}.rrd" if n % 3 == 0 else None
        rows.append(source | numbers | told | {"least_clearance_m": n / 7.0 - 9.0, "recording": file})
        if n < 2:
            series[name] = flight_series(first)
    rows[5]["max_alpha_deg"] = None  # as a NaN comes back from rows.jsonl
    return rows, series


def lines_of(rows: list[Row]) -> list[dict[str, str]]:
    """The rows as results.csv has them."""
    data = tables.csv_bytes(tables.table(rows, tables.axis_kinds(row["labels"] for row in rows)))
    return list(csv.DictReader(io.StringIO(data.decode())))


def shown(text: str, name: str) -> str:
    """A cell of results.csv with the decimals of its column."""
    return number(float(text or "nan"), BY_NAME[name].digits)


def test_every_number_of_the_tables_is_its_cell_of_results_csv(many: tuple[list[Row], Row]) -> None:
    rows, _ = many
    page = render_page(campaign(replicates=65), *many, PROVENANCE)
    told = packed(page, "flights")
    ids = [text.partition("\n")[0] for text in column(told, "flight")]
    lines = {line["flight_id"]: line for line in lines_of(rows)}
    assert sorted(ids) == sorted(lines)
    for one in SHOWN_COLUMNS:
        assert column(told, one.heading) == [shown(lines[name][one.name], one.name) for name in ids], one.name
    cells = packed(page, "cells")
    for one in SUMMARISED:
        for k, text in enumerate(column(cells, one.heading)):
            values = [float(line[one.name]) for n, line in enumerate(lines_of(rows)) if n % 2 == k and line[one.name]]
            worst = (min if one.worse == "low" else max)(values)
            assert text == f"{number(median(values), one.digits)} ({number(worst, one.digits)})"


def test_recorded_flights_come_first_with_what_opens_them(many: tuple[list[Row], Row]) -> None:
    told = packed(render_page(campaign(), *many, PROVENANCE), "flights")
    ids = [text.partition("\n")[0] for text in column(told, "flight")]
    assert ids[:44] == [f"f{n}" for n in range(0, 130, 3)]
    assert told["links"] == {str(k): f"recordings/{name}.rrd" for k, name in enumerate(ids[:44])}
    assert told["commands"] == {str(k): f"rerun recordings/{name}.rrd" for k, name in enumerate(ids[:44])}
    assert told["command"].format(ids[44]) == "testbed replay . f1"
    assert set(told["sparks"]) == {"0", "44"}
    assert [one["heading"] for one in told["columns"] if one["shown"]] == ["flight", "outcome", "flown by", "method", "least clearance"]
    assert "turbulence" in [one["heading"] for one in told["columns"] if one["facet"]]


def test_without_a_script_the_first_rows_are_there_with_all_columns(many: tuple[list[Row], Row]) -> None:
    page = render_page(campaign(), *many, PROVENANCE)
    told = packed(page, "flights")
    section = page.split('<section id="flights">', 1)[1].split("</section>", 1)[0]
    text = " ".join(" ".join(parsed(section).text).split())
    assert section.count("<tr>") == 1 + explorer.PLAIN_ROWS
    for k in (0, explorer.PLAIN_ROWS - 1):
        for one in SHOWN_COLUMNS:
            assert column(told, one.heading)[k] in text
    assert "These are the first 100 of 130" in text


def test_the_small_picture_keeps_the_shape_of_the_track_within_its_frame() -> None:
    """A corner of a right angle, three to one, with a sphere at its end: both legs to one scale, all of it inside."""
    leg = [(3.0 * k, 0.0) for k in range(11)] + [(30.0, float(k)) for k in range(1, 11)]
    ball = {"nearest_enu_m": [30.0, 10.0, 0.0], "radius_m": 2.0}
    picture = str(explorer.spark({"x": [x for x, _ in leg], "y": [y for _, y in leg], "obstacles": [ball]}))
    points = [tuple(map(float, pair.split(","))) for pair in picture.split('points="')[1].split('"', maxsplit=1)[0].split()]
    (x0, y0), (x1, y1) = points[0], points[-1]
    assert len(points) == explorer.SPARK_POINTS
    assert (x1 - x0) / (y0 - y1) == pytest.approx(3.0, rel=0.12)  # north is up; rounded to whole pixels
    assert all(0.0 <= x <= explorer.SPARK_WIDE and 0.0 <= y <= explorer.SPARK_HIGH for x, y in points)
    radius = float(picture.split('r="')[1].split('"', maxsplit=1)[0])
    assert radius == pytest.approx(2.0 * (x1 - x0) / 30.0, rel=0.1)
    assert explorer.spark({"x": [None, 1.0], "y": [0.0, 1.0]}) == ""
