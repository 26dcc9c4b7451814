"""The verdict's part of the page: every claim is there, its numbers are the verdict's, nothing breaks when parts are missing."""

import csv
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from ruamel.yaml import YAML

from testbed.core.catalogue import aircraft_folders
from testbed.flight.record import FlightRecord
from testbed.results.columns import FlightMetrics
from testbed.results.statistics import Effect, Spread
from testbed.show.page import render_page
from testbed.show.series import flight_series
from testbed.studies.scoam.claim import HOLDS, TOO_FEW, VERDICT_WORDS, Claim, Control, Rank, Step, Waterfall
from testbed.studies.scoam.page import bars, detail, picture_data, quotable, reference, render, table, top
from testbed.studies.scoam.verdict.judged import ReadingCell
from tests.show.test_page import NASTY, PROVENANCE, campaign, flight, parsed

MakeRecord = Callable[..., FlightRecord]
MakeMetrics = Callable[[FlightRecord], FlightMetrics]
Row = dict[str, Any]
NAN = math.nan
NO_EFFECT = Effect("", "", NAN, NAN, NAN, 0)


def claim(key: str, word: str = "holds", **changes: Any) -> Claim:
    settings: dict[str, Any] = {
        "key": key, "where": "Section 5.1" if key.startswith("words") else f"Table {key[5]}", "text": f"text of {key}", "paper": "11.9",
        "unit": "m", "quantity": "least clearance", "reading": "single_106", "aircraft": "gtm_t2", "kinematic": 2.67, "point_mass": -2.0,
        "flown_calm": -3.77, "flown_air": Spread(-6.1, -3.8, -2.4, 39), "word": word,
        "condition": "the wind is below 5 m/s" if word == "holds only if" else "",
        "effect": Effect("share kept", "share", 0.25, 0.21, 0.29, 400), "robustness_share": 0.9742, "robustness_n": 500,
        "deciding_limit": "roll", "why": f"Because of {key}, gtm_t2 keeps -3.8 m (eq. 34-35)",
    }  # fmt: skip
    return Claim(**(settings | changes))


def rank(method: str, safe: int, **changes: Any) -> Rank:
    three = Spread(-9.5, 1.25, 7.5, 1000)
    told = Effect("difference", "m", 0.42, 0.31, 0.53, 1000)
    return replace(
        Rank("kinematic", method, 1000, safe, safe / 1000 - 0.03, safe / 1000 + 0.03, three, three, three, three, three, told, 0.0004),
        **changes,
    )


def reading_cell(rung: str, kept: int, **changes: Any) -> ReadingCell:
    who = ("scoam_flyable", "readings_population", "class", "gtm_t2", rung)
    told = Effect("difference", "m", -1.5, -2.25, -0.5, 50)
    return replace(ReadingCell(*who, 50, kept, 0.13, 0.38, Spread(-9.5, -4.0, 1.5, 50), 50, 44, 3, 12, 0.0352, told, 0, ""), **changes)


@pytest.fixture
def verdict() -> SimpleNamespace:
    """One claim of each word, a number under two readings, and one of everything else."""
    words = [claim(f"words.{k}", word) for k, word in enumerate(VERDICT_WORDS)]
    numbers = [
        claim("table4.scoam.time", "fails kinematically", unit="s", kinematic=1.684, paper="1.19", text="SCOAM time"),
        claim("table2.scoam.deflection", "holds only if", unit="deg", kinematic=12.23, text="SCOAM deflection"),
        claim("table2.scoam.deflection@single_106", "holds only if", unit="deg", kinematic=12.23, why="the same as above"),
        claim("table2.scoam.deflection@single_106_10", "fails kinematically", unit="deg", kinematic=10.73, reading="single_106_10"),
    ]
    steps = (Step("vo_instant", 0.0, NAN), Step("kinematic", 2.7, 2.7), Step("jsbsim", -3.8, -6.5), Step("wind", -4.3, -0.5))
    cell = {"encounter": "single_106", "method": "scoam", "aircraft": "gtm_t2", "rung": "jsbsim", "flights": 8, "threats": 7, "kept": 3}
    cell |= {"low": 0.1, "high": 0.82, "at_least": 0.13, "marginal": 1, "fail_on_rails": 2, "clearance": Spread(-5.0, -1.0, 3.0, 7)}
    case = {"encounter": "single_106", "aircraft": "gtm_t2", "method": "scoam", "rung": "jsbsim", "clearance_m": -3.77, "replans": 1}
    case |= {key: 7.5 for key, _, _ in detail.CASE_COLUMNS if key != "clearance_m"}
    return SimpleNamespace(
        claims=(*numbers, *words),
        waterfalls=(Waterfall("single_106", "scoam", "gtm_t2", steps, {"roll": 2.9}, {"roll": 2.5}),),
        controls=(Control("gentle", "every method keeps the radius", 40, 40, ""), Control("odd", "none does", 7, 8, "f1 (-3.0 m)")),
        ranks=(rank("droam_hp", 480), rank("scoam", 610, versus_scoam=NO_EFFECT, mcnemar_p=NAN)),
        cases=(SimpleNamespace(**case),),
        air=tuple(
            SimpleNamespace(design=d, strength=s, **cell) for d, s in (("anchored", "5"), ("ground_fixed", "10"), ("turbulence", "light"))
        ),
        counted=(SimpleNamespace(part="calm", flights=840, silent=2, marginal=7, replicates=1),),
        readings=(claim("readings.scoam_flyable", "fails kinematically", text="step (iii) taken seriously"),),
        reading_cells=(reading_cell("kinematic", 0, no_path=39, forbidden_by="roll rate 30; climb angle 9"), reading_cell("jsbsim", 12)),
    )


