"""Numbers, shares and names read the same wherever they stand."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from testbed.flight.laws import LAWS
from testbed.flight.record import Outcome
from testbed.show import words
from testbed.studies.scoam.verdict import csv_words
from vosc.methods import METHODS


@given(st.integers(0, 100_000), st.integers(1, 100_000))
def test_a_share_reads_0_or_100_only_where_it_is(part: int, whole: int) -> None:
    share = min(part, whole) / whole
    text = words.percent(share)
    assert (text == "0 %") == (share == 0.0)
    assert (text == "100 %") == (share == 1.0)
    if text == "below 0.1 %":
        assert 0.0 < share < 0.001
    else:
        assert abs(float(text.removesuffix(" %")) - 100.0 * share) <= 0.5 + 1e-9
    assert csv_words.percent(share) == text


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_larger_share_never_reads_as_less(one: float, other: float) -> None:
    low, high = sorted((one, other))
    read = [0.05 if text.startswith("below") else float(text.removesuffix(" %")) for text in map(words.percent, (low, high))]
    assert read[0] <= read[1]


@pytest.mark.parametrize(
    ("share", "text"),
    [(1 / 200, "0.5 %"), (199 / 200, "99.5 %"), (1 / 2000, "below 0.1 %"), (1.0 - 1e-15, "99.9 %"), (1e-300, "below 0.1 %"),
     (0.01, "1 %"), (0.99, "99 %"), (0.61, "61 %"), (math.nan, words.DASH)],
)  # fmt: skip
def test_one_of_two_hundred_is_neither_none_nor_a_whole_per_cent(share: float, text: str) -> None:
    assert words.percent(share) == text


@given(st.floats(allow_nan=True, allow_infinity=True), st.integers(0, 4))
def test_a_number_reads_back_and_zero_has_no_sign(value: float, digits: int) -> None:
    text = words.number(value, digits)
    if not math.isfinite(value):
        assert text == words.DASH
    else:
        assert float(text.replace(words.MINUS, "-")) == round(value, digits)
        assert not (float(text.replace(words.MINUS, "-")) == 0.0 and words.MINUS in text)


def test_quantities_have_the_decimals_and_the_unit_of_their_kind() -> None:
    assert words.amount(-3.77, "m") == f"{words.MINUS}3.8 m"
    assert words.amount(1.234, "s") == "1.23 s"
    assert words.amount(0.0372, "share") == "4 %"
    assert words.interval(0.21, 0.29, "share") == "21 to 29 %"
    assert words.interval(-4.4, -3.1, "m") == f"{words.MINUS}4.4 to {words.MINUS}3.1 m"
    assert words.interval(math.nan, 1.0, "m") == words.DASH
    assert words.span(1.0, 1.001, "s", 2) == "1.00 s"
    assert words.span(1.0, 2.0, "", 1) == "1.0 to 2.0"


@pytest.mark.parametrize(("names", "text"), [([], ""), (["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")])
def test_lists(names: list[str], text: str) -> None:
    assert words.listed(names) == text


def test_every_outcome_and_method_is_told_without_underscores() -> None:
    assert set(words.OUTCOME_NAMES) == set(Outcome)
    told = [
        *map(words.outcome, Outcome),
        *map(words.outcome_told, Outcome),
        *map(words.method, [*METHODS, *LAWS]),
        words.outcome("not_found"),
    ]
    assert not [text for text in told if "_" in text or not text]
    assert words.outcomes({"hit_ground": 1, "reached": 7, "not_found": 2}) == "7 reached the goal, 1 hit the ground, 2 not found"
    assert words.outcome_told("collided") == "collided: came closer than the obstacle's radius"


def test_who_flew_and_under_which_circumstances() -> None:
    assert words.flyer("jsbsim", "gtm_t2") == "gtm_t2 flown in JSBSim"
    assert words.flyer("kinematic", "gtm_t2") == "kinematic point"
    assert words.flyer("glider", "ask21") == "ask21 (glider)"
    assert words.circumstance("flown_by", "gtm_t2") == "flown by gtm_t2"
    assert words.circumstance("air.wind.speed_mps", "10") == "wind 10 m/s"
    assert words.circumstance("method.kind", "none") == "no avoidance"
    assert words.circumstance("reading", "as_printed") == "as_printed"
    assert words.circumstance("replan.magnitude_chords", "1.5") == "replan magnitude chords 1.5"
    assert words.circumstance("obstacles.O.speed_mps", "20") == "obstacle O 20 m/s"
    assert words.circumstance("obstacles.O.radius_m", "25") == "obstacle O radius 25 m"
    assert words.circumstance("vary", "true") == "vary true"


@pytest.mark.parametrize(
    ("axis", "heading"),
    [
        ("reading", "reading"),
        ("method.kind", "method"),
        ("method.options.side", "side (method)"),
        ("planner.options.aside_deg", "aside_deg (planner)"),
        ("air.wind.speed_mps", "wind, m/s"),
    ],
)
def test_an_axis_heads_its_column_in_words(axis: str, heading: str) -> None:
    assert words.axis_heading(axis) == heading
