"""Numbers of Tables 2 and 4, controls, and the file: on rows made by hand, and on half of a campaign."""

import csv
import io
import math

import pytest

from testbed.studies.scoam.audit.audit import Figure
from testbed.studies.scoam.claim import VERDICT_WORDS
from testbed.studies.scoam.verdict import csv_bytes, csv_words, judge, numbers
from testbed.studies.scoam.verdict.controls import controls
from testbed.studies.scoam.verdict.csv_file import VERDICT_COLUMNS
from testbed.studies.scoam.verdict.flights import Flights
from tests.studies.scoam.verdict_rows import calm, drawn, population, rough, row, threat, windy

HALF_WIDTH = 0.5


class Audited:
    """A row of the audit with the same half-width everywhere: tolerances are then half a unit plus 0.5."""

    figures = dict.fromkeys(
        ("as_printed", "azimuth_106", "direction_106_10", "o2_elevation_plus"), Figure(math.nan, HALF_WIDTH, False, math.nan, HALF_WIDTH)
    )
    met_by = ()

    def __init__(self, *assumptions):
        self.assumptions = assumptions


@pytest.fixture
def audited(monkeypatch):
    rows = {}
    for table in "24":
        for what in ("deflection", "length", "time"):
            unprinted = ("ph_magnitudes",) if what == "length" else ()
            rows[f"t{table}.scoam_{what}"] = Audited(*unprinted)
            rows |= {f"t{table}.{plane}_{what}": Audited("droam", *unprinted) for plane in ("hp", "vp")}
    monkeypatch.setattr(numbers, "_audited", lambda: rows)


def claims(*rows):
    return {claim.key: claim for claim in numbers.numbers(Flights([one for some in rows for one in some]))}


def flown(rails, calm_air, encounter="single_106", metric="deflection_deg", **where):
    values = (("kinematic", rails), ("point_mass", rails), ("jsbsim", calm_air))
    return [row(1.0, rung=rung, encounter=encounter, **{metric: x}, **where) for rung, x in values]


def varied(pairs, metric="deflection_deg"):
    rows = []
    for n, values in enumerate(pairs):
        for rung, x in zip(("kinematic", "jsbsim"), values, strict=True):
            rows.append(row(1.0, part="robustness", rung=rung, replicate=n, **{metric: x}))
    return rows


SCOAM = "table2.scoam.deflection"  # 11.9, so that 11.35 to 12.45 meet it here


@pytest.mark.parametrize(
    ("rows", "word"),
    [
        (flown(12.4, 12.4), "holds only if"),
        (flown(12.44, 12.44), "holds only if"),  # by half a unit of the print
        (flown(12.4, 12.5), "fails when flown"),
        (flown(12.5, 11.9), "fails kinematically"),
        ([*flown(12.5, 11.9), *varied([(12.5, 12.5), (11.8, 13.0), (12.2, 13.0)])], "not determined"),
        ([*flown(12.5, 11.9), *varied([(12.5, 12.5), *[(12.6, 13.0), (13.2, 13.0)] * 36])], "fails kinematically"),
        ([*flown(12.5, 11.9), *varied([(12.5, 12.5), *[(12.6, 13.0)] * 71])], "too few to say"),
        ([], "not determined"),
    ],
)
def test_a_number_is_met_within_its_rounding_and_that_of_its_inputs(audited, rows, word):
    claim = claims(rows)[f"{SCOAM}@single_106"]
    assert claim.word == word
    assert claim.paper == "11.9"


def test_a_number_inside_the_flown_spread_is_met(audited):
    air = []
    for n in range(20):
        where = {"part": "turbulence", "severity": "light", "rung": "jsbsim", "replicate": n}
        air += [threat(**where), row(1.0, deflection_deg=11.0 + 0.1 * n, **where)]
    assert claims(flown(11.9, 13.0), air)[f"{SCOAM}@single_106"].word == "holds only if"
    assert claims(flown(11.9, 13.0))[f"{SCOAM}@single_106"].word == "fails when flown"