@pytest.fixture
def flown(make_record: MakeRecord, make_metrics: MakeMetrics) -> tuple[list[Row], dict[str, Any]]:
    """The flights of the pictures, of two aircraft, and one that is in none."""
    rows, series = [], {}
    for aircraft in ("gtm_t2", "c172p"):
        for one in (*picture_data.PICTURED, None):
            labels = {"encounter": "single_106", "method": "scoam", "flown_by": aircraft, **(one.labels if one else {"part": "population"})}
            kind = labels.get("rung") if labels.get("rung") in ("kinematic", "point_mass", "jsbsim") else "jsbsim"
            name = f"f{aircraft}{one.key if one else 'other'}"
            changes = {"method": {"kind": "scoam"}, "plant": {"kind": kind}, "aircraft": aircraft}
            record = make_record(flight_id=name, cell=name, labels=labels, **changes)
            rows.append(flight(record, make_metrics(record), f"recordings/{name}.rrd"))
            series[name] = flight_series(record)
    return rows, series


def text_of(html: str) -> str:
    return " ".join(" ".join(parsed(html).text).split())


def test_every_claim_with_its_numbers_is_in_the_table(verdict: SimpleNamespace) -> None:
    text = text_of(render(verdict, [], {}).html)
    for k, word in enumerate(VERDICT_WORDS):
        row = text[text.index(f"text of words.{k} ") :][:900]
        assert word in row
        assert "2.7 m −2.0 m −3.8 m −6.1 to −2.4 m median −3.8 m, n = 39" in row  # noqa: RUF001
        assert f"Because of words.{k}, GTM-T2 keeps −3.8 m (eq. 34-35). share kept: 25 % (95 % interval 21 to 29 %, n = 400)" in row  # noqa: RUF001
        assert "roll 97 % of 500 draws" in row
    assert "holds only if the wind is below 5 m/s" in text
    order = [
        text.index(part) for part in ("Claims in words", "text of words.0", "Numbers of Table 2", "SCOAM deflection", "Numbers of Table 4")
    ]
    assert order == sorted(order)


def test_readings_of_the_method_have_a_table_of_their_own(verdict: SimpleNamespace) -> None:
    page = render(verdict, [], {})
    text = text_of(page.html)
    assert ("verdict-readings", "Readings") in page.nav
    assert "step (iii) taken seriously 2.7 m −2.0 m −3.8 m −6.1 to −2.4 m 0 of 50 13 to 38 %, p = 0.035 12 of 50" in text  # noqa: RUF001
    assert "39 of 50 fails kinematically" in text
    assert "44 of 50 −1.5 −2.2 to −0.5 m p = 0.035 39 roll rate 30; climb angle 9" in text  # noqa: RUF001
    assert "step (iii)" not in text[: text.index("The method as it may be read")]  # no claim of the leading table
    verdict.readings = verdict.reading_cells = ()
    assert "The method as it may be read" not in render(verdict, [], {}).html


def test_readings_of_a_number_stand_together_and_none_is_said_twice(verdict: SimpleNamespace) -> None:
    (_, group, _) = table.groups(verdict.claims)
    (block,) = group["blocks"]
    assert [(row["lesser"], row["cells"][0], row["word"]) for row in block["rows"]] == [
        (False, "12.2 deg", "holds only if"),
        (True, "10.7 deg", "fails kinematically"),
    ]
    assert "the same as above" not in text_of(render(verdict, [], {}).html)


