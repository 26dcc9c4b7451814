"""Encounters by their closest approach and the classic ones, against two straight lines; weights against what they stand for."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from testbed.campaign import Campaign, FlightPlan, SpecError, expand, load_campaign
from testbed.campaign.words.encounters import Spread
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


@settings(max_examples=40)
@given(st.lists(st.tuples(st.floats(0.1, 5.0), st.floats(0.0, 1.0), st.floats(0.05, 1.0)), min_size=1, max_size=6), st.floats(0.0, 1.0))
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


FAULTS = [
    ({"miss_m": {"edges": [0, 25], "chances": [0.1, 0.9]}}, "encounters.miss_m: chances: has 2 for 1 bins"),
    ({"miss_m": [30, 20]}, "encounters.miss_m: must not go down"),
    ({"miss_m": "near"}, "encounters.miss_m: must be a section"),
    ({"obstacles": 7}, "encounters.obstacles"),
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