def test_the_kindest_reading_is_merged(audited):
    rows = [*flown(20.0, 20.0), *flown(11.9, 11.9, "single_106_10")]
    merged = claims(rows)[SCOAM]
    assert (merged.word, merged.reading) == ("holds only if", "single_106_10")
    assert merged.condition.startswith("the encounter is that of direction (106.1, 10.4) deg")
    assert "azimuth 106 deg: fails kinematically" in merged.why


def test_a_number_of_a_method_that_is_only_cited_decides_nothing_when_missed(audited):
    rows = [*flown(30.0, 30.0, method="droam_hp_left"), *flown(40.0, 40.0, method="droam_hp_right")]
    claim = claims(rows)["table2.droam_hp.deflection"]
    assert (claim.word, claim.kinematic) == ("not determined", 30.0)  # the lesser side


def test_the_other_side_of_droam_meets_under_a_condition(audited):
    rows = [*flown(12.0, 12.0, method="droam_vp_up"), *flown(20.6, 20.6, method="droam_vp_down")]
    claim = claims(rows)["table2.droam_vp.deflection"]  # 20.4
    assert (claim.word, claim.kinematic) == ("holds only if", 20.6)
    assert "DROAM takes the side with the greater deflection" in claim.condition


def test_a_flight_that_begins_late_is_given_the_arc_before_its_start(audited):
    rows = [row(1.0, rung=rung, path_length_m=470.0, begin_s_m=105.5) for rung in ("kinematic", "jsbsim")]
    claim = claims(rows)["table2.scoam.path_length@single_106"]  # 575.6
    assert (claim.kinematic, claim.word) == (575.5, "holds only if")


def test_a_length_that_rests_on_what_is_not_printed_fails_only_against_draws(audited):
    rows = [row(1.0, rung=rung, path_length_m=560.0) for rung in ("kinematic", "jsbsim")]
    key = "table2.scoam.path_length@single_106"
    assert claims(rows)[key].word == "not determined"
    few = claims(rows, varied([(560.0, 560.0), (561.0, 561.0), (563.0, 563.0)], "path_length_m"))[key]
    assert few.word == "too few to say"
    assert "None of 2 draws comes to the print, which does not settle whether 5 % would: it takes about 72." in few.why
    many = claims(rows, varied([(560.0, 560.0), *[(561.0, 561.0), (563.0, 563.0)] * 36], "path_length_m"))[key]
    assert many.word == "fails kinematically"


# ---- controls ----------------------------


def test_controls_count_what_they_expect_and_name_what_they_do_not():
    told = [row(x, part="controls", encounter="gentle", rung="jsbsim", method=m) for m, x in (("scoam", 1.0), ("droam_hp", -2.0))]
    told += [row(x, part="controls", encounter="impossible", rung="jsbsim", method="scoam") for x in (-17.0, 1.0)]
    harmless = [row(2.0, encounter="single_as_printed", replans=0), row(2.0, encounter="single_as_printed", replans=1)]
    found = {control.name: control for control in controls(Flights([*told, *harmless, threat()]))}
    assert {name: (c.met, c.n) for name, c in found.items() if c.n} == {
        "no planner": (1, 1),
        "no threat": (1, 2),
        "gentle": (1, 2),
        "impossible": (1, 2),
    }
    assert "droam_hp" in found["gentle"].exceptions
    assert "-2.0 m" in found["gentle"].exceptions


def test_anchored_wind_keeps_the_calm_miss():
    air = {"part": "wind", "design": "anchored", "wind_mps": "5", "method": "none"}
    rows = [threat(), threat(rung="jsbsim")]
    rows += [row(-17.0, wind_from="N", **air), row(-16.9, wind_from="S", **air)]
    rows += [row(-16.1, wind_from="N", rung="jsbsim", **air), row(-15.9, wind_from="S", rung="jsbsim", **air)]
    found = {control.name: (control.met, control.n) for control in controls(Flights(rows))}
    assert (found["anchored wind, on rails"], found["anchored wind, flown"]) == ((1, 2), (1, 2))


