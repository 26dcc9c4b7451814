"""The options of every part that is built in: each one wrong in each way is told with its place, and each one that is documented flies."""

import math
from pathlib import Path
from typing import Any, get_args, get_origin

import pytest
from pydantic import BaseModel
from pydantic_core import PydanticUndefined

from testbed import expand, fly, load_campaign, measure
from testbed.campaign import SpecError
from testbed.core import options, registry
from tests.command import testbed

HEAD = """\
name: options
question: Which options does it take?
route: {start_enu_m: [0, 0, 0], goal_enu_m: [500, 200, 100], start_direction_deg: [40.87, 26.13], goal_direction_deg: [10.00, 2.84]}
begin: {at_route_s_m: 122}
obstacles:
  - {name: O, radius_m: 25, position_enu_m: [254, 63.6, 60.7], speed_mps: 40, direction_deg: [106.1, 10.4], when: {own_reaches_enu_m: [162, 101, 64.3]}}
plant: {kind: kinematic}
"""  # noqa: E501 (one obstacle, one line)

SHARED = {"spare_m": (5.0, -1.0), "most_mps2": (15.0, 0.0)}  # by the laws over time
METHODS: dict[str, dict[str, Any]] = {  # every option of every method: a value other than its default, and one that it refuses
    "scoam": {
        "boundary": ("exact", "nearly"),
        "objective": ("right_of_way", "best"),
        "goal": ([1.0, 0.0, 0.0], [1.0, 0.0]),
        "corners_only": (True, 1),
        "consider": ("all", "some"),
        "root": ("nearer", "first"),
        "half_angle": ("corrected", "obtuse"),
        "bearing_deg": (30.0, math.inf),
        "component": ("x", "w"),
        "component_mps": (40.0, math.inf),
        "bank_rad": (0.2, "level"),
    },
    "least_deflection": {"speed_range_mps": ([45, 55], [55, 45])},
    "droam_hp": {"side": ("left", "up")},
    "droam_vp": {"side": ("up", "left")},
    "planes": {"n": (6, 0), "offset_rad": (0.1, math.inf)},
    "random_planes": {"n": (6, 10**9), "seed": (3, -1)},
    "potential_field": {"gain": (2.0, 0.0), "reach": (6.0, -1.0), "goal": ([1.0, 0.5, 0.0], [0, 0, 0, 0])},
    "one_plane": {"plane": ("vertical", "slanted")},
    "outward_search": {"step_deg": (2.0, 0.0), "bearings": (24, 3)},
    "tangent_lyapunov": {"standoff": (1.5, 0.5)},
    "interfered_fluid": {"rho": (2.0, 0.0), "sigma": (2.0, 100.0)},
    "orca": {"responsibility": (0.5, 1.5), "horizon_s": (20.0, 0.0), "keep_speed": (False, 0)},
    "geometric_guidance": {"form": ("differential", "linear"), "gain_1ps": (4.0, 0.0), **SHARED},
    "proportional_navigation": {"gain": (4.0, 1.0), "plane": ("free", "slanted"), **SHARED},
    "constant_curvature": {"share": (0.7, 1.0), **SHARED},
    "extended_navigation": {"gain": (3.0, 1.0), "decay_1ps": (4.0, 0.0), "plane": ("larger", "free"), **SHARED},
    "minimum_effort": {"then": ("nothing", "home"), **SHARED},
    "field_guidance": {"gain": (2.0, 0.0), "reach": (6.0, -1.0), "pull_mps2": (10.0, 0.0), **SHARED},
}
BESIDE: dict[tuple[str, str], dict[str, Any]] = {
    ("scoam", "goal"): {"objective": "goal"},
    ("scoam", "component"): {"component_mps": 40.0},
    ("scoam", "component_mps"): {"component": "x"},
    ("scoam", "bank_rad"): {"objective": "least_roll"},
}  # what an option needs beside it
CASES = [(method, name) for method, of_method in METHODS.items() for name in of_method]


def declared(method: str) -> type[BaseModel]:
    part = registry.part("method", method)
    return options.model_of(part, registry.given("method", part))


def problem(tmp_path: Path, method: str, written: str) -> str:
    path = tmp_path / "campaign.yaml"
    path.write_text(f"{HEAD}method: {{kind: {method}, options: {{{written}}}}}\n")
    with pytest.raises(SpecError) as told:
        load_campaign(path)
    return str(told.value)


