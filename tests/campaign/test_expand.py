"""From a campaign to its flights: how many, in which order, and who is who."""

import json
import os
import subprocess
import sys
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from testbed.campaign import Campaign, FlightPlan, SpecError, expand, load_campaign
from testbed.campaign.reading.axes import axes_of
from testbed.campaign.reading.expand import flight_id
from testbed.campaign.reading.nodes import Tree

Write = Callable[[str], str]

ROUTE = {"start_enu_m": (0, 0, 0), "goal_enu_m": (500, 0, 0), "start_direction_deg": (0, 0), "goal_direction_deg": (0, 0)}
SPHERE = {"name": "O", "radius_m": 25, "position_enu_m": (250, 0, 0), "speed_mps": 40, "direction_deg": (90, 0)}


def campaign(sweep: object = None, **settings: object) -> Campaign:
    return Campaign.model_validate({"name": "demo", "question": "?", "route": ROUTE, "sweep": sweep or {}, **settings})


def cells(sweep: object, **settings: object) -> list[str]:
    return [plan.cell for plan in expand(campaign(sweep, **settings))]


def test_the_last_axis_is_fastest_and_replicates_are_innermost() -> None:
    plans = expand(
        campaign({"sensor.range_m": [50, 100], "flown": {"point": {"plant.kind": "kinematic"}, "real": {}}}, replicates=2, seed=9)
    )
    assert [(plan.cell, plan.replicate) for plan in plans] == [
        *(("50/point", 0), ("50/point", 1), ("50/real", 0), ("50/real", 1)),
        *(("100/point", 0), ("100/point", 1), ("100/real", 0), ("100/real", 1)),
    ]
    assert plans[2].labels == {"sensor.range_m": "50", "flown": "real"}
    assert [(plan.sensor.range_m, plan.plant.kind) for plan in plans[::2]] == [
        (50, "kinematic"),
        (50, "jsbsim"),
        (100, "kinematic"),
        (100, "jsbsim"),
    ]
    assert {(plan.seed, plan.campaign) for plan in plans} == {(9, "demo")}


def test_a_campaign_without_a_sweep_is_one_cell() -> None:
    (plan,) = expand(campaign())
    assert (plan.cell, plan.labels) == ("base", {})


def test_a_path_to_a_section_replaces_it_and_a_path_into_it_does_not() -> None:
    sweep = {"replan": [{"k": 2}], "begin": [{"climb_at_most_deg": 18}], "sensor.range_m": [7]}
    (plan,) = expand(campaign(sweep, replan={"k": 3, "horizon_s": 4}, begin={"at_route_s_m": 5}, sensor={"kind": "truth", "range_m": 6}))
    assert (plan.replan.k, plan.replan.horizon_s) == (2, 10)  # horizon_s is back at its default
    assert (plan.begin.at_route_s_m, plan.begin.climb_at_most_deg) == (None, 18)
    assert plan.sensor.range_m == 7


def test_a_default_does_not_stand_in_the_way_of_its_alternative() -> None:
    """``begin`` has a default arc length, ``when`` a default time: neither was written, so neither conflicts."""
    sweep = {"begin.climb_at_most_deg": [18], "obstacles.O.when.own_reaches_enu_m": [[1, 2, 3]]}
    (plan,) = expand(campaign(sweep, obstacles=[SPHERE]))
    assert (plan.begin.climb_at_most_deg, plan.obstacles[0].when.own_reaches_enu_m) == (18, (1, 2, 3))


def test_obstacles_are_addressed_by_name() -> None:
    other = {**SPHERE, "name": "P"}
    plans = expand(campaign({"obstacles.P.speed_mps": [10, 20], "obstacles.O": [{**SPHERE, "radius_m": 1}]}, obstacles=[SPHERE, other]))
    assert [[(one.name, one.radius_m, one.speed_mps) for one in plan.obstacles] for plan in plans] == [
        [("O", 1, 40), ("P", 25, 10)],
        [("O", 1, 40), ("P", 25, 20)],
    ]


def test_the_tagged_section_of_a_default_can_be_swept_into() -> None:
    """A campaign built in Python need not have written the tag of a union."""
    made = campaign().model_copy(update={"air": Campaign.model_fields["air"].default})
    assert cells({}) == [plan.cell for plan in expand(made)]
    sweep = {"air.wind": [{"kind": "calm"}, {"kind": "steady", "speed_mps": 3, "from_deg": 90}], "air.turbulence.kind": ["none"]}
    assert [plan.air.wind.kind for plan in expand(campaign(sweep))] == ["calm", "steady"]


@pytest.mark.parametrize(
    ("values", "labels"),
    [
        ([1, 2.5, 1e-9, 150.0], ["1", "2.5", "1e-09", "150"]),
        ([{"kind": "kinematic"}, {"kind": "jsbsim"}], ["kind=kinematic", "kind=jsbsim"]),
        ([[135, 12.4], [106, 12.4]], ["[135,12.4]", "[106,12.4]"]),
        (["a/b", "a_b"], ["a_b", "a_b~1"]),
        ([True, False, None], ["true", "false", "null"]),
        (["x" * 50 + "1", "x" * 50 + "2"], ["x" * 32 + "~1", "x" * 32 + "~2"]),
        (["two\nlines", ""], ["two_lines", "_"]),
    ],
)
def test_labels_of_plain_values_are_short_and_differ(values: list[object], labels: list[str]) -> None:
    (axis,), problems = axes_of(Tree.plain({"method.options.x": values}))
    assert not problems
    assert [level.label for level in axis.levels] == labels