def test_a_quick_run_is_read_beside_the_committed_one(verdict: SimpleNamespace) -> None:
    with (Path(__file__).parents[3] / "reports" / "paper" / "verdict.csv").open(newline="", encoding="utf-8") as file:
        committed = {line["key"]: line["word"] for line in csv.DictReader(file)}
    same = [claim(key, word) for key, word in committed.items()]
    assert reference.note(same) == ""
    assert reference.same_as(same) == f"All {len(committed)} words are those of the committed reference."
    other = {"words.single.safe": "too few to say", "words.overload": "holds"}
    quick = [replace(one, word=other.get(one.key, one.word)) for one in same]
    assert [one.key for one in quick if reference.other_word(one)] == [key for key in committed if key in other]
    assert reference.same_as(quick) == ""
    verdict.claims = tuple(quick)
    text = text_of(render_page(campaign(), [], {}, PROVENANCE, head=render(verdict, [], {})))
    assert f"2 of {len(committed)} words differ from the committed reference." in text
    assert "1 is withheld here, for want of flights or draws; 1 says something else: Section 5.1, text of words.overload." in text
    assert text.count("\N{NOT EQUAL TO} reference: ") == 2
    assert f"\N{NOT EQUAL TO} reference: {committed['words.overload']}" in text


def test_a_number_has_the_decimals_that_the_paper_prints(verdict: SimpleNamespace) -> None:
    (row,) = table.groups([verdict.claims[0]])[0]["blocks"][0]["rows"]
    assert row["paper"] == "1.19 s"
    assert row["cells"][0] == "1.68 s"


def test_the_sentences_count_and_name_what_the_claims_are(verdict: SimpleNamespace) -> None:
    told = {heading: " ".join(sentences) for heading, sentences, _ in quotable.paragraphs(verdict)}
    short = told["In short"]
    assert short.startswith("Of the paper's claims in words, 6 in all, 1 holds, 1 holds only under a condition, 1 fails kinematically")
    assert "1 is withheld for want of flights." in short
    assert "Of the numbers in its tables, 2 in all, 1 holds only under a condition and 1 fails kinematically" in short
    one = (
        "Section 5.1, text of words.1: holds only if the wind is below 5 m/s; least clearance 2.7 m on rails and −3.8 m flown in calm air."  # noqa: RUF001
    )
    assert one in told["Claim by claim"]
    assert "2.7 m through the insertion point, kinematically, −3.8 m flown in calm air" in told["Where the metres go"]  # noqa: RUF001
    rivals = told["Against the other methods"]
    assert rivals.index("SCOAM in 61 % (58 to 64 %)") < rivals.index("DROAM/HP in 48 %")
    trust = told["Can the flights be trusted?"]
    assert "Of 2 controls, 1 came out as expected in every flight. Odd (expected: none does) came out so in 7 of 8 flights." in trust
    assert "Of 840 flights, 2 said nothing" in trust


def test_no_number_of_the_sentences_is_the_programs_own(verdict: SimpleNamespace) -> None:
    """Without any finite figure only the counts, the names and the level of the intervals are left."""
    bare = [
        replace(
            one, kinematic=NAN, point_mass=NAN, flown_calm=NAN, flown_air=Spread(NAN, NAN, NAN, 0), effect=NO_EFFECT, robustness_n=0,
            why="", paper="", where="Abstract", condition="", text="x", key=f"words.{k}",
        )
        for k, one in enumerate(verdict.claims[-6:])
    ]  # fmt: skip
    nothing = SimpleNamespace(
        claims=bare, waterfalls=(), controls=(), ranks=(), cases=(), air=(), counted=(), readings=(), reading_cells=()
    )
    text = " ".join(sentence for _, sentences, _ in quotable.paragraphs(nothing) for sentence in sentences)
    assert re.findall(r"\d+", text) == ["6", *["1"] * 6]


@pytest.mark.parametrize("part", ["claims", "waterfalls", "controls", "ranks", "cases", "air", "counted"])
def test_a_part_that_is_missing_is_left_out(verdict: SimpleNamespace, flown: tuple[list[Row], dict[str, Any]], part: str) -> None:
    whole, less = render(verdict, *flown), None
    setattr(verdict, part, ())
    less = render(verdict, *flown)
    assert len(less.html) < len(whole.html)
    ids = {attributes.get("id") for _, attributes in parsed(less.html).tags}
    assert {anchor for anchor, _ in less.nav} <= ids
    assert "nan" not in text_of(less.html).replace("nano", "").lower().split()


