"""Settings drawn for each replicate: where they lie, that they are the same for whatever is compared, and what is refused."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy import stats

from testbed.campaign import Campaign, FlightPlan, SpecError, expand, load_campaign
from testbed.core.seeds import stream

ROUTE = {"start_enu_m": (0, 0, 0), "goal_enu_m": (500, 0, 0), "start_direction_deg": (0, 0), "goal_direction_deg": (30, 0)}
SPHERE = {"name": "O", "radius_m": 25, "position_enu_m": (250, 0, 0), "speed_mps": 40, "direction_deg": (106, 12.4)}


def plans(draw: dict[str, object], sweep: object = None, **settings: object) -> tuple[FlightPlan, ...]:
    data = {"name": "demo", "question": "?", "route": ROUTE, "obstacles": [SPHERE], "draw": draw, "sweep": sweep or {}}
    return expand(Campaign.model_validate({**data, **settings}))


def test_replicate_0_is_as_written_and_the_others_lie_evenly_in_the_range() -> None:
    draw = {
        "obstacles.O.direction_deg": {"within": [0.5, 0.05]},
        "route.goal_direction_deg": {"within": 5},
        "replan.k": {"between": [1, 1.5]},
        "sensor.range_m": {"within": 10},
    }
    nominal, *drawn = plans(draw, replicates=400, seed=4)
    assert (nominal.obstacles[0].direction_deg, nominal.route.goal_direction_deg) == ((106, 12.4), (30, 0))
    assert (nominal.replan.k, nominal.sensor.range_m) == (1.25, 100)
    rows = np.array(
        [(*plan.obstacles[0].direction_deg, *plan.route.goal_direction_deg, plan.replan.k, plan.sensor.range_m) for plan in drawn]
    )
    low = np.array([105.5, 12.35, 25, -5, 1, 90])
    share = (rows - low) / np.array([1, 0.1, 10, 10, 0.5, 20])
    for column in share.T:
        assert stats.kstest(column, "uniform").pvalue > 0.01
    assert np.abs(np.corrcoef(share.T) - np.eye(6)).max() < 4 / np.sqrt(400)


def test_the_stream_is_the_one_that_is_documented() -> None:
    drawn = plans({"replan.k": {"between": [1, 1.5]}, "obstacles.O.direction_deg": {"within": [0.5, 0.05]}}, replicates=4, seed=9)[3]
    assert drawn.replan.k == pytest.approx(1 + 0.5 * stream(9, 3, "draw.replan.k").random(), abs=1e-15)
    two = stream(9, 3, "draw.obstacles.O.direction_deg").uniform(-1, 1, size=2)
    assert drawn.obstacles[0].direction_deg == pytest.approx(np.array([106, 12.4]) + two * [0.5, 0.05], abs=1e-13)


def test_whatever_is_compared_gets_the_same_draws_about_what_it_sets() -> None:
    sweep = {"method.kind": ["none", "scoam"], "plant.kind": ["kinematic", "jsbsim"], "obstacles.O.radius_m": [20, 30]}
    draw = {"obstacles.O.radius_m": {"within": 2}, "replan.k": {"between": [1, 2]}}
    by_replicate: dict[int, set[tuple[float, float]]] = {}
    for plan in plans(draw, sweep, replicates=5):
        offset = round(plan.obstacles[0].radius_m - float(plan.labels["obstacles.O.radius_m"]), 9)
        by_replicate.setdefault(plan.replicate, set()).add((offset, plan.replan.k))
    assert [len(values) for values in by_replicate.values()] == [1] * 5
    assert len(set.union(*by_replicate.values())) == 5
    assert by_replicate[0] == {(0, 1.25)}


def test_a_draw_does_not_move_another_and_the_id_stands_for_the_values() -> None:
    few = plans({"replan.k": {"between": [1, 2]}}, replicates=3)
    more = plans({"sensor.range_m": {"within": 5}, "replan.k": {"between": [1, 2]}}, replicates=3)
    other = plans({"replan.k": {"between": [1, 2.5]}}, replicates=3)
    assert [plan.replan.k for plan in few] == [plan.replan.k for plan in more]
    assert [a.flight_id == b.flight_id for a, b in zip(few, more, strict=True)] == [True, False, False]
    assert [a.flight_id == b.flight_id for a, b in zip(few, other, strict=True)] == [True, False, False]


def test_one_of_several_values_sections_too() -> None:
    winds = [{"kind": "calm"}, {"kind": "steady", "speed_mps": 5, "from_deg": 90}]
    drawn = plans({"air.wind": {"among": winds}, "method.kind": {"among": ["none", "scoam", "orca"]}}, replicates=301)[1:]
    kinds = [plan.air.wind.kind for plan in drawn]
    methods = [plan.method.kind for plan in drawn]
    assert abs(kinds.count("calm") - 150) < 4 * np.sqrt(300 / 4)
    assert all(abs(methods.count(name) - 100) < 4 * np.sqrt(300 * 2 / 9) for name in ("none", "scoam", "orca"))


def test_a_part_adds_its_draws_to_those_of_the_campaign(write: Callable[[str], str], parted: str) -> None:
    wind = [plan for plan in expand(load_campaign(write(parted), ["parts.wind.replicates=3"])) if plan.cell == "wind"]
    assert len({plan.replan.k for plan in wind}) == len({plan.route.magnitude_chords for plan in wind}) == 3
    assert all(1.15 <= plan.replan.k <= 1.35 for plan in wind)
    (other,) = [plan for plan in expand(load_campaign(write(parted), ["parts.wind.draw.replan.k={between: [3, 3]}"])) if plan.replan.k == 3]
    assert (other.cell, other.replicate) == ("wind", 1)


IN_WIND = [
    # (what stands in the place of the draw of magnitude_chords, the message, the hint)
    ("route.magnitude_cords: {within: 1}", "route.magnitude_cords: unknown setting 'route.magnitude_cords'", "did you mean"),
    ("obstacles.P.radius_m: {within: 1}", "obstacles.P.radius_m: there is no obstacle 'P' (in the cell 'wind')", "there are: O"),
    ("seed: {within: 1}", "seed: 'seed' belongs to the campaign as a whole, not to a flight", ""),
    ("replan.k: {within: 0.3}", "replan.k: must be at least 1, not 0.95 (in the cell 'wind')", ""),
    ("replan.k: {between: [1, 2, 3]}", "replan.k.between: must have 2 values, not 3", ""),
    ("replan.k: {between: [2, 1]}", "replan.k: between: the first is more than the second", ""),
    ("replan.k: {between: [1, [2]]}", "replan.k: between takes two numbers, or two lists of as many numbers", ""),
    ("replan.k: {within: -1}", "replan.k: within is a distance to either side: at least 0", ""),
    ("replan.k: {within: x}", "replan.k.within: must be a finite number, or a list of them", ""),
    ("replan.k: {within: [.nan]}", "replan.k.within: must be a finite number, or a list of them", ""),
    ("replan.k: {within: [0.1, 0.1]}", "replan.k: has one value, within 2 (in the cell 'wind')", ""),
    ("replan.k: {around: 1}", "replan.k.around: unknown key 'around'", "known here: within, between, among"),
    ("replan.k: {}", "replan.k: give exactly one of within, between and among", ""),
    ("replan.k: {within: 0, among: [1]}", "replan.k: give exactly one of within, between and among", ""),
    ("replan.k: {among: []}", "replan.k: among needs at least one value", ""),
    ("replan.k: 1", "replan.k: must be a section (keys and values), not 1", ""),
    ("method.kind: {within: 1}", "method.kind: is no number, nor a list of numbers: draw it with among (in the cell 'wind')", ""),
    ("method.kind: {among: [none, scom]}", "method.kind: no method 'scom'; there are: ", "did you mean 'scoam'?"),
    ("begin.climb_at_most_deg: {within: 1}", "begin.climb_at_most_deg: has no value about which to draw (in the cell 'wind')", ""),
    ("rates.plant_hz: {within: 1}", "rates.plant_hz: must be a whole number, not 119.0 (in the cell 'wind')", ""),
    ("obstacles.O.position_enu_m: {between: [[0, 0], [1, 1]]}", "obstacles.O.position_enu_m: must have 3 values, not 2 (in the cell", ""),
    ("route.goal_direction_deg: {within: [0, 88]}", "route.goal_direction_deg[1]: must be at most 90 deg, not 90.84 deg (in", ""),
]


@pytest.mark.parametrize(("new", "message", "hint"), IN_WIND)
def test_a_draw_that_cannot_be_made_is_one_message_at_its_place(
    complaint: Callable[..., str], parted: str, new: str, message: str, hint: str
) -> None:
    old = "route.magnitude_chords: {between: [0.6, 2.2]}"
    head, source, caret = complaint(parted.replace(old, new)).split("\n")
    assert head.startswith("bad.yaml:36:")
    assert head.partition(": ")[2].startswith(f"parts.wind.draw.{message}")
    assert source.endswith(new)
    assert hint in caret


def test_a_range_is_checked_about_what_each_cell_sets(complaint: Callable[..., str], good: str) -> None:
    text = good + "  replan.k: [1.2, 1.1]\ndraw: {replan.k: {within: 0.15}}\n"
    assert (
        complaint(text).split("\n")[0]
        == "bad.yaml:27:8: draw.replan.k: must be at least 1, not 0.9500000000000001 (in the cell 'none/slow/1.1')"
    )


def test_a_draw_must_not_overwrite_an_axis(complaint: Callable[..., str], good: str) -> None:
    message = complaint(good + "draw: {method: {among: [{kind: none}]}}\n")
    assert message.split("\n")[0] == "bad.yaml:26:8: draw.method: overwrites what the axis 'method.kind' of the sweep sets"
    with pytest.raises(SpecError, match="overwrites what the axis"):
        plans({"replan.k": {"between": [1, 2]}}, {"replan.k": [1, 2]})


def test_a_campaign_made_in_python_is_refused_in_words() -> None:
    for draw in (
        {"replan.k": {"within": 1}},
        {"obstacles.P.radius_m": {"within": 1}},
        {"method.kind": {"within": 1}},
        {"no.such": {"within": 1}},
    ):
        with pytest.raises(SpecError, match=r"must be at least 1|obstacles.P.radius_m: has no value|is no number|unknown setting"):
            plans(draw, replicates=20)