def test_a_sweep_made_in_python_is_checked_too() -> None:
    with pytest.raises(SpecError) as caught:
        expand(campaign({"methd.kind": ["none"], "sensor.range_m": [1, 1]}))
    assert str(caught.value).split("\n") == [
        "sweep.methd.kind: unknown setting 'methd.kind' (did you mean 'method.kind'?)",
        "sweep.sensor.range_m[1]: this value is there twice",
    ]
    with pytest.raises(SpecError) as caught:
        expand(campaign({"sensor.range_m": [-1]}))
    assert str(caught.value) == "sweep.sensor.range_m[0]: must be more than 0 m, not -1 m"
    with pytest.raises(SpecError) as caught:
        expand(campaign({"obstacles": [[], [SPHERE]], "obstacles.O.radius_m": [1]}, obstacles=[SPHERE]))
    assert str(caught.value) == "sweep.obstacles.O.radius_m[0]: there is no obstacle 'O' (there are none)"


def test_the_same_in_a_file_is_found_at_load_with_its_place(complaint: Callable[..., str], good: str) -> None:
    message = complaint(good.replace("  method.kind: [none, scoam]", "  obstacles: [[]]\n  obstacles.O.radius_m: [1]"))
    assert message.startswith("bad.yaml:23:26: sweep.obstacles.O.radius_m[0]: there is no obstacle 'O' (in the cell ")


def test_ids_are_distinct_and_tell_physics_cell_replicate_and_seed_apart() -> None:
    plans = expand(campaign({"plant.kind": ["kinematic", "jsbsim"]}, replicates=3))
    ids = [plan.flight_id for plan in plans]
    assert len(set(ids)) == 6
    assert all(len(one) == 12 and int(one, 16) >= 0 for one in ids)
    assert [plan.flight_id for plan in expand(campaign({"plant.kind": ["kinematic", "jsbsim"]}, replicates=3, seed=1))] != ids
    assert set(ids).isdisjoint(plan.flight_id for plan in expand(campaign({"plant.kind": ["kinematic", "jsbsim"]}, speed_mps=49)))


def test_ids_do_not_depend_on_names_notation_or_more_replicates() -> None:
    """A longer or renamed campaign keeps its flights: their records can be reused."""
    few, many = (
        expand(campaign({"sensor.range_m": [50]})),
        expand(campaign({"sensor.range_m": [50.0]}, replicates=2, name="other", speed_mps=50)),
    )
    assert few[0].flight_id == many[0].flight_id
    assert few[0].campaign != many[0].campaign
    there, back = (
        expand(campaign(method={"kind": "planes", "options": dict(pairs)}))[0]
        for pairs in ([("n", 6), ("offset_rad", 2)], [("offset_rad", 2), ("n", 6)])
    )
    assert there.flight_id == back.flight_id


def test_a_plan_keeps_its_id_through_json() -> None:
    for plan in expand(
        campaign(
            {"plant.kind": ["kinematic", "jsbsim"]},
            obstacles=[SPHERE],
            method={"kind": "scoam", "options": {"corners_only": True, "consider": "all"}},
        )
    ):
        again = FlightPlan.model_validate_json(plan.model_dump_json())
        assert again == plan
        assert flight_id(again) == plan.flight_id
        assert flight_id(FlightPlan.model_validate(json.loads(plan.model_dump_json()))) == plan.flight_id


@pytest.mark.slow
def test_ids_are_the_same_in_every_process(write: Write, good: str) -> None:
    path = write(good)
    code = f"from testbed.campaign import expand, load_campaign\nprint([p.flight_id for p in expand(load_campaign({path!r}))])"
    answer = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, "PYTHONHASHSEED": "2"}, capture_output=True, text=True, check=True
    ).stdout
    assert answer == f"{[plan.flight_id for plan in expand(load_campaign(path))]}\n"


def test_a_loaded_campaign_expands_to_the_plans_of_its_data(write: Write, good: str) -> None:
    """Sections validated at load and sections validated per cell give the same flights."""
    loaded = load_campaign(write(good))
    again = Campaign.model_validate_json(loaded.model_dump_json(exclude_unset=True))
    assert expand(loaded) == expand(again)


axis_values = {
    "speed_mps": st.floats(1, 150),
    "sensor.range_m": st.integers(1, 500),
    "replan.k": st.floats(1, 5),
    "obstacles.O.direction_deg": st.tuples(st.floats(-180, 180), st.floats(-90, 90)).map(list),
    "plant.kind": st.sampled_from(["kinematic", "jsbsim"]),
    "method.kind": st.sampled_from(["none", "scoam"]),
}


@st.composite
def sweeps(draw: st.DrawFn) -> dict[str, list[object]]:
    names = draw(st.lists(st.sampled_from(sorted(axis_values)), unique=True, max_size=4))
    return {name: draw(st.lists(axis_values[name], min_size=1, max_size=3, unique_by=str)) for name in names}


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(sweep=sweeps(), replicates=st.integers(1, 3))
def test_every_combination_is_there_once_with_its_values(sweep: dict[str, list[object]], replicates: int) -> None:
    plans = expand(campaign(sweep, obstacles=[SPHERE], replicates=replicates))
    expected = replicates
    for values in sweep.values():
        expected *= len(values)
    assert len(plans) == expected
    assert len({plan.flight_id for plan in plans}) == expected
    assert len({(plan.cell, plan.replicate) for plan in plans}) == expected
    for plan in plans:
        assert list(plan.labels) == list(sweep)
        if "sensor.range_m" in sweep:
            assert plan.labels["sensor.range_m"] == str(int(plan.sensor.range_m))
        if "plant.kind" in sweep:
            assert plan.labels["plant.kind"] == plan.plant.kind
