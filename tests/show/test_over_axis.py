"""A metric over the axes of a sweep: the numbers drawn are the statistics of the rows, and each stands in the table."""

import re
from typing import Any

import numpy as np
import pytest

from testbed.campaign.words.settings import Campaign
from testbed.results import statistics
from testbed.show import over_axis_svg
from testbed.show.axis_words import KEPT, interval_text
from testbed.show.over_axis import OverAxes
from testbed.show.page import render_page
from tests.plans import PAPER_ROUTE

Row = dict[str, Any]
SPEEDS, FROM, METHODS, REPLICATES = ("0", "7.5", "15"), ("0", "90", "180", "270"), ("none", "scoam", "orca"), 8


def _row(labels: dict[str, str], replicate: int, clearance: float, load: float) -> Row:
    return {
        "flight_id": "-".join([*labels.values(), str(replicate)]), "cell": "/".join(labels.values()), "labels": labels,
        "replicate": replicate, "seed": 1, "plant": labels["plant.kind"], "aircraft": "gtm_t2", "method": labels["method.kind"],
        "outcome": "collided" if clearance < 0 else "reached", "least_clearance_m": clearance, "max_load_factor": load,
        "max_bank_deg": 30.0, "max_roll_rate_dps": None, "cross_track_max_m": 1.0, "replans": 1, "events": [], "message": "",
        "recording": None, "limits_hit": "",
    }  # fmt: skip


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    rng = np.random.default_rng(5)
    made = []
    for plant in ("kinematic", "jsbsim"):
        for method in METHODS:
            for speed in SPEEDS:
                for direction in FROM:
                    labels = {"plant.kind": plant, "method.kind": method, "air.wind.speed_mps": speed, "air.wind.from_deg": direction}
                    made += [_row(labels, k, float(rng.normal(2.0, 3.0)), float(rng.uniform(1, 3))) for k in range(REPLICATES)]
    return made


def _watched(rows: list[Row]) -> OverAxes:
    over = OverAxes()
    assert list(over.watch(rows)) == rows
    return over


def test_each_point_is_the_statistic_of_its_cell_s_rows(rows: list[Row]) -> None:
    over = _watched(rows)
    assert [(c.axis, c.round, len(c.panels), c.left_out) for c in over.curves] == [
        ("air.wind.speed_mps", False, 4, 4),  # of 2 plants in 4 directions
        ("air.wind.from_deg", True, 4, 2),
    ]
    points = 0
    for curve in over.curves:
        for panel in curve.panels:
            assert [line.method for line in panel.lines] == ["no avoidance", "SCOAM", "ORCA"]
            for line in panel.lines:
                for x, cell in line.points:
                    mine = [row for row in rows if row["labels"] == cell.first["labels"]]
                    assert x == float(cell.first["labels"][curve.axis])
                    kept = sum(row["least_clearance_m"] >= 0.0 for row in mine)
                    assert cell.effects[KEPT] == statistics.share(KEPT, kept, REPLICATES)
                    load = statistics.median("max_load_factor", "", [row["max_load_factor"] for row in mine])
                    assert cell.effects["max_load_factor"] == load
                    assert load.low <= load.value == np.median([row["max_load_factor"] for row in mine]) <= load.high
                    points += 1
    assert points == 4 * 3 * 3 + 4 * 3 * 4
    assert "max_roll_rate_dps" not in over.metrics()  # nobody measured it


def test_two_axes_are_a_heat_map_with_every_cell(rows: list[Row]) -> None:
    (pair,) = _watched(rows).heat_maps
    assert (pair.across, pair.upward) == ("air.wind.from_deg", "air.wind.speed_mps")
    for grid in pair.grids:
        assert set(grid.cells) == {(float(d), float(s)) for d in FROM for s in SPEEDS}
        for (direction, speed), cell in grid.cells.items():
            assert (float(cell.labels["air.wind.from_deg"]), float(cell.labels["air.wind.speed_mps"])) == (direction, speed)


def test_every_number_drawn_stands_in_the_table_and_the_headline_is_not_pooled(rows: list[Row]) -> None:
    about = {"name": "axes", "question": "How much wind?", "seed": 1, "route": PAPER_ROUTE}
    page = render_page(Campaign.model_validate(about), rows, {}, {})
    section = page[page.index('<section id="over-axis"') :].split("</section>")[0]
    pictures, table = section.split('<table class="sortable" id="oa-table">')
    cells = set(re.findall(r'data-v="[^"]*">([^<]*) <span class="quiet">\(([^)]*)\)', table))
    drawn = re.findall(r": ([^:()<]+?)(?: m| deg)? \(([^;)]*)(?:; n \d+)?\)</title>", pictures)
    assert len(drawn) > 4 * 3 * 3 * 5
    assert set(drawn) <= cells
    written = re.findall(r'class="oa-(?:dark|bright)"[^>]*>([^<]*)<', pictures)  # in the fields of a heat map
    assert len(written) == 4 * 12 * 5
    assert set(written) <= {text.removesuffix(" %") for text, _ in cells}
    answer = page[page.index('<div class="answer">') :].split("</div>")[0]
    assert "Over wind speed (m/s), gtm_t2 flown in JSBSim" in answer
    assert "came closer than an obstacle" not in answer


def test_words_alone_are_no_axis(rows: list[Row]) -> None:
    named = [row | {"labels": {"method.kind": row["method"], "reading": f"r{row['labels']['air.wind.speed_mps']}"}} for row in rows]
    over = _watched(named)
    assert over_axis_svg.pictures(over) is None
    assert over.sentences() == []


def test_a_number_of_the_method_s_own_is_an_axis_and_compass_points_are_directions(rows: list[Row]) -> None:
    made = []
    for row in rows:
        labels = {"method.options.gain": row["labels"]["air.wind.speed_mps"], "method.options.side": "left", "wind_from": "NE"}
        made.append(row | {"cell": row["cell"] + "/NE", "labels": labels})
        made.append(row | {"cell": row["cell"] + "/W", "labels": labels | {"wind_from": "W"}})
    over = _watched(made)
    assert [curve.axis for curve in over.curves] == ["method.options.gain", "wind_from"]
    assert over.curves[1].round
    assert {x for panel in over.curves[1].panels for line in panel.lines for x, _ in line.points} == {45.0, 270.0}
    assert {line.method for panel in over.curves[0].panels for line in panel.lines} == {
        "no avoidance, side = left", "SCOAM, side = left", "ORCA, side = left",
    }  # fmt: skip


def test_of_one_flight_a_point_has_no_interval(rows: list[Row]) -> None:
    over = _watched([row for row in rows if row["replicate"] == 0])
    figure = over_axis_svg.pictures(over)["figures"][0]  # type: ignore[index]
    assert figure["notes"][0] == ""  # nothing is said of bars that are not there
    assert "Bars: 95 % interval" in over_axis_svg.pictures(_watched(rows))["figures"][0]["notes"]  # type: ignore[index]
    svg = str(figure["each"][0][0]["svg"])  # least clearance: a share of one flight is none
    assert svg.count("<circle") == 9
    assert svg.count("<path d=") == 3  # three lines, no bar
    assert interval_text("least_clearance_m", over.curves[0].panels[0].lines[0].points[0][1].effects["least_clearance_m"]) == "–"  # noqa: RUF001
