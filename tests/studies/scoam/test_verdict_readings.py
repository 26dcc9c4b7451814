"""Readings of the method: their words, their figures, and that the independent judge comes to the same."""

import csv
import io
import math

import pytest

from reports.verify.paper.flights import Flights as JudgesFlights
from reports.verify.paper.readings import compare_readings, judge_reading_of_method
from testbed.studies.scoam.page import readings as page
from testbed.studies.scoam.verdict import csv_bytes, judge, readings_bytes
from testbed.studies.scoam.verdict.csv_file import READING_COLUMNS
from tests.studies.scoam.verdict_rows import AIRCRAFT, row, threat

NO_WAY = "of 36 ends none is within the aircraft's limits: {}, which can be kept one by one but not together"


def flown(method, rails, calm, encounters=("single_106",), aircraft=AIRCRAFT, part="readings", **more):
    """Flights of a reading, each with the one without planner."""
    out = []
    for encounter in encounters:
        for name in aircraft:
            for rung, value in (("kinematic", rails), ("point_mass", rails), ("jsbsim", calm)):
                where = {"part": part, "encounter": encounter, "aircraft": name, "rung": rung, **more}
                out += [threat(**where), row(value, method=method, **where)]
    return out


def windy(method, rails, air, **more):
    there = {"part": "readings_wind", "design": "anchored", "wind_mps": "10", **more}
    return [one for side in "NE" for one in flown(method, rails, air, wind_from=side, **there)]


def population(method, clearances):
    return [
        one
        for n, value in enumerate(clearances)
        for one in flown(method, value, value, ("class",), ("gtm_t2",), "readings_population", replicate=n)
    ]


def lost(limits, **where):
    """A flight whose planner found no path: twice, of which the first time counts."""
    one = row(-17.0, method="scoam_flyable", **where)
    events = [{"decision": "no_path", "reason": NO_WAY.format(limits)}, {"decision": "no_path", "reason": NO_WAY.format("bank")}]
    return one | {"events": events}


def as_the_judge_reads(rows):
    """The same flights as ``reports/verify`` has them."""
    told = []
    for one in rows:
        labels = {f"label.{axis}": value for axis, value in one["labels"].items()}
        reason = next((event["reason"] for event in one["events"] if event["decision"] == "no_path"), "")
        told.append({name: value for name, value in one.items() if name not in ("labels", "events")} | labels | {"no_path": reason})
    return JudgesFlights(told)


def word(*rows):
    """Of the reading ``scoam_behind``; the independent judge says the same."""
    every = [one for some in rows for one in some]
    (claim,) = (one for one in judge(every).readings if one.key == "readings.scoam_behind")
    judged = judge_reading_of_method(as_the_judge_reads(every), claim.key)
    assert judged.word == claim.word
    assert judged.columns["flown_air_n"] == claim.flown_air.n
    return claim.word


B = "scoam_behind"


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([flown(B, -1.0, 5.0)], "fails kinematically"),
        ([flown(B, 2.0, -1.0), flown(B, -2.0, 1.0, ("multi_o2_up",))], "fails when flown"),
        ([flown(B, 2.0, 1.0), flown(B, -2.0, 1.0, ("multi_o2_up",))], "holds only if"),
        ([flown(B, 2.0, 1.0), windy(B, 1.0, -1.0)], "holds only if"),
        ([flown(B, 2.0, 1.0), windy(B, -1.0, -1.0)], "holds only if"),  # in that wind it fails on rails already: no wind counts
        ([flown(B, 2.0, 1.0), windy(B, 1.0, 1.0)], "too few to say"),
        ([flown(B, 2.0, 1.0, ("overtaken",))], "not determined"),  # shown, not judged
    ],
)
def test_a_reading_is_judged_as_a_promise_without_draws(rows, expected):
    assert word(*rows) == expected


def test_a_reading_that_holds_everywhere_was_still_not_varied():
    steady = [windy(B, 1.0, 1.0, replicate=n) for n in range(20)]
    assert word(flown(B, 2.0, 1.0), *steady) == "not determined"


