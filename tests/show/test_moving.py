"""The encounter that moves, and a metric over axes: what they are given, what they say without JavaScript, and driven in a real browser."""

import copy
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from testbed import fly
from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.flight.record import FlightRecord
from testbed.run.job import Job, run_job
from testbed.show import close_up, key_frames, player
from testbed.show.close_up import EVERY
from testbed.show.page import render_page
from testbed.show.words import number
from tests.plans import PAPER_ROUTE, paper_obstacle, plan

Row = dict[str, Any]
HZ = 120
WINDS = ("0", "10")


def _plan(plant: str, method: str, wind: str) -> FlightPlan:
    labels = {"plant.kind": plant, "method.kind": method, "air.wind.speed_mps": wind}
    name = f"{plant.replace('_', '')}-{method.replace('_', '')}-{wind}"
    air = {"wind": {"kind": "steady", "speed_mps": float(wind), "from_deg": 315}}
    return plan(
        flight_id=name, cell="/".join(labels.values()), labels=labels, plant={"kind": plant}, method={"kind": method}, air=air,
        obstacles=[paper_obstacle("azimuth_106")], begin={"climb_at_most_deg": 18},
    )  # fmt: skip


@pytest.fixture(scope="module")
def plans() -> list[FlightPlan]:
    """Two rungs, three methods, two winds; all cheap to fly."""
    told = [(p, m, w) for p in ("kinematic", "point_mass") for m in ("none", "scoam", "least_deflection") for w in WINDS]
    return [_plan(*one) for one in told]


@pytest.fixture(scope="module")
def flown(plans: list[FlightPlan]) -> tuple[list[Row], dict[str, Any]]:
    results = [run_job(Job(one, want_series=True)) for one in plans]
    rows = [json.loads(json.dumps(result.row)) for result in results]
    return rows, {row["flight_id"]: json.loads(json.dumps(result.series)) for row, result in zip(rows, results, strict=True)}


@pytest.fixture(scope="module")
def records(plans: list[FlightPlan]) -> dict[str, FlightRecord]:
    return {one.flight_id: fly(one) for one in plans}


@pytest.fixture(scope="module")
def html(flown: tuple[list[Row], dict[str, Any]]) -> str:
    about = {"name": "moving", "question": "Is it clear?", "seed": 1, "route": PAPER_ROUTE}
    return render_page(Campaign.model_validate(about), *flown, {"name": "moving"})


def _logged(record: FlightRecord, told: dict[str, Any], at_s: float) -> float:
    """The clearance that the flight logged at that instant, counted from where the close-up begins to count."""
    return float(record.columns["obstacle.O.clearance_m"][round((told["zero_s"] + at_s) * HZ)])


def test_every_sample_is_the_logged_clearance_of_its_tick(
    flown: tuple[list[Row], dict[str, Any]], records: dict[str, FlightRecord]
) -> None:
    for name, series in flown[1].items():
        told, record = series["close_up"], records[name]
        assert (told["hz"], told["zero_is"]) == (HZ, "decision")
        assert told["zero_s"] == pytest.approx(record.events[0].time_s, abs=1e-6)
        ticks = round(told["zero_s"] * HZ) + told["first"] + np.arange(len(told["clearance_m"]))
        clearance = record.columns["obstacle.O.clearance_m"]
        assert told["clearance_m"] == [round(float(c), 2) + 0.0 for c in clearance[ticks]]
        assert min(told["clearance_m"]) == round(float(clearance.min()), 2)
        assert told["nearest_s"] * HZ + told["zero_s"] * HZ == pytest.approx(int(np.argmin(clearance)), abs=1e-3)
        coarse = ticks[::EVERY]
        for axis, told_axis in enumerate("xyz"):
            assert np.allclose(told[told_axis], record.columns["own.pos_enu_m"][coarse, axis], atol=0.0051)
            assert np.allclose(told["obstacles"][0][told_axis], record.columns["obstacle.O.pos_enu_m"][coarse, axis], atol=0.0051)
            assert np.allclose(told["wind"][told_axis], record.columns["air.wind_enu_mps"][coarse, axis], atol=0.0051)
        assert np.allclose(told["bank_deg"], np.degrees(record.columns["own.bank_rad"][coarse]), atol=0.051)


def test_a_long_encounter_is_sampled_on_a_coarser_part_of_the_same_grid(records: dict[str, FlightRecord], monkeypatch: Any) -> None:
    record = records["kinematic-scoam-0"]
    clearance = record.columns["obstacle.O.clearance_m"]
    monkeypatch.setattr(close_up, "MOST_CLEARANCES", 100)
    told = close_up.close_up(record, clearance, np.zeros(len(clearance)))
    assert told is not None
    assert told["hz"] < HZ
    assert len(told["clearance_m"]) <= 100 + EVERY
    zero = round(told["zero_s"] * HZ)
    ticks = zero + (told["first"] + np.arange(len(told["clearance_m"]))) * round(HZ / told["hz"])
    assert told["clearance_m"] == [round(float(c), 2) + 0.0 for c in clearance[ticks]]
    assert zero in ticks


