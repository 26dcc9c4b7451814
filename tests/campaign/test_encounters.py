"""Drawn encounters against the arithmetic of two straight lines, and their distribution against its definition."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from scipy import stats

from testbed.campaign import Campaign, FlightPlan, SpecError, expand, load_campaign
from testbed.flight.scene import make_scene

Array = np.ndarray
AT, DIRECTION = (162.0, 101.0, 64.3), (24.7, 12.0)
ROUTE = {
    "start_enu_m": [0, 0, 0],
    "goal_enu_m": [500, 200, 100],
    "start_direction_deg": [40.87, 26.13],
    "goal_direction_deg": [10.00, 2.84],
}
POPULATION = {
    "own_at_enu_m": AT,
    "own_direction_deg": DIRECTION,
    "trigger": {"range_m": 100},
    "obstacle_speed_mps": [20, 50],
    "radius_m": [25, 30],
}


def plans(replicates: int, sweep: object = None, population: dict[str, Any] | None = None, **settings: object) -> tuple[FlightPlan, ...]:
    data = {"name": "demo", "question": "?", "seed": 6, "route": ROUTE, "replicates": replicates, "plant": {"kind": "kinematic"}}
    return expand(Campaign.model_validate({**data, "encounters": {**POPULATION, **(population or {})}, "sweep": sweep or {}, **settings}))


def unit(azimuth_deg: float, elevation_deg: float) -> Array:
    a, e = np.radians([azimuth_deg, elevation_deg])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def geometry(plan: FlightPlan) -> dict[str, Any]:
    """Relative motion at the trigger, from what the plan says."""
    (one,) = plan.obstacles
    assert (one.name, one.when.own_reaches_enu_m, one.when.time_s) == ("O", AT, None)
    direction = unit(*one.direction_deg)
    own, other = plan.speed_mps * unit(*DIRECTION), one.speed_mps * direction
    apart, closing = np.array(one.position_enu_m) - AT, other - own
    time_s = -(apart @ closing) / (closing @ closing)
    miss = apart + time_s * closing
    return {
        "range": np.linalg.norm(apart), "time_s": time_s, "miss": np.linalg.norm(miss), "miss_vector": miss, "radius": one.radius_m,
        "speed": one.speed_mps, "direction": direction, "closing": closing,
    }  # fmt: skip


def test_each_encounter_has_the_range_speed_radius_and_miss_that_were_asked_for() -> None:
    for told in map(geometry, plans(300)):
        assert told["range"] == pytest.approx(100, abs=1e-9)
        assert 20 <= told["speed"] <= 50
        assert 25 <= told["radius"] <= 30
        assert told["miss"] <= told["radius"] + 1e-9
        assert 0 < told["time_s"] <= 10 + 1e-9
        assert told["time_s"] * np.linalg.norm(told["closing"]) == pytest.approx(np.sqrt(100**2 - told["miss"] ** 2), abs=1e-9)


def test_a_time_to_the_closest_approach_can_be_given_instead() -> None:
    for told in map(geometry, plans(200, population={"trigger": {"time_to_cpa_s": 2.0}})):
        assert told["time_s"] == pytest.approx(2.0, abs=1e-9)
        assert told["miss"] <= told["radius"] < told["range"]


@pytest.mark.slow
def test_the_distribution_is_the_one_that_is_documented() -> None:
    """Fixed seed. With so long a time nothing is drawn again, and the direction is even on the sphere."""
    n = 3000
    told = [geometry(plan) for plan in plans(n, population={"longest_s": 3600})]
    direction = np.array([one["direction"] for one in told])
    assert np.abs(direction.mean(axis=0)).max() < 4 / np.sqrt(3 * n)  # each component has variance 1/3
    assert np.abs(direction.T @ direction / n - np.eye(3) / 3).max() < 4 * np.sqrt(4 / 45 / n)  # and its square 4/45
    assert stats.kstest(direction[:, 2], "uniform", args=(-1, 2)).pvalue > 0.01
    assert stats.kstest([(one["miss"] / one["radius"]) ** 2 for one in told], "uniform").pvalue > 0.01
    assert stats.kstest([one["speed"] for one in told], "uniform", args=(20, 30)).pvalue > 0.01
    assert stats.kstest([one["radius"] for one in told], "uniform", args=(25, 5)).pvalue > 0.01
    # The angle of the miss vector about the relative velocity, from the upright plane through it.
    angles = []
    for one in told:
        along = one["closing"] / np.linalg.norm(one["closing"])
        level = np.cross([0, 0, 1], along) / np.linalg.norm(np.cross([0, 0, 1], along))
        angles.append(np.arctan2(one["miss_vector"] @ np.cross(along, level), one["miss_vector"] @ level))
    assert stats.kstest(angles, "uniform", args=(-np.pi, 2 * np.pi)).pvalue > 0.01


def test_an_encounter_that_takes_too_long_is_drawn_again() -> None:
    patient, hasty = ([geometry(plan) for plan in plans(400, population={"longest_s": s})] for s in (3600, 2.0))
    assert max(one["time_s"] for one in hasty) <= 2.0 < max(one["time_s"] for one in patient)
    same = [np.array_equal(a["direction"], b["direction"]) for a, b in zip(patient, hasty, strict=True)]
    assert same == [one["time_s"] <= 2.0 for one in patient]


def test_encounters_of_a_class_cross_and_climb_as_asked_and_are_the_first_draws_that_do() -> None:
    told = [geometry(plan) for plan in plans(150, population={"crossing_deg": [150, 180], "climb_deg": [-20, 5]})]
    own = unit(*DIRECTION)
    for one in told:
        assert 150 <= np.degrees(np.arccos(np.clip(one["direction"] @ own, -1, 1))) <= 180
        assert -20 - 1e-9 <= np.degrees(np.arcsin(one["direction"][2])) <= 5 + 1e-9
        assert one["miss"] <= one["radius"] + 1e-9
    every = [geometry(plan) for plan in plans(400)]
    of_class = [one for one in every if one["direction"] @ own <= np.cos(np.radians(90))]
    same = [geometry(plan) for plan in plans(400, population={"crossing_deg": [90, 180]})]
    assert {tuple(one["direction"]) for one in of_class} <= {tuple(one["direction"]) for one in same}
    with pytest.raises(ValidationError, match="crossing_deg: the first is more than the second"):
        plans(1, population={"crossing_deg": [90, 80]})


def test_several_obstacles_are_all_hit_one_after_the_other() -> None:
    population = {"trigger": {"time_to_cpa_s": 4.0}, "count": 3, "apart_s": 1.5}
    made = plans(60, population=population)
    first = plans(60, population={"trigger": {"time_to_cpa_s": 4.0}})
    for plan, alone in zip(made, first, strict=True):
        assert [one.name for one in plan.obstacles] == ["O", "O2", "O3"]
        assert plan.obstacles[0] == alone.obstacles[0]
        for k, one in enumerate(plan.obstacles):
            told = geometry(plan.model_copy(update={"obstacles": (one.model_copy(update={"name": "O"}),)}))
            assert told["time_s"] == pytest.approx(4.0 + 1.5 * k, abs=1e-9)
            assert told["miss"] <= one.radius_m + 1e-9
            assert told["range"] > one.radius_m
    axes = plans(2, {"obstacles.O3.radius_m": [10]}, population=population)
    assert [[one.radius_m == 10 for one in plan.obstacles] for plan in axes] == [[False, False, True]] * 2


def test_every_cell_meets_the_same_encounters_and_named_obstacles_stay() -> None:
    other = {"name": "P", "radius_m": 5, "position_enu_m": [0, 0, 500], "speed_mps": 0, "direction_deg": [0, 0]}
    sweep = {"method.kind": ["none", "scoam"], "plant.kind": ["kinematic", "jsbsim"], "aircraft": ["gtm_t2", "c172p"]}
    made = plans(4, sweep, obstacles=[other])
    assert all([one.name for one in plan.obstacles] == ["P", "O"] for plan in made)
    for replicate in range(4):
        assert len({plan.obstacles for plan in made if plan.replicate == replicate}) == 1
    assert len({plan.obstacles for plan in made}) == 4


def test_axes_and_draws_reach_the_drawn_obstacle() -> None:
    made = plans(
        3,
        {"traffic": {"with": {}, "rest": {"traffic.in_wind": "drifts"}}, "obstacles.O.radius_m": [10, 15]},
        draw={"obstacles.O.speed_mps": {"within": 1}},
    )
    plain = plans(3)
    assert [[one.radius_m for one in plan.obstacles] for plan in made] == [*[[10]] * 3, *[[15]] * 3] * 2
    moved = [abs(a.obstacles[0].speed_mps - b.obstacles[0].speed_mps) for a, b in zip(made[:3], plain, strict=True)]
    assert moved[0] == 0 < min(moved[1:]) <= max(moved) <= 1


def closest(plan: FlightPlan) -> tuple[float, float, float]:
    """(distance and closing speed where the own point is at the trigger, miss of the straight lines there) in the scene that is flown."""
    scene = make_scene(plan)
    (track,) = scene.tracks
    flat = make_scene(plan.model_copy(update={"geometry": "as_given"}))
    s_m = float(flat.route.nearest(np.array(AT)[None])[0][0])  # turning the scene level keeps lengths
    point, tangent, _ = scene.route.frame(s_m)
    time_s = (s_m - scene.begin_s_m) / plan.speed_mps
    apart, closing = np.array(track.at(time_s)[0]) - np.array(point), np.array(track.vel) - plan.speed_mps * np.array(tangent)
    miss = apart - (apart @ closing) / (closing @ closing) * closing
    return float(np.linalg.norm(apart)), float(np.linalg.norm(closing)), float(np.linalg.norm(miss))


def on_the_route() -> dict[str, Any]:
    """A population about a point that is exactly on the route, with the route's own direction."""
    route = make_scene(plans(1)[0]).route
    point, tangent, _ = route.frame(200.0)
    azimuth, elevation = np.degrees([np.arctan2(tangent[1], tangent[0]), np.arcsin(tangent[2])])
    return {"own_at_enu_m": [float(x) for x in point], "own_direction_deg": [float(azimuth), float(elevation)]}