def everything():
    own, other = [1.0, -1.0, -2.0, -3.0, 2.0, -4.0, -5.0, 3.0], [1.0, 2.0, 1.0, -2.0, 4.0, -3.0, 6.0, 5.0]
    rows = [*flown("scoam", 2.0, -3.0), *flown(B, 1.0, -9.0), *windy("scoam", 2.0, -3.0), *windy(B, 1.0, -4.0)]
    rows += [*population("scoam", own), *population(B, other)]
    where = {"part": "readings", "rung": "kinematic", "encounter": "single_106"}
    rows += [lost("roll rate", aircraft="c172p", **where), lost("climb angle and roll rate", aircraft="gtm_t2", **where)]
    return rows + [lost("roll rate", part="readings_population", rung="kinematic", encounter="class", replicate=n) for n in range(2)]


def test_figures_are_of_threats_in_pairs_and_say_what_forbids_a_path():
    verdict = judge(everything())
    cells = {(c.method, c.part, c.aircraft, c.rung): c for c in verdict.reading_cells}
    of_class = cells[B, "readings_population", "gtm_t2", "jsbsim"]
    assert (of_class.n, of_class.kept, of_class.pairs, of_class.other, of_class.only_this, of_class.only_own) == (8, 6, 8, 7, 3, 0)
    assert of_class.mcnemar_p == pytest.approx(0.25)
    assert of_class.difference.value == pytest.approx(2.0)  # of 0, 3, 3, 1, 2, 1, 11, 2
    own = cells["scoam", "readings_population", "gtm_t2", "jsbsim"]
    assert (own.pairs, math.isnan(own.mcnemar_p)) == (0, True)
    assert cells["scoam_flyable", "readings_population", "gtm_t2", "kinematic"].forbidden_by == "roll rate 2"
    (flyable,) = (claim for claim in verdict.readings if claim.key == "readings.scoam_flyable")
    assert (flyable.text, flyable.deciding_limit) == ("the paper's own step 5 (iii) taken seriously", "roll rate")
    assert "On rails no path is found in 4 of 4 flights: roll rate in 3; climb angle and roll rate in 1." in flyable.why
    assert not any("nan" in claim.why for claim in verdict.readings)


def test_the_file_is_computed_again_by_the_independent_judge_and_a_changed_line_is_named(tmp_path):
    rows, file = everything(), tmp_path / "readings.csv"
    verdict = judge(rows)
    file.write_bytes(readings_bytes(verdict))
    assert compare_readings(file, as_the_judge_reads(rows)) == (len(verdict.reading_cells), [])
    lines = file.read_text().splitlines()
    n = next(n for n, line in enumerate(lines) if line.startswith("scoam_behind,readings_population"))
    for column, bad in (("kept", "7"), ("difference_low", "9"), ("other", "8")):
        spoilt = lines[n].split(",")
        spoilt[READING_COLUMNS.index(column)] = bad
        file.write_text("\n".join([*lines[:n], ",".join(spoilt), *lines[n + 1 :]]) + "\n")
        _, unlike = compare_readings(file, as_the_judge_reads(rows))
        assert [one.quantity for one in unlike] == [column]
    file.write_text("\n".join(line.replace("roll rate 2", "roll rate 1") for line in lines[:n] + lines[n + 1 :]) + "\n")
    _, unlike = compare_readings(file, as_the_judge_reads(rows))
    assert {(one.quantity, one.said) for one in unlike} == {("line", "lacking"), ("forbidden_by", "roll rate 1")}


def test_no_other_claim_counts_them_and_they_stand_last_in_the_file():
    kept = [row(2.0), threat()]
    assert csv_bytes(judge([*kept, *everything()])).startswith(csv_bytes(judge(kept)))
    assert judge(kept).readings == judge(kept).reading_cells == ()
    keys = [line["key"] for line in csv.DictReader(io.StringIO(csv_bytes(judge(everything())).decode()))]
    assert keys[-3:] == ["readings.scoam", "readings.scoam_behind", "readings.scoam_flyable"]


def test_the_page_has_a_line_a_reading_with_the_share_beside_the_paper_s_own():
    own, behind, flyable = page.reading_rows(judge(everything()))
    assert own["population"][1] == {"text": "3 of 8", "note": "9 to 76 %"}
    assert behind["population"][1]["text"] == "6 of 8"
    assert behind["population"][1]["note"].endswith(", p = 0.25")
    assert (behind["cells"][0], behind["word"]) == ("1.0 m", "fails when flown")
    assert flyable["no_path"] == "4 of 4"
