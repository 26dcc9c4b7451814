"""Promises on rows whose truth is known by construction: the word, its condition, what is left out and what is never blamed on dynamics."""

import pytest

from testbed.studies.scoam.verdict.ablation import costs, kinematic_cause, most_costly, waterfall
from testbed.studies.scoam.verdict.flights import Flights
from testbed.studies.scoam.verdict.promises import promises
from tests.studies.scoam.verdict_rows import AIRCRAFT, RUNGS, calm, drawn, rough, row, threat, windy


def claims(rows, reach=None):
    return {claim.key: claim for claim in promises(Flights(rows), reach)}


def safe(*rows):
    return claims([one for some in rows for one in some])["words.single.safe"]


EVERYWHERE = [one for name in AIRCRAFT for one in (*windy([1.0] * 40, aircraft=name), *rough([1.0] * 5, aircraft=name))]


def test_what_holds_in_every_flight_and_draw_holds():
    claim = safe(calm(2.0, 1.0), EVERYWHERE, drawn([(2.0, 1.0)] * 73))
    assert (claim.word, claim.condition, claim.robustness_share, claim.robustness_n) == ("holds", "", 1.0, 72)
    assert (claim.effect.value, claim.effect.n) == (1.0, 94)  # 4 calm, 80 in wind, 10 in turbulence
    assert claim.effect.low == pytest.approx(0.025 ** (1 / 94))  # Clopper-Pearson without failures, in closed form


def test_what_holds_needs_draws_and_enough_of_them_and_is_conditional_where_they_do_not_agree():
    assert safe(calm(2.0, 1.0), EVERYWHERE).word == "not determined"
    few = safe(calm(2.0, 1.0), EVERYWHERE, drawn([(2.0, 1.0)] * 72))
    assert (few.word, few.robustness_share, few.robustness_n) == ("too few to say", 1.0, 71)
    assert '71 of 71 draws say "holds", which does not settle whether 95 % of all would: it takes about 72' in few.why
    claim = safe(calm(2.0, 1.0), EVERYWHERE, drawn([(2.0, 1.0)] * 61 + [(2.0, -1.0)] * 20))
    assert (claim.word, claim.condition) == ("holds only if", "what the paper does not print is as taken here")
    assert claim.robustness_share == pytest.approx(60 / 80)


def test_too_few_flights_show_nothing():
    claim = safe(calm(2.0, 1.0), windy([1.0]), drawn([(2.0, 1.0)] * 5))
    assert (claim.word, claim.condition, claim.deciding_limit) == ("too few to say", "", "")
    assert "5 of 5 flights pass, which does not settle whether 95 % of all would: it takes about 72" in claim.why  # 0.025 ** (1 / 72)


def test_what_fails_on_rails_is_not_blamed_on_dynamics():
    claim = safe(calm(-1.0, -5.0), windy([-5.0] * 8))
    assert claim.word == "fails kinematically"
    assert claim.effect.n == 4  # the flights on rails, none of the flown ones
    assert claim.effect.value == 0.0


def test_what_only_fails_when_flown():
    claim = safe(calm(2.0, -3.0), windy([-4.0] * 8), rough([1.0]))
    assert claim.word == "fails when flown"
    assert (claim.kinematic, claim.flown_calm) == (2.0, -3.0)
    assert (claim.effect.value, claim.effect.n) == (1 / 13, 13)


def test_a_touch_is_kept_and_a_micrometre_more_is_not():
    assert safe(calm(2.0, -1e-6), drawn([])).word != "fails when flown"
    assert safe(calm(2.0, -1.1e-6)).word == "fails when flown"


def test_one_aircraft_is_a_condition():
    claim = safe(calm(2.0, {"gtm_t2": 1.0, "c172p": -9.0}), windy([1.0] * 8))
    assert (claim.word, claim.condition) == ("holds only if", "flown by gtm_t2")


def test_one_reading_is_a_condition():
    rows = [*calm(2.0, 1.0, encounters=("single_106",)), *calm(-2.0, -3.0, encounters=("single_106_10",))]
    assert safe(rows).condition == "the encounter is that of azimuth 106 deg, in calm air"