# ---- figures in sentences ----------------


@pytest.mark.parametrize(
    ("share", "text"), [(1.0, "100 %"), (0.9999, "99.9 %"), (0.004, "0.4 %"), (0.0, "0 %"), (0.853, "85 %"), (math.nan, "none")]
)
def test_a_share_is_never_rounded_up_to_all(share, text):
    assert csv_words.percent(share) == text


def test_figures_have_the_places_of_their_unit_and_no_negative_zero():
    assert [csv_words.say(-0.04, "m"), csv_words.say(-3.77, "m"), csv_words.say(1.234, "s"), csv_words.say(math.nan, "m")] == [
        "0.0 m",
        "-3.8 m",
        "1.23 s",
        "none",
    ]


# ---- the whole ---------------------------


def a_bit_of_everything():
    rows = [*calm(2.0, -3.0), *windy([-3.0, 1.0]), *rough([-2.0]), *drawn([(2.0, -3.0)] * 10)]
    return [*rows, *population([{"scoam": 1.0, "droam_hp": 2.0, "droam_vp": 0.5}] * 8, "least_clearance_m")]


@pytest.mark.parametrize("left_out", ["", "calm", "wind", "turbulence", "robustness", "population"])
def test_half_a_campaign_has_a_verdict(audited, left_out):
    rows = [one for one in a_bit_of_everything() if one["labels"]["part"] != left_out]
    verdict = judge(rows)
    assert len(verdict.leading) == 9 + 18
    assert len({claim.key for claim in verdict.claims}) == len(verdict.claims) == 9 + 18 + 9 * 5
    for claim in verdict.claims:
        assert claim.word in VERDICT_WORDS
        assert (claim.condition != "") == (claim.word == "holds only if"), claim.key
        assert claim.why.endswith(".")
        assert "nan" not in claim.why + claim.condition


STRANGE = [row(math.nan), row(1.0, aircraft="nobody"), row(1.0, rung="jsbsim", wind_mps="?")]


@pytest.mark.parametrize("rows", [[], [{"labels": {"part": "calm"}, "outcome": "crashed"}], STRANGE])
def test_no_rows_and_strange_rows_are_no_crash(audited, rows):
    assert {claim.word for claim in judge(rows).leading if claim.key != "words.online"} == {"not determined"}  # a condition of the computer


def test_the_file_has_a_line_a_claim_and_six_digits(audited):
    verdict = judge(a_bit_of_everything())
    data = csv_bytes(verdict)
    assert data == csv_bytes(judge(list(a_bit_of_everything())))
    table = list(csv.DictReader(io.StringIO(data.decode())))
    assert [line["key"] for line in table] == [claim.key for claim in verdict.claims]
    assert set(table[0]) == set(VERDICT_COLUMNS)
    safe = table[0]
    assert (safe["key"], safe["word"], safe["kinematic"], safe["point_mass"]) == ("words.single.safe", "fails when flown", "2", "")
    for line in table:
        for name in ("kinematic", "effect_low", "effect", "robustness_share"):
            assert len(line[name].replace("-", "").replace(".", "").lstrip("0").partition("e")[0]) <= 6


def test_the_order_of_rows_changes_nothing(audited):
    rows = a_bit_of_everything()
    assert csv_bytes(judge(rows[::-1])) == csv_bytes(judge(rows))


@pytest.mark.slow
def test_the_audit_gives_the_tolerances():
    printed = numbers.Printed("table2", "scoam", "deflection")
    assert printed.tolerance("single_106") == pytest.approx(0.05 + 1.348)  # reports/paper/audit.csv
    assert math.isnan(printed.figure(None))
