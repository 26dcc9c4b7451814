"""A flight is paired with the point that differs from it in who flew alone, or with none."""

import math
from typing import Any

from testbed.campaign.words.settings import Campaign
from testbed.show import campaign_summary
from testbed.show.gathered import Gathered, gather
from testbed.show.page import render_page
from testbed.show.pairs import Alike, pairs

Row = dict[str, Any]

PARTS = {
    "margins": {"sweep": {"plant.kind": ["kinematic", "point_mass"], "replan.k": [1.0, 2.0]}},
    "radii": {"set": {"plant.kind": "point_mass"}, "sweep": {"obstacles.O.radius_m": [15, 20]}},
    "level": {
        "replicates": 2,
        "set": {"air.wind": {"kind": "steady", "speed_mps": 8, "from_deg": 240}},
        "sweep": {
            "flown_by": {
                "rails": {"plant.kind": "kinematic"},
                "jet": {"plant": {"kind": "jsbsim"}, "begin": {"climb_at_most_deg": 18}},
                "level_rails": {"plant.kind": "kinematic", "geometry": "level"},
                "propeller": {"plant.kind": "jsbsim", "aircraft": "c172p", "geometry": "level"},
                "hasty": {"plant.kind": "jsbsim", "replan": {"answer": "direct"}},
            }
        },
    },
}


def campaign(**settings: object) -> Campaign:
    route = {"start_enu_m": [0, 0, 0], "goal_enu_m": [388.8, 306.0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [76.3, 0]}
    return Campaign.model_validate({"name": "pairs", "question": "Who has a partner?", "route": route, **settings})


def row(plant: str, labels: dict[str, str], replicate: int = 0, clearance: float = 1.0, aircraft: str = "gtm_t2") -> Row:
    cell = "/".join(labels.values())
    who = {"flight_id": f"{cell}:{replicate}", "cell": cell, "labels": labels, "replicate": replicate, "seed": 0}
    flew = {"plant": plant, "aircraft": aircraft, "method": "scoam", "outcome": "reached", "least_clearance_m": clearance}
    return who | flew | {"events": [], "message": "", "recording": None, "replans": 1}


def gathered(rows: list[Row], of: Campaign) -> Gathered:
    alike = Alike(of)
    return gather(one | alike(one) for one in rows)


def test_only_who_flew_may_differ_and_the_rest_is_counted() -> None:
    """None of these has curves, as most flights of a large campaign have none."""
    rows = [row(plant, {"part": "margins", "plant.kind": plant, "replan.k": k}) for plant in ("kinematic", "point_mass") for k in "12"]
    rows += [row("point_mass", {"part": "radii", "obstacles.O.radius_m": radius}) for radius in ("15", "20")]
    for flyer, plant in (
        ("rails", "kinematic"),
        ("jet", "jsbsim"),
        ("level_rails", "kinematic"),
        ("propeller", "jsbsim"),
        ("hasty", "jsbsim"),
    ):
        rows += [row(plant, {"part": "level", "flown_by": flyer}, replicate) for replicate in (0, 1)]
    matched, unmatched = pairs(gathered(rows, campaign(parts=PARTS)))
    assert {(pair.kinematic["flight_id"], pair.flown["flight_id"]) for pair in matched} == {
        ("margins/kinematic/1:0", "margins/point_mass/1:0"),
        ("margins/kinematic/2:0", "margins/point_mass/2:0"),
        ("level/rails:0", "level/jet:0"),
        ("level/rails:1", "level/jet:1"),
        ("level/level_rails:0", "level/propeller:0"),
        ("level/level_rails:1", "level/propeller:1"),
    }
    assert unmatched == 4  # two of other radii, and two that fly the direction at once
    page = render_page(campaign(parts=PARTS), rows, {}, {})
    section = page[page.index('<section id="pairs">') :].split("</section>", 1)[0]
    assert "4 flights have no point to compare with." in section
    for told in (">margins, k 2, in calm air<", ">level, no. 1, in wind 8 m/s from 240 deg<"):
        assert told in section


def test_the_air_of_a_flight_is_told_where_its_labels_tell_it() -> None:
    wind = {"air": {"wind": {"kind": "steady", "speed_mps": 5, "from_deg": 90}}}
    swept = row("jsbsim", {"air.wind.speed_mps": "7.5"})
    assert Alike(campaign(**wind, sweep={"air.wind.speed_mps": [5, 7.5]}))(swept)["air"] == "in wind 7.5 m/s from 90 deg"
    assert Alike(campaign(**wind, draw={"air.wind.from_deg": {"within": 30}}))(swept)["air"] == ""
    assert Alike(campaign(sweep={"air.wind": [{"kind": "calm"}]}))(row("jsbsim", {"air.wind": "{kind: calm}"}))["air"] == ""


def test_without_an_obstacle_there_is_no_verdict_on_its_clearance() -> None:
    rows = [row(plant, {"plant.kind": plant}, clearance=math.nan) for plant in ("kinematic", "point_mass")]
    page = render_page(campaign(sweep={"plant.kind": ["kinematic", "point_mass"]}), rows, {}, {})
    section = page[page.index('<section id="pairs">') :].split("</section>", 1)[0]
    assert "gtm_t2 as a point mass" in section
    assert not any(word in section for word in ("clearance", "not determined", "badge"))


def test_the_tiles_say_of_whom_they_are() -> None:
    rows = [row("kinematic", {"plant.kind": "kinematic"}, clearance=-9.0), row("point_mass", {"plant.kind": "point_mass"}, clearance=-1.0)]
    tiles = {tile["name"]: tile for tile in campaign_summary.cards(gather(rows))}
    assert tiles["collisions"]["number"] == "2 / 2"
    assert tiles["collisions"]["note"].startswith("points and aircraft ")
    least = tiles["least clearance"]
    assert (least["number"].split()[0], least["note"].split(":")[0]) == ("\N{MINUS SIGN}1.00", "of flights by an aircraft")
    for alone in rows:
        assert not any("of flights by" in tile["note"] for tile in campaign_summary.cards(gather([alone])))