def test_weak_air_is_a_condition():
    air = [
        *windy([1.0] * 8, "5"),
        *windy([1.0] * 7 + [-1.0], "10"),
        *windy([1.0] * 8, "15"),
        *rough([1.0, 1.0]),
        *rough([-1.0], "moderate"),
    ]
    claim = safe(calm(2.0, 1.0), air)
    assert (claim.word, claim.condition) == ("holds only if", "in calm air, wind up to 5 m/s and turbulence up to light")


def test_wind_in_which_the_point_on_rails_fails_counts_for_nothing():
    claim = safe(calm(2.0, 1.0), windy([-5.0] * 3, rails=-1.0), windy([1.0] * 4, "5"))
    assert claim.effect.n == 4 + 4
    assert "3 flights in wind fail on rails already" in claim.why


def test_wind_in_which_no_planner_is_needed_counts_for_nothing():
    air = {"part": "wind", "design": "anchored", "wind_mps": "5", "wind_from": "N", "rung": "jsbsim"}
    claim = safe(calm(2.0, 1.0), [row(3.0, method="none", **air), row(-1.0, **air)])
    assert claim.effect.n == 4
    assert "1 flights in wind and turbulence are at no threat" in claim.why


def test_the_two_wind_designs_are_never_pooled():
    with_ground = safe(calm(2.0, 1.0), windy([1.0] * 4), windy([-9.0] * 4, design="ground_fixed"))
    without = safe(calm(2.0, 1.0), windy([1.0] * 4))
    assert (with_ground.word, with_ground.effect) == (without.word, without.effect)
    assert "4 of 4 flights in wind are at a threat, and 0 of 4 keep clear" in with_ground.why


def test_a_failure_that_most_draws_do_not_share_is_not_determined():
    def of_draws(hold, fail):
        return safe(calm(2.0, -1.0), drawn([(2.0, -1.0)] + [(2.0, 1.0)] * hold + [(2.0, -1.0)] * fail))

    claim = of_draws(66, 44)  # 40 %: Clopper and Pearson's upper bound is 49.8 %
    assert (claim.word, claim.robustness_share) == ("not determined", 0.4)
    assert of_draws(5, 5).word == of_draws(6, 13).word == "too few to say"
    assert of_draws(44, 66).word == of_draws(4, 15).word == "fails when flown"


def test_a_draw_in_which_no_planner_is_needed_is_none():
    rows = drawn([(2.0, -1.0)] * 7 + [(2.0, 1.0)] * 3)
    idle = [row(5.0, part="robustness", method="none", rung=rung, replicate=n) for n in range(7, 10) for rung in ("kinematic", "jsbsim")]
    claim = safe(calm(2.0, -1.0), rows, idle)
    assert (claim.word, claim.robustness_share, claim.robustness_n) == ("fails when flown", 1.0, 6)


def test_a_marginal_flight_is_mentioned():
    assert "2 flights are marginal" in safe(calm(2.0, {"gtm_t2": 0.1, "c172p": 1.0})).why


def test_flights_that_say_nothing_are_left_out():
    rows = calm(2.0, 1.0)
    lost = [row(-9.0, rung="jsbsim", encounter="single_106_10", aircraft="gtm_t2", outcome="crashed")]
    assert safe(rows, lost).effect.n == 4
    ground = [one | {"outcome": "hit_ground"} if one["labels"]["rung"] == "jsbsim" else one for one in rows]
    assert safe(ground).word == "fails when flown"  # it kept the radius, and hit the ground


@pytest.mark.parametrize(
    ("metrics", "word"),
    [
        ({}, "holds only if"),
        ({"max_load_factor": 2.7}, "fails kinematically"),  # gtm_t2 has 2.6, c172p 3.0
        ({"max_bank_deg": 71.0}, "fails kinematically"),
        ({"max_roll_rate_dps": 147.0}, "fails kinematically"),
        ({"min_load_factor": -0.1}, "fails kinematically"),
        ({"cross_track_max_m": 5.1}, "fails when flown"),
    ],
)
def test_flyable_is_within_the_limits_on_rails_and_within_five_metres_flown(metrics, word):
    assert claims(calm(2.0, 2.0, aircraft=("gtm_t2",), **metrics))["words.single.flyable"].word == word


class Wide:
    """A pose that needs a radius which the aircraft has, or that nothing can reach."""

    level_turn_radius_m, steepest_radius_m = 100.0, 70.0

    def __init__(self, radius_m):
        self.radius_m = radius_m
        self.reachable = radius_m > 100.0