def test_nothing_at_all() -> None:
    nothing = SimpleNamespace(claims=(), waterfalls=(), controls=(), ranks=(), cases=(), air=(), counted=(), readings=(), reading_cells=())
    head = render(nothing, [], {})
    assert not head.nav
    assert "<section" not in head.html
    assert "No flight was flown." in render_page(campaign(), [], {}, PROVENANCE, head=head)


def test_words_from_outside_stay_words(verdict: SimpleNamespace, flown: tuple[list[Row], dict[str, Any]]) -> None:
    verdict.claims = tuple(
        replace(one, why=NASTY, text=NASTY, where=NASTY, condition=NASTY, quantity=NASTY, deciding_limit=NASTY, reading=NASTY, paper=NASTY)
        for one in verdict.claims
    )
    verdict.controls = (Control(NASTY, NASTY, 1, 2, NASTY),)
    verdict.ranks = tuple(replace(one, rung=NASTY, method=NASTY) for one in verdict.ranks)
    steps = (Step(NASTY, 1.0, NAN), Step(NASTY, 2.0, 1.0))
    verdict.waterfalls = (Waterfall("single_106", "scoam", NASTY, steps, {NASTY: 1.0}, {}),)
    flown[0][0]["recording"] = NASTY
    page = parsed(render(verdict, *flown).html)
    assert not [tag for tag, attributes in page.tags if tag == "img" or "onerror" in attributes]
    assert [attributes.get("id") for tag, attributes in page.tags if tag == "script"] == ["verdict-data"]


def test_a_bar_of_a_waterfall_is_as_long_as_its_step() -> None:
    """Also where a step does not start from the row above: turbulence and wind both start from calm air."""
    steps = (Step("vo_instant", 1.0, NAN), Step("jsbsim", -4.0, -5.0), Step("wind", -6.0, -2.0), Step("turbulence", -3.0, 1.0))
    svg = str(bars.waterfall_svg(Waterfall("single_106", "scoam", "gtm_t2", steps, {}, {})))
    groups = re.findall(r'<g class="(\w+)"><title>[^<]*</title><rect x="([\d.]+)" y="\d+" width="([\d.]+)"[^>]*/><line x1="([\d.]+)"', svg)
    kinds, lefts, widths, ends = zip(*groups, strict=True)
    assert kinds == ("start", "lost", "lost", "won")
    metre = (float(ends[0]) - float(ends[1])) / 5.0
    assert [float(width) / metre for width in widths] == pytest.approx([1.0, 5.0, 2.0, 1.0], abs=0.02)
    assert (float(ends[3]) - float(ends[2])) / metre == pytest.approx(3.0, abs=0.02)
    assert float(lefts[2]) == float(ends[2])  # what is lost ends on the left


def test_an_interval_is_drawn_to_scale() -> None:
    svg = str(bars.share_svg([rank("scoam", 500, safe_low=0.4, safe_high=0.7)]))
    ((low, high, middle),) = re.findall(r'<line x1="([\d.]+)" x2="([\d.]+)" y1="[\d.]+" y2="[\d.]+"/><circle cx="([\d.]+)"', svg)
    assert (float(middle) - float(low)) / (float(high) - float(low)) == pytest.approx(1 / 3, abs=0.005)


def test_the_designs_of_wind_are_never_in_one_table(verdict: SimpleNamespace) -> None:
    made = detail.air_tables(verdict.air)
    assert [(one["title"].split(":")[0], one["headings"], len(one["rows"])) for one in made] == [
        ("Anchored", ["5 m/s"], 1),
        ("Ground-fixed", ["10 m/s"], 1),
        ("Turbulence", ["light"], 1),
    ]
    (cell,) = made[0]["rows"][0]["cells"]
    assert cell["text"] == "3 of 7"
    assert cell["note"] == "10 to 82 %; median −1.0 m; a threat in 7 of 8; 2 fail kinematically"  # noqa: RUF001


def test_the_pictures_take_one_flight_each_and_the_limits_of_the_aircraft(flown: tuple[list[Row], dict[str, Any]]) -> None:
    data = picture_data.picture_data(*flown)
    assert list(data["aircraft"]) == ["gtm_t2", "c172p"]
    for name, panel in data["aircraft"].items():
        assert list(panel["flights"]) == [one.key for one in picture_data.PICTURED]
        said = YAML(typ="safe").load(aircraft_folders()[name] / "aircraft.yaml")["limits"]
        assert panel["limits"] == {
            "bank_deg": said["bank_deg"],
            "load_factor": said["load_factor_max"],
            "roll_rate_dps": said["roll_rate_dps"],
        }
    labels = dict(flown[0][0]["labels"])
    assert picture_data.picture_of(labels, 0)
    assert not picture_data.picture_of(labels, 1)
    assert not picture_data.picture_of(labels | {"method": "droam_hp"}, 0)
    assert not picture_data.picture_of(labels | {"encounter": "multi_o2_up"}, 0)