def test_an_anchored_encounter_has_its_miss_and_closing_speed_in_wind_too() -> None:
    """On a straight route along x, in a wind of 9 m/s along and 12 m/s across it: ground speed by the wind triangle."""
    straight = {"start_enu_m": [0, 0, 0], "goal_enu_m": [900, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
    place = {"own_at_enu_m": [300, 0, 0], "own_direction_deg": [0, 0], "longest_s": 5}
    from_deg = float(np.degrees(np.arctan2(-9, -12)))  # towards east 9, north 12
    wind = {"wind": {"kind": "steady", "speed_mps": 15, "from_deg": from_deg % 360}}
    calm, windy = (plans(20, population=place, route=straight, traffic={"in_wind": "anchored"}, air=air) for air in ({}, wind))
    ground_mps = np.sqrt(50**2 - 12**2) + 9
    for still, moved in zip(calm, windy, strict=True):
        assert still.obstacles == moved.obstacles
        told = []
        for plan, speed in ((still, 50.0), (moved, ground_mps)):
            (track,) = make_scene(plan).tracks
            apart, closing = np.array(track.pos), np.array(track.vel) - [speed, 0, 0]
            miss = apart - (apart @ closing) / (closing @ closing) * closing
            told.append((*miss, np.linalg.norm(closing), -(apart @ closing) / (closing @ closing)))
        assert told[0] == pytest.approx(told[1], abs=1e-6)


@pytest.mark.parametrize("changes", [{}, {"geometry": "level"}])
def test_the_scene_that_is_flown_is_the_encounter_turned_level_too(monkeypatch: pytest.MonkeyPatch, changes: dict[str, Any]) -> None:
    place = on_the_route()
    monkeypatch.setattr(f"{__name__}.AT", tuple(place["own_at_enu_m"]))
    monkeypatch.setattr(f"{__name__}.DIRECTION", tuple(place["own_direction_deg"]))
    wanted = [geometry(plan) for plan in plans(20, population=place)]
    for told, plan in zip(wanted, plans(20, population=place, **changes), strict=True):
        distance, closing, miss = closest(plan)
        assert distance == pytest.approx(100, abs=1e-3)
        assert closing == pytest.approx(np.linalg.norm(told["closing"]), abs=1e-3)
        assert miss == pytest.approx(told["miss"], abs=1e-2)


FAULTS = [
    ("trigger: {range_m: 100}", "trigger: {}", "44:7: parts.population.encounters.trigger: give exactly one of range_m and time_to_cpa_s"),
    ("      trigger: {range_m: 100}\n", "", "41:5: parts.population.encounters.trigger: this key is missing"),
    ("range_m: 100}", "range_m: 30}", "41:5: parts.population.encounters: trigger.range_m must be more than the largest radius, 30 m"),
    ("range_m: 100}", "time_to_cpa_s: 11}", "41:5: parts.population.encounters: trigger.time_to_cpa_s must be at most longest_s = 10 s"),
    ("[20, 50]", "[50, 20]", "41:5: parts.population.encounters: obstacle_speed_mps: the first is more than the second"),
    ("[20, 50]", "[-20, 50]", "45:28: parts.population.encounters.obstacle_speed_mps[0]: must be at least 0 m/s, not -20 m/s"),
    ("[25, 30]", "25", "46:17: parts.population.encounters.radius_m: must be a list, not 25"),
    ("[25, 30]", "[0, 30]", "46:18: parts.population.encounters.radius_m[0]: must be more than 0 m, not 0 m"),
    ("{obstacles: []}", "{}", "41:5: parts.population.encounters: draw the obstacle 'O', and obstacles has one of that name"),
    (
        "trigger: {range_m: 100}",
        "trigger: {range_m: 1000}\n      longest_s: 1",
        "41:5: parts.population.encounters: none of 20,000 draws is an encounter that begins outside of the sphere and comes closest within"
        " longest_s",
    ),
    ("sensor.range_m: [100, 200]", "obstacles.O.radius_m: [1, -1]", "48:33: parts.population.sweep.obstacles.O.radius_m[1]: must be more than 0 m, not -1 m"),  # noqa: E501
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "head"), FAULTS)
def test_a_population_that_cannot_be_drawn_is_one_message_at_its_place(
    complaint: Callable[..., str], parted: str, old: str, new: str, head: str
) -> None:
    assert parted.count(old) == 1
    lines = complaint(parted.replace(old, new)).split("\n")
    assert (lines[0], len(lines)) == (f"bad.yaml:{head}", 3)


def test_an_override_changes_the_population_of_all_parts_that_have_none_of_their_own(write: Callable[[str], str], parted: str) -> None:
    told = "{own_at_enu_m: [0, 0, 0], own_direction_deg: [0, 0], trigger: {time_to_cpa_s: 1}, obstacle_speed_mps: [9, 9], radius_m: [2, 2]}"
    made = expand(load_campaign(write(parted), [f"encounters={told}", "obstacles=[]", "parts.wind.draw={}"]))
    assert {(plan.labels["part"], plan.obstacles[0].radius_m == 2) for plan in made} == {
        ("calm", True),
        ("wind", True),
        ("population", False),
    }


def test_a_campaign_made_in_python_is_refused_in_words() -> None:
    with pytest.raises(SpecError, match="none of 20,000 draws"):
        plans(1, population={"longest_s": 0.1})