@pytest.mark.parametrize(("radius", "word"), [(200.0, "holds only if"), (80.0, "holds only if"), (60.0, "fails kinematically")])
def test_a_pose_counts_only_where_it_is_ruled_out(radius, word):
    rows = calm(2.0, 2.0, aircraft=("gtm_t2",))
    for one in rows:
        one["events"] = [] if one["method"] == "none" else [EVENT]
    claim = claims(rows, lambda *_: Wide(radius))["words.single.flyable"]
    assert claim.word == word
    assert f"radius of {radius:.1f} m; a level turn of gtm_t2 needs 100.0 m" in claim.why


EVENT = {"decision": "replanned"} | dict.fromkeys(
    "time_s radius_m alpha_rad alpha0_rad time_to_cpa_s miss_m route_miss_m cap_radius_mps cap_azimuth_rad cap_elevation_rad "
    "cap_half_angle_rad deflection_rad margin_rad insertion_time_s max_curvature_to_insertion_1pm max_curvature_to_goal_1pm "
    "planned_length_m".split(),
    0.0,
)
EVENT |= dict.fromkeys(("obstacle", "method", "status"), "")
EVENT |= {
    name: [0.0, 0.0, 0.0]
    for name in "own_pos_enu_m own_vel_enu_mps obstacle_pos_enu_m obstacle_vel_enu_mps command_enu_mps insertion_enu_m".split()
}


def test_the_overload_is_that_of_section_5_2():
    rows = calm(1.0, 1.0, encounters=("multi_as_printed", "multi_o2_up"), max_load_factor=2.8)
    claim = claims(rows)["words.overload"]
    assert (claim.word, claim.condition) == ("holds only if", "flown by c172p, in calm air")  # gtm_t2 has 2.6 g, c172p 3.0


def test_several_threats_are_judged_where_both_are_threats():
    rows = [*calm(3.0, 1.0, encounters=("multi_as_printed",)), *calm(-6.0, -7.0, encounters=("multi_o2_up",))]
    assert claims(rows)["words.multi.safe"].word == "fails kinematically"


def test_nothing_flown_gives_no_word():
    for claim in claims([]).values():
        assert claim.word == "not determined"
        assert claim.why


# ---- waterfalls --------------------------


def chain(**values):
    return Flights([made for rung in RUNGS for made in (threat(rung=rung), row(values[rung], rung=rung))])


PLAIN = dict.fromkeys(RUNGS, 5.0)


def test_the_costly_limit_is_the_one_that_was_made_so():
    values = PLAIN | {"point_roll": 1.0, "point_no_load": 1.0, "point_no_speed": 1.0, "point_mass": 1.0, "jsbsim": 0.5}
    found = waterfall(chain(**values), "single_106", "scoam", "gtm_t2")
    assert found.alone_m == {"roll": 4.0, "load factor": 0.0, "speed": 0.0}
    assert found.last_m == {"roll": 4.0, "load factor": 0.0, "speed": 0.0}
    assert most_costly(costs(found)) == ("roll", 4.0)
    assert sum(step.change_m for step in found.steps[1:]) == pytest.approx(0.5 - 5.0)  # the steps add up


def test_six_degrees_of_freedom_and_air_are_steps_too():
    flights = Flights([*chain(**PLAIN | {"jsbsim": 3.0}).all, *windy([-6.0, -4.0, -5.0])])
    found = waterfall(flights, "single_106", "scoam", "gtm_t2")
    assert costs(found)["six degrees of freedom"] == 2.0
    assert [(step.rung, step.clearance_m, step.change_m) for step in found.steps][-1] == ("wind", -5.0, -8.0)
    assert most_costly(costs(found)) == ("wind", 8.0)


@pytest.mark.parametrize(
    ("at_once", "rails", "cause"),
    [(0.0, -3.0, "insertion point"), (-2.0, -3.0, "avoidance direction"), (-1.0, -3.0, "insertion point"), (0.0, 1.0, "")],
)
def test_what_a_failure_on_rails_is_due_to(at_once, rails, cause):
    found = waterfall(chain(**PLAIN | {"vo_instant": at_once, "kinematic": rails}), "single_106", "scoam", "gtm_t2")
    assert kinematic_cause(found)[0] == cause