def test_the_flights_shown_can_be_opened_and_flown_again(verdict: SimpleNamespace, flown: tuple[list[Row], dict[str, Any]]) -> None:
    page = parsed(render(verdict, *flown).html)
    links = [attributes["href"] for tag, attributes in page.tags if tag == "a"]
    shown = [row["flight_id"] for row in flown[0] if not row["flight_id"].endswith("other")]
    assert links == [f"recordings/{name}.rrd" for name in shown]
    assert [attributes["data-text"] for tag, attributes in page.tags if tag == "button" and "data-text" in attributes] == [
        f"testbed replay . {name}" for name in shown
    ]


def test_the_verdict_comes_first_and_the_ordinary_page_is_folded_below(
    verdict: SimpleNamespace, flown: tuple[list[Row], dict[str, Any]]
) -> None:
    once, twice = (render_page(campaign(), *flown, PROVENANCE, head=render(verdict, *flown)) for _ in range(2))
    assert once == twice
    assert len(once.encode()) < 3_000_000
    text = text_of(once)
    order = [
        "The paper's claims, judged",
        "The verdict in words",
        "Everything that was flown",
        "Of 18 flights,",
        "Largest roll rate, either side.",
    ]
    assert [text.index(part) for part in order] == sorted(text.index(part) for part in order)
    plain = render_page(campaign(), *flown, PROVENANCE)
    assert 'id="everything"' not in plain
    assert "verdict-data" not in [attributes.get("id") for _, attributes in parsed(plain).tags]


@pytest.mark.slow
@pytest.mark.browser
def test_a_browser_draws_both_aircraft_and_opens_the_fold(
    browser: Any, verdict: SimpleNamespace, flown: tuple[list[Row], dict[str, Any]], tmp_path: Path
) -> None:
    (tmp_path / "index.html").write_text(render_page(campaign(), *flown, PROVENANCE, head=render(verdict, *flown)), encoding="utf-8")
    problems: list[str] = []
    for scheme, width in (("light", 1300), ("dark", 390)):
        page = browser.new_page(color_scheme=scheme, viewport={"width": width, "height": 900})
        page.on("console", lambda message: problems.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("request", lambda request: None if request.url.startswith(("file:", "data:", "blob:")) else problems.append(request.url))
        page.goto((tmp_path / "index.html").as_uri())
        page.wait_for_selector("body[data-ready]", timeout=60_000)
        assert page.get_attribute("body", "data-ready") == "1"
        for aircraft in ("gtm_t2", "c172p"):
            page.locator(f"#v-plan-{aircraft}").scroll_into_view_if_needed()  # drawn when it comes near
            page.wait_for_selector(f"#v-space-{aircraft} canvas", timeout=60_000, state="attached")
            assert page.locator(f"#v-plan-{aircraft} .scatterlayer .trace").count() > 8
            assert page.locator(f"#v-demand-{aircraft} .scatterlayer .trace").count() >= 6
            assert page.locator(f"#v-space-{aircraft} canvas").count() >= 1
        curves = page.locator("#v-clearance-gtm_t2 .scatterlayer .trace").count()
        page.locator("#v-chips .chip", has_text="point mass").click()
        assert page.locator("#v-clearance-gtm_t2 .scatterlayer .trace").count() < curves
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        page.locator("#verdict .opener").first.click()
        assert page.locator("#verdict .why-box p").first.is_visible()
        assert page.locator("#plan .trace").count() == 0  # folded up: not drawn yet
        page.locator("nav a", has_text="Pictures").click()
        page.wait_for_selector("#plan .scatterlayer .trace", timeout=30_000, state="attached")
        assert page.evaluate("document.getElementById('plan').clientWidth > 250")
        page.emulate_media(media="print")
        page.close()
    assert problems == []


def test_a_withheld_word_still_says_what_these_flights_did(verdict: SimpleNamespace) -> None:
    claim = replace(verdict.claims[0], key=top.LEADING, word=TOO_FEW, unit="m", kinematic=2.7, flown_calm=-3.4)
    assert top.answer((claim,), []).startswith("Not in these flights, which are too few for a verdict: on rails the re-planned path clears")
    kept = replace(claim, flown_calm=1.0)
    assert top.answer((kept,), []).startswith("In these flights, which are too few for a verdict: on rails")
    assert top.answer((replace(kept, word=HOLDS),), []).startswith("Yes: on rails")
