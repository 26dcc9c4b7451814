"""Encounters by their closest approach and the classic ones, against two straight lines; weights against what they stand for."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from testbed.campaign import Campaign, FlightPlan, SpecError, expand, load_campaign
from testbed.campaign.words.spread import Spread
from testbed.flight.scene import make_scene
from testbed.run import runner
from testbed.run.runner import Order
from tests.here import Here

Array = np.ndarray
AT, DIRECTION = (300.0, 0.0, 0.0), (0.0, 0.0)
ROUTE = {"start_enu_m": [0, 0, 0], "goal_enu_m": [900, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
PLACE = {"own_at_enu_m": AT, "own_direction_deg": DIRECTION}
APPROACH = {
    "kind": "approaches",
    "obstacles": [1, 6],
    "miss_m": {"edges": [0, 25, 100], "chances": [0.1, 0.9], "drawn": [0.5, 0.5]},
    "crossing_deg": [0, 180],
    "speed_mps": [20, 60],
    "vertical_rate_mps": [-5, 5],
    "time_to_cpa_s": [4, 8],
    "radius_m": 25,
}


def plans(replicates: int, encounters: dict[str, Any], **more: Any) -> tuple[FlightPlan, ...]:
    data = {"name": "demo", "question": "?", "seed": 6, "route": ROUTE, "replicates": replicates, "plant": {"kind": "kinematic"}}
    return expand(Campaign.model_validate({**data, "encounters": {**PLACE, **encounters}, **more}))


def approaches(plan: FlightPlan) -> list[dict[str, float]]:
    """Of each obstacle its closest approach to the own straight line, from what the plan says; at 50 m/s along x from (300, 0, 0)."""
    found = []
    for one in plan.obstacles:
        a, e = np.radians(one.direction_deg)
        vel = one.speed_mps * np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        apart, closing = np.array(one.position_enu_m) - AT, vel - [50.0, 0.0, 0.0]
        time_s = -(apart @ closing) / (closing @ closing)
        miss = apart + time_s * closing
        crossing = np.degrees(np.arctan2(abs(vel[1]), vel[0]))
        found.append({"time_s": time_s, "miss_m": np.linalg.norm(miss), "crossing_deg": crossing, "climb": vel[2], "speed": one.speed_mps})
    return found


def test_each_obstacle_has_the_closest_approach_that_was_drawn() -> None:
    made = plans(200, APPROACH)
    assert {len(plan.obstacles) for plan in made} == {1, 2, 3, 4, 5, 6}
    assert [one.name for one in max(made, key=lambda plan: len(plan.obstacles)).obstacles] == ["O1", "O2", "O3", "O4", "O5", "O6"]
    told = [one for plan in made for one in approaches(plan)]
    for name, low, high in (("time_s", 4, 8), ("miss_m", 0, 100), ("crossing_deg", 0, 180), ("climb", -5, 5), ("speed", 20, 60)):
        values = np.array([one[name] for one in told])
        assert low - 1e-6 <= values.min() < low + 0.1 * (high - low), name
        assert high - 0.1 * (high - low) < values.max() <= high + 1e-6, name
    assert 0.4 < np.mean([one["miss_m"] < 25 for one in told]) < 0.6  # as it is drawn, not as likely as it is


def test_weights_bring_back_the_chances() -> None:
    """A collision course is 1 in 10 and drawn 1 in 2; by its weight it is 1 in 10 again, and the weights have a mean of 1."""
    made = plans(1000, {**APPROACH, "obstacles": 1})
    weights, inside = np.array([plan.weight for plan in made]), np.array([approaches(plan)[0]["miss_m"] < 25 for plan in made])
    assert set(np.round(weights, 9)) == {0.2, 1.8}
    assert weights.mean() == pytest.approx(1.0, abs=4 * weights.std() / np.sqrt(len(made)))
    assert weights[inside].sum() / weights.sum() == pytest.approx(0.1, abs=0.02)


CHANCES = st.just(0.0) | st.floats(1e-9, 1.0)  # half of the least number that there is is 0


@settings(max_examples=40)
@given(st.lists(st.tuples(st.floats(0.1, 5.0), CHANCES, st.floats(0.05, 1.0)), min_size=1, max_size=6), st.floats(0.0, 1.0))
def test_a_spread_in_bins_is_its_distribution_whatever_is_drawn(bins: list[tuple[float, float, float]], level: float) -> None:
    """The weighted share of values up to any level is that of the chances."""
    if not sum(chance for _, chance, _ in bins):
        return
    edges = np.concatenate([[0.0], np.cumsum([width for width, _, _ in bins])])
    chances = np.array([chance for _, chance, _ in bins])
    spread = Spread(edges=tuple(edges), chances=tuple(chances), drawn=tuple(drawn for _, _, drawn in bins))
    shares = (np.arange(1000) + 0.5) / 1000
    values, weights = np.array([spread.at(share) for share in shares]).T
    at = level * edges[-1]
    expected = np.interp(at, edges, np.concatenate([[0.0], np.cumsum(chances)])) / chances.sum()
    assert weights[values <= at].sum() / 1000 == pytest.approx(expected, abs=0.02)


@pytest.mark.parametrize(
    ("kind", "more", "courses", "misses"),
    [
        ("head_on", {}, [180.0], [0.0]),
        ("overtaking", {}, [0.0], [0.0]),
        ("vertical_crossing", {}, [90.0], [0.0]),
        ("circle", {"n": 4}, [90.0, 180.0, 90.0], [0.0] * 3),
        ("wall", {"n": 3, "spacing_m": 70}, [180.0] * 3, [70.0, 0.0, 70.0]),
    ],
)
def test_the_classic_sets_meet_when_they_say(kind: str, more: dict[str, Any], courses: list[float], misses: list[float]) -> None:
    one, other = plans(2, {"kind": kind, **more})
    assert one.obstacles == other.obstacles
    told = approaches(one)
    assert [each["crossing_deg"] for each in told] == pytest.approx(courses, abs=1e-9)
    assert [each["miss_m"] for each in told] == pytest.approx(misses, abs=1e-9)
    assert [each["time_s"] for each in told] == pytest.approx([8.0] * len(told))
    assert one.weight == 1.0
    if kind == "circle":
        starts = np.array([AT, *(each.position_enu_m for each in one.obstacles)]) - [700.0, 0.0, 0.0]
        assert np.linalg.norm(starts, axis=1) == pytest.approx([400.0] * 4)


def saved(path: Path, **changes: Any) -> None:
    """One encounter as a struct: the own aircraft north at 164 ft/s (49.99 m/s), climbing; the other one turns right after 10 s."""
    sample = {
        "v_ftps": [164.0, 100.0], "n_ft": [500.0, 3500.0], "e_ft": [0.0, 1000.0], "h_ft": [1000.0, 1100.0],
        "heading_rad": [0.0, np.pi], "pitch_rad": [0.0, 0.1], "runTime_s": 30.0,
        "updates": [
            {"time_s": 0.0, "verticalRate_fps": 10.0, "turnRate_radps": 0.0, "longitudeAccel_ftpss": 0.0},
            {"time_s": 10.0, "verticalRate_fps": -5.0, "turnRate_radps": 0.05, "longitudeAccel_ftpss": 1.0},
        ],
    } | changes  # fmt: skip
    savemat(path, {"samples": {key: value for key, value in sample.items() if value is not None}})


def test_an_encounter_of_a_published_set_is_flown_as_it_was_scripted(tmp_path: Path) -> None:
    """Against its motion integrated step by step; the own aircraft gets a straight route of 30 s, and a changed file another flight."""
    foot, file = 0.3048, tmp_path / "set.mat"
    saved(file, weight=0.25)
    data = {"name": "demo", "question": "?", "route": ROUTE, "plant": {"kind": "kinematic"}}
    data["encounters"] = {"kind": "file", "path": "set.mat", "own_at_enu_m": [7.0, 8.0, 9.0]}
    (tmp_path / "c.yaml").write_text(json.dumps(data))
    (one,) = expand(load_campaign(tmp_path / "c.yaml"))
    assert (one.weight, one.speed_mps) == (0.25, pytest.approx(164 * foot))
    assert one.route.start_enu_m == (7.0, 8.0, 9.0)
    assert one.route.goal_enu_m == pytest.approx((7.0, 8.0 + 30 * 164 * foot, 9.0 + 300 * foot))
    (track,) = make_scene(one).tracks
    pos, speed, heading, climb = np.array([1000.0, 3000.0, 100.0]), 100 * np.cos(0.1), np.pi, 100 * np.sin(0.1)
    step = 0.001
    for k in range(25_000):
        rate, turn, climb = (0.0, 0.0, climb) if k < 10_000 else (1.0, 0.05, -5.0)
        middle_speed, middle = speed + 0.5 * step * rate, heading + 0.5 * step * turn
        pos = pos + step * np.array([middle_speed * np.sin(middle), middle_speed * np.cos(middle), climb])
        speed, heading = speed + step * rate, heading + step * turn
    assert np.array(track.at(25.0)[0]) == pytest.approx(foot * pos + [7.0, 8.0, 9.0], abs=1e-3)
    saved(file, weight=0.25, runTime_s=31.0)
    (other,) = expand(load_campaign(tmp_path / "c.yaml"))
    assert other.plugins["set.mat"] != one.plugins["set.mat"]
    assert other.flight_id != one.flight_id
    data["replicates"] = 2
    (tmp_path / "c.yaml").write_text(json.dumps(data))
    with pytest.raises(SpecError, match=r"set\.mat has 1 encounters: replicates must be at most that"):
        load_campaign(tmp_path / "c.yaml")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"v_ftps": None}, "set.mat: encounter 1: has no v_ftps"),
        ({"heading_rad": [0.0, np.nan]}, "set.mat: encounter 1: heading_rad must be 2 finite numbers"),
        ({"updates": [{"time_s": 0.0}]}, "set.mat: encounter 1: updates must be a struct for each of two aircraft"),
        ({"weight": -1.0}, "set.mat: encounter 1: weight is -1; it must not be less than 0"),
        ({"weight": 0.0}, "set.mat: all encounters have the weight 0"),
        ({"pitch_rad": [0.0, 2.0]}, "set.mat: encounter 1: pitch_rad of aircraft 2 is 2"),
        ({"v_ftps": [0.0, 100.0]}, "set.mat: encounter 1: aircraft 1, which is flown, begins with a speed of 0"),
        ({"a_ftpss": [0.0, -30.0]}, "set.mat: encounter 1: aircraft 2 brakes to a standstill"),
    ],
)
def test_a_bad_encounter_is_one_sentence_with_its_number(tmp_path: Path, change: dict[str, Any], said: str) -> None:
    saved(tmp_path / "set.mat", **change)
    (tmp_path / "c.yaml").write_text(
        json.dumps({"name": "d", "question": "?", "route": ROUTE, "encounters": {"kind": "file", "path": "set.mat"}})
    )
    with pytest.raises(SpecError) as told:
        load_campaign(tmp_path / "c.yaml")
    assert said in str(told.value)
    (tmp_path / "set.mat").write_bytes(b"MATLAB?")
    with pytest.raises(SpecError, match=r"set\.mat: is no MATLAB file that can be read"):
        load_campaign(tmp_path / "c.yaml")


FAULTS = [
    ({"miss_m": {"edges": [0, 25], "chances": [0.1, 0.9]}}, "encounters.miss_m: chances: has 2 for 1 bins"),
    ({"miss_m": [30, 20]}, "encounters.miss_m: must not go down"),
    ({"miss_m": "near"}, "encounters.miss_m: must be a section"),
    ({"obstacles": 7}, "encounters.obstacles: must be at most 6, not 7"),
    ({"obstacles": "two"}, "encounters.obstacles: must be a whole number or a list, not the text 'two'"),
    ({"crossing_deg": [0, 190]}, "crossing_deg: must be between 0 and 180 deg, not 0 to 190"),
    ({"vertical_rate_mps": 30}, "vertical_rate_mps: is more than the least speed_mps"),
    ({"kind": "sideways"}, "encounters.kind: must be one of 'drawn', 'approaches', 'circle'"),
    ({"kind": "head_on"}, "encounters.obstacles: unknown key 'obstacles'"),
    ({"speed_mps": 50, "crossing_deg": 0, "vertical_rate_mps": 0}, "none of 1,000 draws begins outside of the sphere"),
]


@pytest.mark.parametrize(("change", "said"), FAULTS)
def test_what_cannot_be_met_is_one_sentence(tmp_path: Path, change: dict[str, Any], said: str) -> None:
    data = {"name": "demo", "question": "?", "route": ROUTE, "encounters": {**PLACE, **APPROACH, **change}}
    (tmp_path / "c.yaml").write_text(json.dumps(data))
    with pytest.raises(SpecError) as told:
        load_campaign(tmp_path / "c.yaml")
    assert said in str(told.value)


@pytest.mark.slow
def test_the_weight_is_a_column_where_there_are_weights(tmp_path: Path) -> None:
    data = {"name": "demo", "question": "?", "route": ROUTE, "replicates": 3, "plant": {"kind": "kinematic"}, "recordings": "none"}
    for name, encounters in (("weighted", {**APPROACH, "obstacles": 2}), ("plain", {"kind": "head_on"})):
        (tmp_path / "c.yaml").write_text(json.dumps({**data, "encounters": {**PLACE, **encounters}}))
        assert runner.run(Order(source=tmp_path / "c.yaml", out=tmp_path / name, engine=Here())).crashed == 0
        with (tmp_path / name / "results.csv").open() as file:
            rows = list(csv.DictReader(file))
        if name == "plain":
            assert "weight" not in rows[0]
        else:
            assert [float(row["weight"]) for row in rows] == [plan.weight for plan in expand(load_campaign(tmp_path / "c.yaml"))]
