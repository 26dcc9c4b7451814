"""The page: complete, the same bytes each time, harmless, small, and drawn by a real browser without a request."""

import base64
import gzip
import json
import math
import re
from array import array
from collections.abc import Callable
from dataclasses import asdict
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from markupsafe import escape

from testbed.campaign.words.settings import Campaign
from testbed.flight.record import FlightRecord
from testbed.results.checks import CheckResult
from testbed.results.columns import METRICS, FlightMetrics
from testbed.show import campaign_summary, figures
from testbed.show.gathered import gather
from testbed.show.page import render_page
from testbed.show.pairs import Pair
from testbed.show.series import flight_series

MakeRecord = Callable[..., FlightRecord]
MakeMetrics = Callable[[FlightRecord], FlightMetrics]
Row = dict[str, Any]
NASTY = "</script><script>alert(1)</script><img src=x onerror=alert(2)> & \"q\" 'a'"
PROVENANCE = {"name": "closed-form", "plan hash": "0a1b2c", "versions": {"jsbsim": "1.3.3"}, "seed": 7}


class Text(HTMLParser):
    """All text of a page outside scripts, the tags with their attributes, and void of nothing else."""

    def __init__(self) -> None:
        super().__init__()
        self.text: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self._skip = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._skip = tag in ("script", "style")

    def handle_endtag(self, tag: str) -> None:  # noqa: ARG002
        self._skip = False

    def handle_data(self, data: str) -> None:
        if not self._skip:
            self.text.append(data)


def parsed(page: str) -> Text:
    reader = Text()
    reader.feed(page)
    reader.close()
    return reader


