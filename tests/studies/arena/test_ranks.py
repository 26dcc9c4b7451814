"""Shares, intervals, best leads, ranks and tests of made-up flights against brute force and scipy."""

from itertools import product

import pytest
from scipy import stats

from testbed.results.statistics import share_interval
from testbed.studies.arena.flights import ANSWERED, OTHER, UNNOTICED, lost_by
from testbed.studies.arena.ranks import holm, judge
from testbed.studies.arena.sentences import said
from tests.studies.arena.flown import LEADS, PLACES, made_up

FLIGHTS = made_up()
JUDGED = judge(FLIGHTS)


def at_best(method, place):
    """Brute force: each half at the lead that did best in the other."""
    mine = [one for one in FLIGHTS if (one.method, one.place) == (method, place)]
    found = []
    for half in (0, 1):
        tally = {lead: [one.kept for one in mine if one.lead_s == lead and one.encounter.replicate % 2 != half] for lead in LEADS}
        top = max(sum(kept) for kept in tally.values())
        lead = max(lead for lead, kept in tally.items() if kept and sum(kept) == top)
        found += [one for one in mine if one.lead_s == lead and one.encounter.replicate % 2 == half]
    return found


@pytest.mark.parametrize(("method", "place"), list(product([f"m{k}" for k in range(1, 6)], PLACES)))
def test_a_share_at_the_own_best_lead_is_that_of_the_other_half_with_scipy_s_interval(method, place) -> None:
    (one,) = [standing for standing in JUDGED.places[place] if standing.method == method]
    flights = at_best(method, place)
    kept = sum(flight.kept for flight in flights)
    exact = stats.binomtest(kept, len(flights)).proportion_ci(0.95, method="exact")
    assert (one.share.kept, one.share.flights, one.share.encounters) == (kept, len(flights), 8)
    assert (one.share.low, one.share.high) == pytest.approx((exact.low, exact.high), abs=1e-9)
    assert sum(one.lost.values()) == 8 - kept
    first = JUDGED.places[place][0]
    theirs = {flight.encounter: flight.kept for flight in at_best(first.method, place)}
    only = [sum(theirs[f.encounter] > f.kept for f in flights), sum(theirs[f.encounter] < f.kept for f in flights)]
    assert [one.only_first, one.only_this] == only
    assert one is first or one.p == pytest.approx(stats.binomtest(only[0], sum(only)).pvalue if sum(only) else 1.0)
    shares = [sum(flight.kept for flight in at_best(f"m{k}", place)) for k in range(1, 6)]
    assert one.rank == 1 + sum(share > kept for share in shares)


def test_over_all_that_is_flown_encounters_are_counted_and_the_rails_are_left_out() -> None:
    for one in JUDGED.places[JUDGED.overall]:
        flights = [f for place in PLACES[1:] for f in at_best(one.method, place)] if one.rank else []
        if flights:
            assert (one.share.kept, one.share.flights, one.share.encounters) == (sum(f.kept for f in flights), 16, 8)
            assert (one.share.low, one.share.high) == pytest.approx(share_interval(one.share.kept / 2, 8))
            per = [
                (sum(f.kept for f in flights if f.encounter == met), sum(f.kept for place in PLACES[1:]
                 for f in at_best(JUDGED.places[JUDGED.overall][0].method, place) if f.encounter == met))
                for met in {f.encounter for f in flights}
            ]  # fmt: skip
            assert (one.only_first, one.only_this) == (sum(b > a for a, b in per), sum(a > b for a, b in per))
            assert sum(of.kept for of in JUDGED.populations[one.method].values()) == one.share.kept
    assert [one.method for one in JUDGED.places[JUDGED.overall]][-1] == "m0", "the control comes last, without a rank"


def test_an_interval_of_a_mean_of_shares_lies_between_those_of_the_next_whole_counts() -> None:
    lower, between, upper = (share_interval(count, 9) for count in (4, 4.5, 5))
    assert lower[0] < between[0] < upper[0]
    assert lower[1] < between[1] < upper[1]


def test_several_tests_are_corrected_after_holm() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([]) == []


def test_one_half_alone_is_scored_where_it_chooses() -> None:
    flights = [one for one in FLIGHTS if one.encounter.replicate == 0]
    judged = judge(flights)
    for one in judged.places[PLACES[1]]:
        mine = [f for f in flights if f.method == one.method and f.place == PLACES[1]]
        assert one.share.kept == max(sum(f.kept for f in mine if f.lead_s == lead) for lead in LEADS)
    assert judge([]).places == {}
    assert said(judge([])) == ("Nothing has been flown yet.",)


def test_how_a_flight_was_lost_is_read_off_its_decisions() -> None:
    def row(outcome, *events):
        return {"outcome": outcome, "nearest_obstacle": "O", "events": [{"decision": d, "obstacle": o} for d, o in events]}

    assert lost_by(row("hit_ground", ("replanned", "O"))) == "hit_ground"
    assert lost_by(row("collided")) == UNNOTICED
    assert lost_by(row("collided", ("replanned", "O"), ("rejoined", "O"))) == ANSWERED
    assert lost_by(row("collided", ("steered", "P"))) == OTHER
    assert lost_by(row("collided", ("no_path", "O"))) == "no_path"
    assert lost_by(row("collided", ("replanned", "P"), ("undefined", "O"))) == "undefined"
