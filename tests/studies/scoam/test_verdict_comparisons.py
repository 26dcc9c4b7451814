"""Statistics against closed forms, comparisons and ranks on populations whose truth is known by construction."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from testbed.campaign import load_campaign
from testbed.results import statistics as stats
from testbed.studies.scoam.labels import DROAM
from testbed.studies.scoam.study import Scoam
from testbed.studies.scoam.verdict.comparisons import comparisons
from testbed.studies.scoam.verdict.flights import Flights
from testbed.studies.scoam.verdict.online import online
from testbed.studies.scoam.verdict.pairs import DEFLECTION, paired
from testbed.studies.scoam.verdict.promises import promises
from testbed.studies.scoam.verdict.ranking import ranks
from testbed.studies.scoam.verdict.superior import superior
from testbed.studies.study import Run
from tests.studies.scoam.verdict_rows import calm, drawn, population, row, threat

ROOT = Path(__file__).parents[3]

# ---- statistics --------------------------


def at_most(count, n, p):
    """P(X <= count) of a binomial, summed by hand."""
    return sum(math.comb(n, k) * p**k * (1.0 - p) ** (n - k) for k in range(count + 1))


@given(st.integers(1, 60).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_a_share_interval_has_its_tails(drawn):
    count, n = drawn
    low, high = stats.share_interval(count, n)
    assert low == 0.0 if count == 0 else 1.0 - at_most(count - 1, n, low) == pytest.approx(0.025, abs=1e-7)
    assert high == 1.0 if count == n else at_most(count, n, high) == pytest.approx(0.025, abs=1e-7)


def test_ninety_nine_percent_takes_299_flights_without_failure():
    assert stats.share_at_least(299, 299) == pytest.approx(0.05 ** (1 / 299))
    assert stats.share_at_least(299, 299) >= 0.99 > stats.share_at_least(298, 298)


@given(st.lists(st.floats(-1e3, 1e3), min_size=6, max_size=80))
def test_a_median_interval_is_the_widest_pair_of_order_statistics_that_is_needed(values):
    effect, ordered, n = stats.median("", "", values), sorted(values), len(values)
    rank = max(k for k in range(1, n // 2 + 1) if at_most(k - 1, n, 0.5) <= 0.025)
    assert (effect.low, effect.high) == (ordered[rank - 1], ordered[n - rank])
    assert effect.low <= effect.value <= effect.high


def test_five_pairs_have_no_interval():
    effect = stats.median("", "", [1.0, 2.0, 3.0, 4.0, 5.0, math.nan])
    assert (effect.value, effect.n) == (3.0, 5)
    assert math.isnan(effect.low)


@given(st.integers(0, 40), st.integers(0, 40))
def test_mcnemar_counts_the_tails_of_a_coin(first, second):
    n, less = first + second, min(first, second)
    assert stats.mcnemar(first, second) == pytest.approx(1.0 if first == second else min(1.0, 2.0 * at_most(less, n, 0.5)))


# ---- least, shortest ---------------------


def claim_of(key, *rows):
    return {claim.key: claim for claim in comparisons(Flights([one for some in rows for one in some]))}[f"words.{key}"]


def deflections(scoam, hp, vp, least, n=40, rung="kinematic"):
    metric = "deflection_deg" if rung == "kinematic" else "flown_deflection_deg"
    methods = {"scoam": scoam, "droam_hp": hp, "droam_vp": vp, "least_deflection": least}
    return population([{name: value + 0.001 * i for name, value in methods.items()} for i in range(n)], metric, rung)


def draws_of(scoam, rival, n=72):
    metrics = ("deflection_deg", "flown_deflection_deg")
    made = []
    for method, value in (("scoam", scoam), ("droam_hp", rival), ("droam_vp", rival), ("least_deflection", rival)):
        made += drawn([(1.0, 1.0)] * (n + 1), method=method, **dict.fromkeys(metrics, value))
    return made


def test_least_of_all_on_both_rungs_and_in_the_draws_holds():
    # 80 pairs: all of them give a share of at least 0.025 ** (1 / 80) = 0.955
    rows = [made for rung in ("kinematic", "jsbsim") for made in deflections(10.0, 12.0, 11.0, 10.0, 80, rung)]
    claim = claim_of("deflection_least", rows, draws_of(10.0, 11.0))
    assert (claim.word, claim.effect.n) == ("holds", 80)
    assert claim_of("deflection_least", rows).word == "not determined"  # without draws


def test_least_beside_droam_only_is_conditional():
    rows = [made for rung in ("kinematic", "jsbsim") for made in deflections(10.0, 12.0, 11.0, 9.0, 80, rung)]
    claim = claim_of("deflection_least", rows, draws_of(10.0, 11.0))
    assert (claim.word, claim.condition) == ("holds only if", "DROAM is the only rival")
    assert claim.effect.value == pytest.approx(1.0)


def test_one_plane_with_less_is_enough_to_fail():
    claim = claim_of("deflection_least", deflections(10.0, 25.0, 9.0, 9.0))
    assert claim.word == "fails kinematically"
    assert (claim.effect.value, claim.effect.low, claim.effect.high) == pytest.approx((-1.0, -1.0, -1.0))


def test_least_on_rails_but_not_flown_fails_when_flown():
    rows = [*deflections(10.0, 12.0, 11.0, 10.0, 80), *deflections(15.0, 12.0, 11.0, 10.0, 80, "jsbsim")]
    assert claim_of("deflection_least", rows).word == "fails when flown"


def test_an_interval_on_both_sides_says_nothing_yet():
    rows = population([{"scoam": 10.0, "droam_hp": 10.0 + (-1) ** i, "droam_vp": 20.0} for i in range(40)], "deflection_deg")
    claim = claim_of("deflection_least", rows)
    assert claim.word == "too few to say"
    assert "20 of 40 pairs have SCOAM least on rails" in claim.why


def test_mostly_least_is_the_typical_encounter():
    rows = []
    for rung, metric in (("kinematic", "deflection_deg"), ("jsbsim", "flown_deflection_deg")):
        rivals = [9.0 if i < 12 else 11.0 for i in range(80)]
        rows += population([{"scoam": 10.0, "droam_hp": rival, "droam_vp": 20.0} for rival in rivals], metric, rung)
    claim = claim_of("deflection_least", rows)
    assert claim.word == "holds only if"
    assert claim.condition == "the typical encounter is meant: SCOAM is least in 85 % of them"


def test_what_the_tables_cannot_show_is_no_difference():
    rows = [made for rung in ("kinematic", "jsbsim") for made in deflections(10.04, 10.0, 10.0, 10.0, 80, rung)]
    assert claim_of("deflection_least", rows, draws_of(10.04, 10.0)).word == "holds"


def test_encounters_without_threat_are_no_pairs():
    rows = deflections(10.0, 12.0, 11.0, 10.0, 10)
    for made in rows:
        if made["replicate"] < 4 and made["method"] == "none":
            made["least_clearance_m"] = 5.0
    assert len(paired(Flights(rows), DEFLECTION, "population", "kinematic", DROAM).differences) == 6


def test_two_encounters_refute_with_their_draws_and_prove_nothing():
    def encounters(rival):
        found = [(e, m, x) for e in ("single_106", "single_106_10") for m, x in (("scoam", 10.0), ("droam_hp_left", rival))]
        return [row(1.0, encounter=e, method=m, deflection_deg=x) for e, m, x in found]

    assert claim_of("deflection_least", encounters(9.0), draws_of(10.0, 9.0)).word == "fails kinematically"
    assert claim_of("deflection_least", encounters(9.0)).word == "not determined"
    assert claim_of("deflection_least", encounters(11.0), draws_of(10.0, 11.0)).word == "not determined"


def test_both_sides_of_droam_are_rivals():
    rows = [threat(), row(1.0, deflection_deg=10.0)]
    rows += [
        row(1.0, method=name, deflection_deg=x) for name, x in (("droam_hp_left", 12.0), ("droam_hp_right", 9.5), ("droam_vp_up", 30.0))
    ]
    assert paired(Flights(rows), DEFLECTION, "calm", "kinematic", DROAM).differences == (-0.5,)


# ---- superior and ranks ------------------


def test_ranks_pair_by_encounter():
    rows = population([{"scoam": 1.0 + i, "droam_hp": -1.0 if i < 8 else 1.0, "droam_vp": 2.0} for i in range(20)], "least_clearance_m")
    by_method = {rank.method: rank for rank in ranks(Flights(rows))}
    assert (by_method["scoam"].safe, by_method["droam_hp"].safe, by_method["scoam"].n) == (20, 12, 20)
    assert by_method["droam_hp"].mcnemar_p == pytest.approx(2 * 0.5**8)
    assert by_method["droam_vp"].versus_scoam.value == pytest.approx(8.5)  # median of i - 1 for i = 0 ... 19
    assert "least_deflection" not in by_method


def worlds(scoam, droam, rung):
    rows = population([{"scoam": scoam, "droam_hp": droam, "droam_vp": droam}] * 40, "least_clearance_m", rung)
    for made in rows:
        made["deflection_deg"] = made["flown_deflection_deg"] = 10.0
    return rows


def test_superior_in_clearance_and_safety_and_worse_in_nothing_holds():
    rows = [made for rung in ("kinematic", "jsbsim") for made in worlds(5.0, -1.0, rung)]
    draws = [
        made for name, x in (("scoam", 5.0), ("droam_hp", -1.0), ("droam_vp", -1.0)) for made in drawn([(x, x)] * 73, "multi_o2_up", name)
    ]
    assert superior(Flights([*rows, *draws])).word == "holds"


def test_superior_in_one_thing_and_worse_in_another_names_the_one():
    rows = [made for rung in ("kinematic", "jsbsim") for made in worlds(5.0, 1.0, rung)]
    for made in rows:
        if made["method"] == "scoam":
            made["max_load_factor"] = 4.0
    claim = superior(Flights(rows))
    assert (claim.word, claim.condition) == ("holds only if", "superior means clearance")


def test_superior_on_rails_but_not_flown():
    assert superior(Flights([*worlds(5.0, 1.0, "kinematic"), *worlds(1.0, 5.0, "jsbsim")])).word == "fails when flown"


def test_worse_and_better_in_nothing_fails_kinematically():
    assert superior(Flights([*worlds(1.0, 5.0, "kinematic"), *worlds(5.0, 1.0, "jsbsim")])).word == "fails kinematically"


# ---- online ------------------------------


def test_online_needs_an_answer_and_tells_whether_it_comes_in_time():
    safe, late = (promises(Flights(calm(2.0, flown)), None)[0] for flown in (2.0, -3.0))
    assert (safe.word, late.word) == ("holds only if", "fails when flown")
    assert online(Flights([threat()]), safe).word == "not determined"
    flights = Flights(calm(2.0, -3.0))
    assert [online(flights, one).condition for one in (safe, late)] == [
        "the computer answers within a tick",
        "online means computed within a tick, and not early enough for the aircraft",
    ]
    claim = online(flights, late)
    assert claim.word == "holds only if"
    assert claim.why.startswith(f"{len(flights.all) // 2} flights had a threat answered")


@pytest.mark.slow
def test_no_time_of_the_computer_enters_the_verdict():
    """The same rows with other timings, a thousand times slower, are the same files: what a computer takes is in timings.csv alone."""
    campaign, rows = load_campaign(ROOT / "campaigns" / "paper.yaml"), [one | {"recording": None} for one in calm(2.0, -3.0)]
    made = [Scoam().write(Run(campaign, [], rows, [{"fly": took, "fly.answer": took}] * len(rows), {}, {})) for took in (0.0009, 9.0)]
    assert made[0] == made[1]