def campaign(question: str = "Does it hold?", **settings: object) -> Campaign:
    route = {"start_enu_m": [0, 0, 0], "goal_enu_m": [388.8, 306.0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [76.3, 0]}
    return Campaign.model_validate({"name": "closed-form", "question": question, "seed": 7, "route": route, **settings})


def flight(record: FlightRecord, metrics: FlightMetrics, recording: str | None = "recordings/one.rrd") -> Row:
    plan = record.plan
    who = {"flight_id": plan.flight_id, "cell": plan.cell, "labels": plan.labels, "replicate": plan.replicate, "seed": plan.seed}
    parts = {"plant": plan.plant.kind, "aircraft": plan.aircraft, "method": plan.method.kind}
    told = {"events": [asdict(event) for event in record.events], "message": record.message, "recording": recording}
    row: Row = json.loads(json.dumps(who | parts | asdict(metrics) | told))  # as it comes back from rows.jsonl
    return row


def explorer(page: str, name: str) -> dict[str, Any]:
    """The packed table of that name."""
    packed = page.split(f'id="{name}-data">', 1)[1].split("<", 1)[0]
    told: dict[str, Any] = json.loads(gzip.decompress(base64.b64decode(packed)))
    return told


def column(told: dict[str, Any], heading: str) -> list[str]:
    """The texts of a column."""
    one = next(one for one in told["columns"] if one["heading"] == heading)
    return one["lines"].split("\x1e") if "lines" in one else [one["values"][code] for code in one["codes"]]


@pytest.fixture
def four(make_record: MakeRecord, make_metrics: MakeMetrics) -> tuple[list[Row], dict[str, Any]]:
    """Point and aircraft, with and without a method."""
    rows, series = [], {}
    for plant in ("kinematic", "jsbsim"):
        for method in ("none", "scoam"):
            name = f"f{plant}{method}"
            labels = {"plant.kind": plant, "method.kind": method, "reading": "one"}
            record = make_record(flight_id=name, cell=f"{plant}/{method}", labels=labels, plant={"kind": plant}, method={"kind": method})
            rows.append(flight(record, make_metrics(record)))
            series[name] = flight_series(record)
    rows[1]["least_clearance_m"], rows[1]["outcome"] = 2.68, "reached"
    rows[3]["least_clearance_m"], rows[3]["outcome"] = -9.19, "collided"
    return rows, series


def test_same_bytes_and_under_three_megabytes(four: tuple[list[Row], dict[str, Any]]) -> None:
    once, twice = (render_page(campaign(), *four, PROVENANCE) for _ in range(2))
    assert once == twice
    assert len(once.encode()) < 3_000_000


def test_every_flight_and_its_numbers_are_there_without_javascript(four: tuple[list[Row], dict[str, Any]]) -> None:
    page = parsed(render_page(campaign(), *four, PROVENANCE))
    text = " ".join(" ".join(page.text).split())
    for row in four[0]:
        assert row["flight_id"] in text
        assert f"{row['flight_time_s']:.2f}" in text
    for part in ("2.68", "−9.19", "fails when flown", "12.31", "103", "68", "2.67", "0a1b2c", "versions jsbsim", "1.3.3", "Does it hold?"):  # noqa: RUF001
        assert part in text, part
    assert [dict(a)["href"] for tag, a in page.tags if tag == "a"].count("recordings/one.rrd") == 4


def test_axes_that_only_some_parts_have(four: tuple[list[Row], dict[str, Any]]) -> None:
    """The method, swept in one part and set in the other, is in its own column only; what is missing is not shown as a word."""
    rows, series = four
    for row, labels in zip(rows, ({"method.kind": "none"}, {"method.kind": "scoam"}, {"reading": "a"}, {"reading": "b"}), strict=True):
        row["labels"] = {"part": "first" if "method.kind" in labels else "second"} | labels
        row |= {"plant": "jsbsim", "method": labels.get("method.kind", "none")}
    page = parsed(render_page(campaign(), rows, series, PROVENANCE))
    text = " ".join(" ".join(page.text).split())
    assert gather(rows).listed_axes == gather(rows).telling_axes == ["part", "reading"]
    assert "None" not in text
    assert [campaign_summary.circumstances(row, gather(rows).telling_axes) for row in rows] == [
        "first",
        "first",
        "second, a",
        "second, b",
    ]


def test_a_swept_option_of_the_method_is_part_of_the_method_s_name(four: tuple[list[Row], dict[str, Any]]) -> None:
    rows, series = four
    for row, side in zip(rows, ("left", "right") * 2, strict=True):
        row |= {"method": "tangent:avoid", "labels": {"method.options.side": side, "replan.k": "1.5" if side == "left" else "2"}}
        for event in row["events"]:
            event["method"] = "tangent:avoid"
    assert gather(rows).telling_axes == []
    page = render_page(campaign(replicates=2), rows, series, PROVENANCE)
    for heading in ("side (method)", "k (replan)"):
        assert heading in [column["heading"] for column in explorer(page, "flights")["columns"]]
    assert "method.options.side" not in page
    text = " ".join(" ".join(parsed(page).text).split())
    assert "1 of 1 flight with tangent:avoid, side = left and in 1 of 1 flight with tangent:avoid, side = right." in text
    assert "the encounter kinematic point tangent:avoid, side = left against" in text
    assert figures.figure_data(rows, series, [])["flights"]["fjsbsimscoam"]["name"] == "gtm_t2 flown in JSBSim, tangent:avoid, side = right"


@pytest.mark.slow
@pytest.mark.browser
def test_a_long_heading_wraps_within_its_column(browser: Any, four: tuple[list[Row], dict[str, Any]], tmp_path: Path) -> None:
    rows, series = four
    for k, row in enumerate(rows):
        row["labels"] = {"planner.options.a_name_that_is_much_longer_than_any_column_is_wide": str(k)}
    (tmp_path / "index.html").write_text(render_page(campaign(), rows, series, PROVENANCE), encoding="utf-8")
    page = browser.new_page()
    page.goto((tmp_path / "index.html").as_uri())
    page.wait_for_selector("body[data-ready]", timeout=60_000)
    page.locator("nav a", has_text="Flights").click()
    page.wait_for_selector("#flights-explorer[data-ready]")
    page.locator("#flights-explorer .columns summary").click()
    page.locator("#flights-explorer .columns label", has_text="much_longer").click()
    assert page.locator("#flights thead button", has_text="much_longer").count() == 1
    wide = page.evaluate("[...document.querySelectorAll('#flights thead button')].filter(b => b.scrollWidth > b.clientWidth + 1).length")
    page.close()
    assert wide == 0


@pytest.mark.parametrize(
    ("point", "craft", "verdict"),
    [
        (("reached", 3.0), ("reached", 2.0), "kept when flown"),
        (("reached", 3.0), ("hit_ground", 2.0), "fails when flown"),  # it is clear of the obstacle and did not fly on
        (("reached", -1e-9), ("reached", -1e-9), "kept when flown"),  # a touch is no collision
        (("reached", 3.0), ("timed_out", -4.0), "fails when flown"),
        (("collided", -3.0), ("reached", 2.0), "fails kinematically, kept when flown"),
        (("collided", -3.0), ("diverged", 2.0), "fails kinematically"),
        (("reached", math.nan), ("reached", 2.0), "not determined"),
    ],
)
def test_a_pair_is_judged_by_the_rule_that_the_studies_have(
    four: tuple[list[Row], dict[str, Any]], point: tuple[str, float], craft: tuple[str, float], verdict: str
) -> None:
    rows, series = four
    for k, (outcome, clearance) in ((1, point), (3, craft)):
        rows[k] |= {"outcome": outcome, "least_clearance_m": clearance}
    assert Pair(rows[1], rows[3]).verdict == verdict
    page = render_page(campaign(), rows, series, PROVENANCE)
    line = page[page.index("SCOAM", page.index('id="pairs"')) :]
    colour, word = re.findall(r'badge-(\w+)">((?:fails|kept|not)[^<]*)</span>', line)[0]
    good = "warn" if verdict == "not determined" else "good" if "kept when flown" in verdict else "bad"
    assert (colour, word) == (good, verdict)


def test_the_glossary_has_every_metric_with_its_definition(four: tuple[list[Row], dict[str, Any]]) -> None:
    page = render_page(campaign(), *four, PROVENANCE)
    for column in METRICS:
        assert f"<code>{column.name}</code></dt><dd>{escape(column.definition)}</dd>" in page


def test_the_answer_in_words_follows_the_rows(four: tuple[list[Row], dict[str, Any]]) -> None:
    text = " ".join(" ".join(parsed(render_page(campaign(), *four, PROVENANCE)).text).split())
    assert "Of 4 flights, 3 reached the goal, 1 collided." in text
    assert "Where an aircraft re-planned (2 flights), the point kept its clearance in 1 of the same encounters, the aircraft in 0." in text
    assert "The least clearance of the point was −2.85 to 2.68 m, of the aircraft −9.19 to −2.85 m." in text  # noqa: RUF001


def test_where_there_was_no_obstacle_nothing_is_said_of_one(four: tuple[list[Row], dict[str, Any]]) -> None:
    rows, _ = four
    alone = [row | {"least_clearance_m": math.nan} for row in rows]
    assert not any("obstacle" in sentence for sentence in campaign_summary.sentences(gather(alone), []))
    assert "collisions" not in [card["name"] for card in campaign_summary.cards(gather(alone))]
    assert "collisions" in [card["name"] for card in campaign_summary.cards(gather(rows))]


def test_the_shades_of_crowded_cells_stand_out_by_day_and_by_night(four: tuple[list[Row], dict[str, Any]]) -> None:
    """Contrast of at least 2.2 with the ground (WCAG 2.2, relative luminance), and all different."""

    def luminance(colour: str) -> float:
        parts = (int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    crowd = [four[0][0] | {"cell": str(k)} for k in range(7)]
    for theme, ground in (("light", "#ffffff"), ("dark", "#14181d")):
        shades = [style[theme] for style in figures.styles(crowd)]
        assert len(set(shades)) == 7
        for shade in shades:
            low, high = sorted((luminance(shade), luminance(ground)))
            assert (high + 0.05) / (low + 0.05) >= 2.2, (theme, shade)


def test_a_check_shows_its_lines_and_what_it_verifies(four: tuple[list[Row], dict[str, Any]]) -> None:
    words = {"verifies": f"This {NASTY}", "truth": "closed form", "tolerance": "rounding"}
    checked = campaign(check={"kind": "clearance", "clearance_tolerance_m": 0.001, "time_tolerance_s": 0.1, **words})
    lines = [
        CheckResult("one", "m", 1.0, 1.0004, 0.001),
        CheckResult("two", "s", 2.0, 2.25, 0.1),
        CheckResult("three", "", 0.0, math.nan, 0.0),
    ]
    page = parsed(render_page(checked, *four, PROVENANCE, lines))
    text = " ".join(" ".join(page.text).split())
    assert "Check missed: 2 of 3 lines out of tolerance." in text
    assert "passed one m 1.00000 1.00040 0.00040 0.00100" in text
    assert "missed two s 2.000 2.250 0.250 0.100" in text
    assert "missed three" in text
    assert all(word in text for word in ("Verifies", "closed form", "rounding"))
    assert not [tag for tag, _ in page.tags if tag == "img"]
    assert "Check" not in "".join(parsed(render_page(campaign(), *four, PROVENANCE)).text)


def test_words_from_outside_stay_words(four: tuple[list[Row], dict[str, Any]]) -> None:
    rows, series = four
    for row in rows:
        row["labels"]["reading"] = row["message"] = NASTY
        row["events"][0]["obstacle"] = row["events"][0]["decision"] = NASTY
    page = parsed(render_page(campaign(NASTY), rows, series, {"name": NASTY, NASTY: "x"}))
    assert not [tag for tag, attributes in page.tags if tag == "img" or "onerror" in attributes]
    assert len([tag for tag, _ in page.tags if tag == "script"]) == 6  # ours, the library; data of pictures, flights, re-plans, encounter
    assert NASTY in "".join(page.text)


def test_nothing_points_to_the_network(four: tuple[list[Row], dict[str, Any]]) -> None:
    page = parsed(render_page(campaign(), *four, PROVENANCE))
    assert not [a for _, a in page.tags if any((a.get(key) or "").startswith(("http", "//")) for key in ("src", "href"))]
    policy = next(a["content"] for tag, a in page.tags if tag == "meta" and a.get("http-equiv") == "Content-Security-Policy")
    assert policy
    assert "default-src 'none'" in policy


def test_the_browser_gets_the_curves_of_every_group(four: tuple[list[Row], dict[str, Any]]) -> None:
    page = render_page(campaign(), *four, PROVENANCE)
    packed = page.split('id="figures-data">', 1)[1].split("<", 1)[0]
    figures = json.loads(gzip.decompress(base64.b64decode(packed)))
    assert [group["flights"] for group in figures["groups"]] == [[row["flight_id"] for row in four[0]]]
    one = figures["flights"]["fjsbsimscoam"]
    assert one["name"] == "gtm_t2 flown in JSBSim, SCOAM"
    assert one["collided"]
    assert one["clearance_m"] == four[1]["fjsbsimscoam"]["clearance_m"]


@pytest.mark.slow
def test_hundreds_of_flights_stay_readable_and_small(four: tuple[list[Row], dict[str, Any]]) -> None:
    rows, series = four
    many, drawn = [], {}
    for cell in range(12):
        for replicate in range(50):
            source = rows[(cell % 2) * 2 + 1]
            name = f"c{cell}r{replicate}"
            changed = {"flight_id": name, "cell": f"cell {cell}", "labels": {"gust": f"no. {cell}"}, "replicate": replicate}
            many.append(source | changed | {"least_clearance_m": replicate - 10.0})
            drawn[name] = series[source["flight_id"]]
    page = render_page(campaign(replicates=50), many, drawn, PROVENANCE)
    assert len(page.encode()) < 3_000_000
    text = " ".join(" ".join(parsed(page).text).split())
    assert "10 of 50" in text  # per cell
    assert "120 of 600 flights" not in text  # point and aircraft are counted apart
    assert "60 of 300 flights (95 % interval 16 to 25 %)" in text
    told = explorer(page, "flights")
    assert told["n"] == len(column(told, "least clearance")) == 600
    assert "These are the first 100 of 600" in text


def test_of_very_many_cells_some_are_listed_and_the_rest_is_counted(four: tuple[list[Row], dict[str, Any]]) -> None:
    many = [four[0][1] | {"flight_id": f"c{k}", "cell": f"cell {k}", "labels": {"gust": str(k)}} for k in range(1000)]
    page = render_page(campaign(), many, {}, PROVENANCE)
    cells = page.split('<section id="cells">', 1)[1].split("</section>", 1)[0]
    assert cells.count("<tr>") == 1 + 100  # with the heading; a script draws the rest
    assert explorer(page, "cells")["n"] == 1000


def test_flights_that_failed_or_never_began_are_listed(four: tuple[list[Row], dict[str, Any]]) -> None:
    rows, series = four
    empty = {key: math.nan for key, value in rows[0].items() if isinstance(value, float)}
    rows[0] |= empty | {"outcome": "crashed", "message": "KeyError: 'x'", "traceback": "Traceback <here>", "events": [], "recording": None}
    rows[3] |= dict.fromkeys(empty) | {"outcome": "trim_failed", "events": [], "message": "no trim"}
    series["fkinematicnone"] = None
    text = " ".join(parsed(render_page(campaign(), rows, series, PROVENANCE)).text)
    assert "Traceback <here>" in text
    assert "1 failed to run" in text
    assert "1 could not be trimmed" in text
    assert "not determined" in text


def test_no_flight_at_all() -> None:
    assert "No flight was flown." in render_page(campaign(), [], {}, PROVENANCE)


@pytest.mark.slow
@pytest.mark.browser
def test_a_browser_draws_it_without_error_or_request(browser: Any, four: tuple[list[Row], dict[str, Any]], tmp_path: Path) -> None:
    rows, series = four
    rows[3]["labels"]["reading"] = NASTY
    (tmp_path / "index.html").write_text(render_page(campaign(NASTY), rows, series, PROVENANCE), encoding="utf-8")
    problems: list[str] = []
    for scheme, width in (("light", 1300), ("dark", 390)):
        page = browser.new_page(color_scheme=scheme, viewport={"width": width, "height": 900})
        page.on("console", lambda message: problems.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("dialog", lambda dialog: (problems.append("a dialog"), dialog.dismiss()))
        page.on("request", lambda request: None if request.url.startswith(("file:", "data:", "blob:")) else problems.append(request.url))
        page.goto((tmp_path / "index.html").as_uri())
        page.wait_for_selector("body[data-ready]", timeout=60_000)
        assert page.get_attribute("body", "data-ready") == "1"
        page.locator("#plan").scroll_into_view_if_needed()  # drawn when it comes near
        page.wait_for_selector("#space canvas", timeout=60_000, state="attached")
        assert page.locator("#plan .scatterlayer .trace").count() > 8
        assert page.locator("#curves .scatterlayer .trace").count() >= 20
        assert page.locator("#space canvas").count() >= 1
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")  # nothing sticks out sideways
        page.locator(".chip").first.click()
        assert page.locator(".chip").first.get_attribute("aria-pressed") == "false"
        page.locator("nav a", has_text="Flights").click()
        page.locator("#flights thead button", has_text="least clearance").click()
        first = page.locator("#flights tbody tr").first.inner_text()
        assert "9.19" in first
        page.emulate_media(media="print")
        page.close()
    assert problems == []


@pytest.mark.slow
def test_crowded_cells_have_a_histogram_that_counts_every_flight() -> None:
    import numpy as np

    from testbed.show.histogram import BINS, HEIGHT, histograms

    rng = np.random.default_rng(4)
    rms = np.append(rng.uniform(0.0, 0.4, 199), 9.0)
    values = {"cross_track_rms_m": array("d", rms), "least_clearance_m": array("d")}
    few = {"n": 3, "values": {name: known[:3] for name, known in values.items()}, "circumstances": "few", "flyer": "x", "method": "none"}
    (metric,) = histograms([{"n": 200, "values": values, "circumstances": "<b>", "flyer": "gtm_t2", "method": "none"}, few])
    (picture,) = metric["pictures"]
    svg = str(picture["svg"])
    heights = [float(part.split('"')[0]) for part in svg.split('height="')[1:]]
    counts = np.histogram(rms, np.linspace(0.0, np.percentile(rms, 99), BINS + 1))[0]
    assert heights == pytest.approx((HEIGHT * counts[counts > 0] / counts.max()).tolist(), abs=0.06)
    assert f"{200 - counts.sum()} beyond" in svg


def test_an_unfinished_run_says_so_on_top(four: tuple[list[Row], dict[str, Any]]) -> None:
    def page(rows: list[Row], planned: int) -> str:
        return render_page(campaign(), rows, four[1], PROVENANCE | {"flights_flown": len(rows), "flights_planned": planned})

    assert '<p class="note-bar">Not finished: 4 of 9 flights.</p>' in page(four[0], 9)
    assert 'note-bar">' not in page(four[0], 4)
    none = page([], 9)
    assert "Not finished: 0 of 9 flights." in none
    assert "In words and numbers" not in none
    assert "#words" not in none
