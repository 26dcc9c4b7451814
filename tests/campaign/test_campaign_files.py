"""The campaigns that come with the project load, and fly what their comments say."""

import itertools
import json
import re
from pathlib import Path

import pytest

from testbed.campaign import FlightPlan, expand, load_campaign, schema

CAMPAIGNS = Path(__file__).resolve().parents[2] / "campaigns"


def plans_of(name: str) -> dict[str, FlightPlan]:
    plans = expand(load_campaign(CAMPAIGNS / f"{name}.yaml"))
    return {plan.cell: plan for plan in plans}


@pytest.mark.slow
@pytest.mark.parametrize("file", sorted(CAMPAIGNS.rglob("*.yaml")), ids=lambda file: file.stem)
def test_every_campaign_loads_and_an_editor_knows_its_schema(file: Path) -> None:
    campaign = load_campaign(file)
    assert expand(campaign)
    up = "../" * (len(file.relative_to(CAMPAIGNS).parts) - 1)
    assert file.read_text().startswith(f"# yaml-language-server: $schema={up}campaign.schema.json\n")
    assert (campaign.check is not None) == (file.parent.name == "check")


def test_paper_single_is_readings_by_methods_by_aircraft_in_this_order() -> None:
    plans = plans_of("paper_single")
    axes = (("as_printed", "azimuth_106", "direction_106_10"), ("none", "scoam"), ("kinematic", "gtm_t2", "kinematic_level", "c172p_level"))
    assert list(plans) == ["/".join(labels) for labels in itertools.product(*axes)]
    printed, repaired = plans["as_printed/none/kinematic"], plans["direction_106_10/scoam/gtm_t2"]
    assert printed.obstacles[0].direction_deg == (135, 12.4)
    assert (printed.method.kind, printed.plant.kind, printed.geometry, printed.begin.at_route_s_m) == ("none", "kinematic", "as_given", 0)
    assert repaired.obstacles[0].direction_deg == (106.1, 10.4)
    assert (repaired.method.kind, repaired.plant.kind, repaired.aircraft) == ("scoam", "jsbsim", "gtm_t2")
    assert (repaired.begin.climb_at_most_deg, repaired.begin.at_route_s_m) == (18, None)
    level = plans["azimuth_106/scoam/c172p_level"]
    assert (level.geometry, level.plant.kind, level.aircraft) == ("level", "jsbsim", "c172p")
    assert plans["azimuth_106/scoam/kinematic_level"].plant.kind == "kinematic"
    # What the cells do not vary is the encounter of the paper.
    for plan in plans.values():
        (obstacle,) = plan.obstacles
        assert (plan.speed_mps, obstacle.radius_m, obstacle.speed_mps, plan.sensor.range_m) == (50, 25, 40, 100)
        assert (obstacle.position_enu_m, obstacle.when.own_reaches_enu_m) == ((254, 63.6, 60.7), (162, 101, 64.3))
        assert (plan.replan.k, plan.replan.time_rule, plan.seed, plan.replicate) == (1.25, "arrival", 20210, 0)


def test_no_obstacle_is_the_same_route_with_nothing_in_the_way() -> None:
    plans = plans_of("no_obstacle")
    assert list(plans) == ["kinematic", "gtm_t2", "c172p_level"]
    route = plans_of("paper_single")["as_printed/none/kinematic"].route
    assert all(plan.route == route and not plan.obstacles and plan.method.kind == "none" for plan in plans.values())
    assert plans["gtm_t2"].begin.climb_at_most_deg == 18


def test_smoke_has_four_flights() -> None:
    assert list(plans_of("smoke")) == ["kinematic/none", "kinematic/scoam", "jsbsim/none", "jsbsim/scoam"]


def test_the_example_in_contributing_is_a_campaign(tmp_path: Path) -> None:
    (example,) = re.findall(r"^```yaml\n(parts:.*?)^```", (CAMPAIGNS.parent / "CONTRIBUTING.md").read_text(), re.M | re.S)
    file = tmp_path / "example.yaml"
    file.write_text((CAMPAIGNS / "paper_single.yaml").read_text().partition("sweep:")[0] + example)
    cells = [plan.cell for plan in expand(load_campaign(file))]
    assert {cell: cells.count(cell) for cell in cells} == {
        "calm/none/ground_fixed": 1,
        "calm/scoam/ground_fixed": 1,
        "calm/scoam/anchored": 1,
        "robust": 50,
        "population/none": 100,
        "population/scoam": 100,
    }


def test_the_committed_schema_is_the_text_of_schema() -> None:
    """If not: ``testbed schema > campaigns/campaign.schema.json``."""
    assert (CAMPAIGNS / "campaign.schema.json").read_text() == schema()


def test_the_schema_describes_every_key_with_its_unit() -> None:
    document = json.loads(schema())
    sections = {"Campaign": document, **document["$defs"]}
    units = {"_mps": "m/s", "_deg": "deg", "_hz": "Hz", "_m": "m", "_s": "s"}
    described = 0
    for name, section in sections.items():
        for key, value in section.get("properties", {}).items() if name not in ("Settings", "NamedAxis") else ():
            if key == "kind" or "allOf" in value:  # the section that it refers to has a description
                continue
            unit = next((unit for suffix, unit in units.items() if key.endswith(suffix)), "")
            words = value["description"].replace(".", " ").replace(",", " ").replace(";", " ").split()
            assert not unit or unit in words, f"{name}.{key}: {value['description']}"
            described += 1
    assert described > 30
    assert all(section["description"] for section in sections.values())


def test_the_schema_knows_the_paths_of_a_sweep() -> None:
    document = json.loads(schema())
    axes = document["properties"]["sweep"]["properties"]
    assert set(document["properties"]["draw"]["properties"]) == set(axes) == set(document["$defs"]["Settings"]["properties"])
    assert {"method.kind", "begin", "begin.climb_at_most_deg", "air.wind.speed_mps", "rates.plant_hz"} <= set(axes)
    assert axes["plant.kind"]["anyOf"][0]["items"]["anyOf"][0]["enum"] == ["kinematic", "point_mass", "jsbsim"]
    assert [kind["const"] for kind in axes["air.wind.kind"]["anyOf"][0]["items"]["anyOf"]] == ["calm", "steady", "power_law", "logarithmic"]
    assert not {"seed", "replicates", "name", "sweep"} & set(axes)