def yaml(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(yaml, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    return {math.inf: ".inf"}.get(value, str(value)) if isinstance(value, float) else str(value)


def test_every_option_of_every_method_is_here() -> None:
    found = {name: set(declared(name).model_fields) for name in registry.names("method")}
    assert {name: set(of_method) for name, of_method in METHODS.items()} == {name: of for name, of in found.items() if of}


@pytest.mark.parametrize(("method", "name"), CASES)
def test_a_documented_option_flies(tmp_path: Path, method: str, name: str) -> None:
    given = {name: METHODS[method][name][0], **BESIDE.get((method, name), {})}
    path = tmp_path / "campaign.yaml"
    written = ", ".join(f"{key}: {yaml(value)}" for key, value in given.items())
    path.write_text(f"{HEAD}method: {{kind: {method}, options: {{{written}}}}}\n")
    (plan,) = expand(load_campaign(path))
    assert set(plan.method.options) == set(given)
    assert all(type(plan.method.options[key]) in (type(value), tuple, float) for key, value in given.items())
    metrics = measure(fly(plan))
    assert metrics.outcome in ("reached", "collided", "no_path")
    assert math.isfinite(metrics.least_clearance_m)


@pytest.mark.parametrize(("method", "name"), CASES)
def test_a_bad_value_is_told_where_it_stands(tmp_path: Path, method: str, name: str) -> None:
    bad = yaml(METHODS[method][name][1])
    told = problem(tmp_path, method, f"{name}: {bad}")
    line, column = 8, len(f"method: {{kind: {method}, options: {{{name}: ") + 1
    assert told.startswith(f"{tmp_path}/campaign.yaml:{line}:"), told
    assert f":{line}:{column}: method.options.{name}: " in told


@pytest.mark.parametrize(("method", "name"), CASES)
def test_a_wrong_type_is_told_where_it_stands(tmp_path: Path, method: str, name: str) -> None:
    wrong = "{a: 1}"
    assert f"8:{len(f'method: {{kind: {method}, options: {{') + 1}: method.options.{name}: " in problem(
        tmp_path, method, f"{name}: {wrong}"
    )


@pytest.mark.parametrize("method", registry.names("method"))
def test_an_unknown_name_is_told_with_the_known_ones(tmp_path: Path, method: str) -> None:
    told = problem(tmp_path, method, "sidd: 1")
    column = len(f"method: {{kind: {method}, options: {{") + 1
    assert f"8:{column}: method.options.sidd: unknown option 'sidd' of the method '{method}'" in told
    known = list(declared(method).model_fields)
    assert (", ".join(known) if known else "which has none") in told


def test_all_that_is_wrong_is_told_at_once(tmp_path: Path) -> None:
    told = problem(tmp_path, "random_planes", "n: 2.5, seed: x, sed: 1")
    assert [line.split(": ", 1)[1] for line in told.splitlines() if ".yaml:" in line] == [
        "method.options.n: must be a whole number, not 2.5",
        "method.options.seed: must be a whole number, not the text 'x'",
        "method.options.sed: unknown option 'sed' of the method 'random_planes'; it has: n, seed",
    ]


@pytest.mark.parametrize("section", ["guidance", "plant", "sensor"])
def test_other_families_refuse_what_their_parts_do_not_have(tmp_path: Path, section: str) -> None:
    for kind in registry.names(section):
        path = tmp_path / "campaign.yaml"
        path.write_text(HEAD.replace("plant: {kind: kinematic}\n", "") + f"{section}: {{kind: {kind}, options: {{gian: 2}}}}\n")
        with pytest.raises(SpecError, match=rf"7:\d+: {section}.options.gian: unknown option 'gian' of the {section} '{kind}'"):
            load_campaign(path)


def test_an_option_keeps_its_type_through_a_sweep_and_json(tmp_path: Path) -> None:
    path = tmp_path / "campaign.yaml"
    path.write_text(f"{HEAD}method: {{kind: planes}}\nsweep:\n  method.options.n: [4, 6]\n")
    plans = expand(load_campaign(path))
    assert [type(plan.method.options["n"]) for plan in plans] == [int, int]
    again = [type(plan).model_validate_json(plan.model_dump_json()) for plan in plans]
    assert list(plans) == again


@pytest.mark.slow
def test_the_command_says_so_and_exits_with_2(tmp_path: Path) -> None:
    path = tmp_path / "campaign.yaml"
    path.write_text(f"{HEAD}method: {{kind: droam_hp, options: {{side: up}}}}\n")
    done = testbed("run", path, "--out", tmp_path / "out", cwd=tmp_path)
    assert done.returncode == 2
    assert "campaign.yaml:8:42: method.options.side: must be one of 'least', 'left', 'right', not 'up'" in done.stderr
    assert not (tmp_path / "out").exists()


def test_types_of_signatures_that_a_yaml_cannot_say_are_refused() -> None:
    def takes_a_function(own: Any, obstacles: Any, how: type) -> None: ...
    def takes_anything(own: Any, obstacles: Any, **more: float) -> None: ...

    with pytest.raises(options.OptionsError, match="the type of 'how' cannot be written in a YAML"):
        options.model_of(takes_a_function, 2)
    with pytest.raises(options.OptionsError, match="name each one"):
        options.model_of(takes_anything, 2)


def test_an_option_without_default_is_needed() -> None:
    def needs(own: Any, obstacles: Any, range_m: float) -> None: ...

    model = options.model_of(needs, 2)
    assert model.model_fields["range_m"].default is PydanticUndefined
    assert get_origin(model.model_fields["range_m"].annotation) is None
    assert not get_args(model.model_fields["range_m"].annotation)