def test_a_stored_close_up_of_another_form_is_refused(flown: tuple[list[Row], dict[str, Any]]) -> None:
    told = flown[1]["kinematic-scoam-0"]["close_up"]
    assert close_up.fits(told)
    assert close_up.fits(None)
    for key, wrong in (
        ("clearance_m", told["clearance_m"][:-EVERY]), ("x", [*told["x"], 0.0]), ("hz", 0), ("first", 0.5), ("zero_is", "<b>"),
        ("obstacles", []), ("obstacles", [{"name": 3}]), ("decisions", [{"time_s": "0"}]), ("wind", None), ("bank_deg", ["x"]),
        ("nearest_s", 10**400), ("x", [None] * len(told["x"])),
    ):  # fmt: skip
        spoilt = copy.deepcopy(told) | {key: wrong}
        assert not close_up.fits(spoilt), key


def test_a_scene_has_the_worst_flown_flight_every_other_rung_and_the_one_without_avoidance(flown: tuple[list[Row], dict[str, Any]]) -> None:
    rows, series = copy.deepcopy(flown[0]), flown[1]
    for row in rows:
        row["least_clearance_m"] = {"none": -17.0, "scoam": 1.0, "least_deflection": 3.0}[row["method"]]
    worst = next(row for row in rows if row["flight_id"] == "pointmass-scoam-10")
    worst["least_clearance_m"] = -9.0
    found = player.scenes(rows, series, ["air.wind.speed_mps"])
    first = found[0]
    ghosts = [ghost.row["flight_id"] for ghost in first.ghosts]
    assert ghosts[first.focus] == "pointmass-scoam-10"
    assert set(ghosts) == {"kinematic-scoam-10", "pointmass-scoam-10", "pointmass-scoam-0", "pointmass-none-10"}
    assert [scene.title for scene in found] == ["SCOAM", "least deflection"]
    assert "no avoidance" in first.ghosts[ghosts.index("pointmass-none-10")].name
    assert player.player(found, {name: one | {"close_up": None} for name, one in series.items()}) is None  # a run from before


def test_key_frames_say_the_logged_clearances_without_javascript(
    html: str, flown: tuple[list[Row], dict[str, Any]], records: dict[str, FlightRecord]
) -> None:
    found = player.scenes(*flown, ["air.wind.speed_mps"])
    ghosts = found[0].ghosts
    focus = flown[1][ghosts[found[0].focus].row["flight_id"]]["close_up"]
    section = html[html.index('<section id="encounter"') :].split("</section>", maxsplit=1)[0]
    assert section.count('<svg viewBox="0 0 320') == len(re.findall(r"<figure><figcaption>", section)) >= 3
    for instant in (0.0, focus["nearest_s"]):
        for ghost in ghosts:
            name = ghost.row["flight_id"]
            told = flown[1][name]["close_up"]
            logged = _logged(records[name], told, instant)
            assert key_frames.clearance_at(told, instant) == pytest.approx(logged, abs=0.0051)
            assert f">{number(key_frames.clearance_at(told, instant), 2)}</td>" in section
    for title in ("decides", "Closest approach", "Afterwards", "wind 10.0 m/s from 315°"):
        assert title in section


def test_hostile_names_stay_words(flown: tuple[list[Row], dict[str, Any]]) -> None:
    rows, series = copy.deepcopy(flown)
    for row in rows:
        row["labels"]["reading"] = "</script><img src=x>"
    for one in series.values():
        one["close_up"]["obstacles"][0]["name"] = one["close_up"]["decisions"][0]["obstacle"] = "<img src=y>"
    about = {"name": "m", "question": "q", "seed": 1, "route": PAPER_ROUTE}
    assert "<img" not in render_page(Campaign.model_validate(about), rows, series, {})


