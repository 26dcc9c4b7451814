"""Pairs of two runs, and what differs within them: against figures worked out by hand, and intervals by SciPy's."""

import math
from dataclasses import replace

import pytest
from scipy import stats

from testbed.results import statistics
from testbed.results.compare import Flight, NotComparableError, compare, flight, swept


def flights(count, change=0.0, *, hit=(), **labels):
    """Flights of one cell whose clearance is 0, 1, 2, ... m and the change more; those in ``hit`` are inside."""
    return [
        Flight(
            f"{k}",
            {"air": "calm", **labels},
            k,
            "collided" if k in hit else "reached",
            k not in hit,
            {"least_clearance_m": k + change, "max_bank_deg": math.nan if k == 0 else 30.0 + 2.0 * change * k, "replans": 1.0},
        )
        for k in range(count)
    ]


def test_a_difference_is_that_within_pairs_and_its_tone_goes_by_what_is_worse():
    found = compare(flights(10), flights(10, -0.5)[::-1])  # in any order
    assert [(pair.first.replicate, pair.second.replicate) for pair in found.pairs] == [(k, k) for k in range(10)]
    by_name = {one.column.name: one for one in found.differences}
    clearance, bank, replans = by_name["least_clearance_m"], by_name["max_bank_deg"], by_name["replans"]
    assert (clearance.first, clearance.second, clearance.effect.value) == (4.5, 4.0, -0.5)
    assert (clearance.effect.low, clearance.effect.high, clearance.up, clearance.down) == (-0.5, -0.5, 0, 10)
    assert clearance.tone == "worse"
    assert (bank.effect.n, bank.effect.value, bank.largest) == (9, -5.0, -9.0)  # of those in which both have it
    assert bank.tone == "better"  # less bank
    assert (replans.largest, replans.tone) == (0.0, "same")


def test_shares_count_the_pairs_in_which_one_alone_holds():
    found = compare(flights(10, hit=(1, 2)), flights(10, hit=(2, 3, 4, 5)))
    kept, reached = found.shares
    assert (kept.name, kept.first, kept.second, kept.only_first, kept.only_second) == ("keeps every radius", 8, 6, 3, 1)
    assert (reached.first, reached.second) == (8, 6)
    assert kept.effect.value == pytest.approx(-0.2)
    assert kept.p == pytest.approx(stats.binomtest(1, 4).pvalue)
    assert found.outcomes == {
        ("reached", "reached"): 5,
        ("collided", "reached"): 1,
        ("reached", "collided"): 3,
        ("collided", "collided"): 1,
    }


@pytest.mark.parametrize(("only_first", "only_second", "n"), [(0, 0, 12), (4, 0, 24), (3, 11, 40), (12, 0, 12)])
def test_the_interval_of_a_difference_of_shares_is_of_its_two_halves(only_first, only_second, n):
    found = statistics.share_difference("", only_first, only_second, n)
    one, other = (stats.binomtest(k, n).proportion_ci(0.975, "exact") for k in (only_first, only_second))
    assert (found.low, found.high) == (pytest.approx(other.low - one.high), pytest.approx(other.high - one.low))
    assert found.low <= found.value <= found.high


def test_who_has_no_partner_is_counted_and_left_out():
    first = flights(3, method="none") + flights(3, method="scoam")
    second = flights(2, method="scoam") + flights(3, method="orca")
    found = compare(first, second)
    assert [(pair.key, pair.first.labels["method"]) for pair in found.pairs] == [((("calm", "scoam"), k), "scoam") for k in range(2)]
    assert (found.only_first, found.only_second) == (4, 3)


def test_an_axis_that_tells_the_runs_apart_is_what_is_compared():
    found = compare(flights(3, method="scoam"), flights(3, method="orca"))
    assert (found.axes, len(found.pairs)) == (("air",), 3)


def test_cells_are_told_one_by_one():
    found = compare(flights(7, wind="0") + flights(7, wind="10"), flights(7, 1.0, wind="0") + flights(7, -1.0, wind="10"))
    assert [(cell.labels["wind"], cell.differences[0].effect.value) for cell in found.cells] == [("0", 1.0), ("10", -1.0)]


def test_what_cannot_be_paired_is_refused_with_the_reason():
    many = flights(2, method="none") + flights(2, method="scoam")
    with pytest.raises(NotComparableError, match=r"several flights of the first run have air calm; they differ in method, .*--on"):
        compare(many, many, on=["air"])
    with pytest.raises(NotComparableError, match="'wind' is no axis of both runs; there are: air, method"):
        compare(many, many, on=["wind"])
    with pytest.raises(NotComparableError, match="on the axis method one has none, scoam, the other orca"):
        compare(many, flights(2, method="orca"))
    searched = [Flight("s", {"air": "calm"}, 0, "found", None, {"lead_s": 1.0})]
    with pytest.raises(NotComparableError, match="nothing alike"):
        compare(flights(1), searched)


def test_searches_of_a_study_are_compared_by_their_own_figures():
    def searched(*leads):
        return [
            flight({"flight_id": "s", "labels": {}, "replicate": k, "outcome": "found", "found": {"lead_s": lead, "grid_m": [1.0]}}, ())
            for k, lead in enumerate(leads)
        ]

    (lead,) = compare(searched(1.0, 2.0, math.inf), searched(1.5, 2.5, 3.0)).differences  # of a list there is no difference
    assert (lead.column.heading, lead.column.unit) == ("lead", "s")
    assert (lead.effect.n, lead.effect.value) == (2, 0.5)  # none of what is infinite


def test_axes_are_those_of_the_part_even_if_no_flight_of_it_is_done():
    slow, wide = ([one for x in "12" for one in flights(1, part=part, **{axis: x})] for part, axis in (("a", "k"), ("b", "radius")))
    both = swept(one.labels for one in slow + wide)
    found = compare(slow, slow + wide, planned=(both, both))
    assert (len(found.pairs), found.only_first, found.only_second) == (2, 0, 2)
    assert set(found.axes) == {"air", "part", "k", "radius"}
    other = [replace(one, labels={**one.labels, "k": "9"}) for one in slow[:1]]  # part a alone: what each run has of it tells them apart
    found = compare(slow[:1] + wide, other + wide)
    assert [(pair.first.labels.get("k"), pair.second.labels.get("k")) for pair in found.pairs] == [("1", "9"), (None, None), (None, None)]
    with pytest.raises(NotComparableError, match="have air calm, part b; they differ in radius"):
        compare(slow + wide, slow + wide, on=["air", "part", "k"])


def test_a_median_does_not_make_up_for_pairs_that_no_longer_keep_clear():
    first, second = flights(10), flights(10, 5.0, hit=(8, 9))
    unavoiding = [replace(one, labels={"air": "calm", "method": "none"}, avoids=False) for one in flights(10)]
    found = compare(first + unavoiding, second + unavoiding)
    assert (found.lead.n, found.lead.kept.only_first, found.lead.differences[0].tone) == (10, 2, "changed")
    assert compare(first, flights(10, 5.0)).lead.differences[0].tone == "better"


def test_a_change_that_is_told_as_nought_is_none():
    (clearance, *_) = compare(flights(10), flights(10, -0.004)).differences
    assert (clearance.effect.high < 0.0, clearance.tone) == (True, "same")