@pytest.mark.slow
@pytest.mark.browser
def test_it_plays_scrubs_and_pauses_and_its_clearance_is_the_record_s(
    browser: Any, html: str, flown: tuple[list[Row], dict[str, Any]], records: dict[str, FlightRecord], tmp_path: Path
) -> None:
    """Keys, mouse and time; two schemes and widths; without JavaScript. No error, and no request."""
    (tmp_path / "index.html").write_text(html, encoding="utf-8")
    problems: list[str] = []

    def opened(motion: str, scheme: str, width: int) -> Any:
        page = browser.new_page(color_scheme=scheme, reduced_motion=motion, viewport={"width": width, "height": 900})
        page.on("console", lambda message: problems.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("request", lambda request: None if request.url.startswith(("file:", "data:", "blob:")) else problems.append(request.url))
        page.goto((tmp_path / "index.html").as_uri())
        page.wait_for_selector(".ep.live", timeout=60_000)
        return page

    def at(page: Any) -> float:
        page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        return float(page.get_attribute("#ep", "data-t"))

    def same_as_the_records(page: Any) -> None:
        instant = at(page)
        cells = page.locator("#ep-rows td.ep-cell")
        assert cells.count() == 4
        for k in range(cells.count()):
            cell = cells.nth(k)
            name = cell.get_attribute("data-flight")
            told = flown[1][name]["close_up"]
            if not 0 <= round(instant * HZ) - told["first"] < len(told["clearance_m"]):
                assert cell.inner_text() == "–"  # noqa: RUF001
                continue
            logged = round(_logged(records[name], told, instant), 2)
            assert cell.inner_text() == number(logged, 2), (name, instant)
            assert ("bad" in cell.get_attribute("class").split()) == (logged < 0.0)

    page = opened("reduce", "light", 1300)
    focus, other = player.scenes(*flown, ["air.wind.speed_mps"])
    told = flown[1][focus.ghosts[focus.focus].row["flight_id"]]["close_up"]
    assert page.get_attribute("#ep", "data-playing") == "false"  # motion was asked to be reduced: it rests at the closest approach
    assert at(page) == pytest.approx(told["nearest_s"], abs=1e-5)
    same_as_the_records(page)
    for milliseconds in (-400, 0, 333, 1000, 1771, 2500):
        page.locator("#ep-at").evaluate("(range, v) => { range.value = v; range.dispatchEvent(new Event('input')); }", milliseconds)
        assert at(page) == pytest.approx(milliseconds / 1000, abs=0.5 / HZ + 1e-6)
        same_as_the_records(page)
    page.locator("#ep").focus()
    page.keyboard.press("Home")
    start = at(page)
    page.keyboard.press("ArrowRight")
    assert at(page) == pytest.approx(start + 1 / 30, abs=1e-6)
    page.keyboard.press("End")
    assert at(page) > told["nearest_s"] + 1.0
    page.keyboard.press("Home")
    page.keyboard.press("Space")
    assert page.get_attribute("#ep", "data-playing") == "true"
    page.wait_for_function("(start) => Number(document.getElementById('ep').dataset.t) > start + 0.2", arg=start, timeout=30_000)
    page.keyboard.press("Space")
    assert page.get_attribute("#ep", "data-playing") == "false"
    same_as_the_records(page)
    assert "clear" in page.locator("#ep-said").inner_text()
    page.locator("#ep-hold").check()
    page.get_by_role("button", name="closest approach").click()
    assert at(page) == pytest.approx(told["nearest_s"], abs=1e-5)
    same_as_the_records(page)
    drawn = "(id) => new Set(new Uint32Array(document.getElementById(id).getContext('2d').getImageData(0, 0, 400, 200).data.buffer)).size"
    for view in ("ep-plan", "ep-side", "ep-chase", "ep-strips"):
        assert page.evaluate(drawn, view) > 8, view  # blank would be one
    page.locator("#ep-scene").select_option("1")
    assert page.locator("#ep-rows td.ep-cell").first.get_attribute("data-flight") == other.ghosts[0].row["flight_id"]
    page.emulate_media(media="print")
    assert page.locator(".ep-frames svg").first.is_visible()
    assert page.locator("table.ep-static").is_visible()
    assert not page.locator("#ep-plan").is_visible()
    assert not page.locator("#ep-rows").is_visible()
    page.close()

    page = opened("no-preference", "dark", 400)
    page.locator("#ep-plan").scroll_into_view_if_needed()
    page.wait_for_function("() => Number(document.getElementById('ep').dataset.t) > 0", timeout=30_000)  # it begins by itself
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.close()

    page = browser.new_page(java_script_enabled=False)
    page.goto((tmp_path / "index.html").as_uri())
    assert page.locator(".ep-frames svg").first.is_visible()
    assert not page.locator("#ep").is_visible()
    page.locator("label.oa-label", has_text="load factor").click()  # the metric is chosen without JavaScript too
    assert page.locator(".oa-1").first.is_visible()
    assert not page.locator(".oa-0").first.is_visible()
    page.close()
    assert problems == []


def test_number_of_the_least_clearance_is_that_of_the_row(html: str, flown: tuple[list[Row], dict[str, Any]]) -> None:
    """The column 'least' also counts what lies between ticks: it is the row's."""
    section = html[html.index('<table class="ep-table ep-static">') :].split("</table>", maxsplit=1)[0]
    for ghost in player.scenes(*flown, ["air.wind.speed_mps"])[0].ghosts:
        least = ghost.row["least_clearance_m"]
        assert math.isfinite(least)
        assert f">{number(least, 2)}</td>" in section
