"""Bounds of every number, and settings that are right one by one and impossible together: told at their place, with the reason."""

from collections.abc import Callable
from pathlib import Path
from time import process_time

import pytest

from testbed.campaign import SpecError, expand, load_campaign
from testbed.campaign.reading import findings
from testbed.campaign.reading.blocks import blocks_of
from testbed.campaign.reading.expand import sizes
from testbed.campaign.reading.nodes import MAX_MARKS, Tree
from testbed.campaign.reading.problems import MOST_SHOWN

Complaint = Callable[..., str]
Write = Callable[[str], str]

ENERGY = "check: {kind: energy, verifies: a, truth: b, tolerance: c, "

BEYOND = [
    ("radius_m: 25", "radius_m: 1e300", "must be at most 200000 m, not 1e+300 m: the ground is taken to be flat"),
    ("radius_m: 25", "radius_m: 1e-300", "must be at least 0.01 m, not 1e-300 m: less is a point, not a sphere"),
    ("[254, 63.6, 60.7]", "[254, -3e7, 60.7]", "position_enu_m[1]: must be at least -200000 m"),
    ("[254, 63.6, 60.7]", "[254, 0, 3e7]", "position_enu_m[2]: must be at most 100000 m, not 30000000.0 m: there is no air to fly in"),
    ("{time_s: 3}", "{time_s: 1e12}", "when.time_s: must be at most 86400 s"),
    ("    speed_mps: 40", "    speed_mps: 4e4", "obstacles.O.speed_mps: must be at most 3000 m/s"),
    ("[106, 12.4]", "[1e9, 12.4]", "direction_deg[0]: must be at most 3600 deg, not 1000000000.0 deg: that is ten turns"),
    ("speed_mps: 50", "speed_mps: 1e-6", "speed_mps: must be at least 1 m/s, not 1e-06 m/s: nothing that flies is slower"),
    ("method:", "terrain_z_m: 1e15\nmethod:", "terrain_z_m: must be at most 100000 m"),
    ("method:", "replan: {magnitude_chords: 1e-300}\nmethod:", "magnitude_chords: must be at least 0.01"),
    ("method:", "replan: {swell_m: 1e30, k: 1e9}\nmethod:", "replan.k: must be at most 1000, not 1000000000.0"),
    ("method:", "sensor: {range_m: 1e8}\nmethod:", "sensor.range_m: must be at most 200000 m"),
    ("name: demo", f"name: demo\n{ENERGY}height_tolerance_m: 1e300}}", "check.height_tolerance_m: must be at most 1e+09 m, not 1e+300 m"),
    ("name: demo", f"name: demo\n{ENERGY}height_tolerance_m: 1e-300}}", "must be at least 1e-12 m, not 1e-300 m: rounding alone is more"),
    ("method:", "limits: {flight_s: 1e9}\nmethod:", "limits.flight_s: must be at most 86400 s"),
    ("method:", "limits: {log_mb: 1}\nmethod:", "limits.log_mb: must be at least 10, not 1: that holds no flight"),
    ("  goal_enu_m: [500, 200, 100]", "  goal_enu_m: [1e-9, 0, 0]", "start_enu_m and goal_enu_m are 1e-09 m apart; at least 1 m"),
    (
        "air: {wind: {kind: steady, speed_mps: 5, from_deg: 270}}",
        "air: {wind: {kind: power_law, speed_mps: 5, from_deg: 270, reference_height_m: 1e9}}",
        "reference_height_m: must be at most 100000 m",
    ),
]


@pytest.mark.parametrize(("old", "new", "words"), BEYOND)
def test_a_number_out_of_all_proportion_is_told_with_the_reason(good: str, complaint: Complaint, old: str, new: str, words: str) -> None:
    assert old in good
    assert words in complaint(good.replace(old, new, 1))


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        ("{kind: racetrack, straight_m: 900, radius_m: 500, laps: 200}", "the course is 988 km long; at most 200 km"),
        ("{kind: racetrack, straight_m: 90000, radius_m: 1}", "the course has 60,024 pieces; at most 10,000"),
        ("{kind: circle, radius_m: 9000, turns: 90}", "the course is 5,089 km long"),
        ("{kind: swerve, swing_m: 100, swings: 900}", "the course is 90 km long; at most 50 km"),
        ("{kind: swerve, heading_deg: 50, swing_m: 2, swings: 1000}", "pieces; at most 10,000"),
        ("{kind: random, least_radius_m: [300, 200], climb_at_most_deg: 5}", "the first is more than the second"),
        ("{kind: random, least_radius_m: [300, 1e7], climb_at_most_deg: 5}", "must be at most 5000 m"),
    ],
)
def test_the_product_of_what_a_course_is_made_of_is_bounded(good: str, complaint: Complaint, shape: str, words: str) -> None:
    before, _, after = good.partition("  goal_enu_m")
    text = f"{before}  shape: {shape}\n  start_direction_deg: [0, 0]\nobstacles:{after.partition('obstacles:')[2]}"
    assert words in complaint(text)


TOGETHER = [
    (
        {"    radius_m: 25": "    radius_m: 130"},
        "13:15: obstacles.O.radius_m: 'O' can never be seen before it is entered: radius_m 130, sensor.range_m 100",
    ),
    (
        {"speed_mps: 5,": "speed_mps: 39,", "from_deg: 270": "from_deg: 65", "slow: {speed_mps: 40}": "slow: {speed_mps: 38}"},
        "air.wind.speed_mps: the wind of 39 m/s is too strong for an airspeed of 38 m/s",
    ),
    ({"method: {": "terrain_z_m: 0\nmethod: {"}, "7:16: route.start_enu_m: the flight begins on the ground: terrain_z_m is 0"),
    ({"method: {": "terrain_z_m: 7\nmethod: {"}, "route.start_enu_m: the flight begins 7 m under the ground: terrain_z_m is 7"),
    (
        {"speed_mps: 50": "speed_mps: 50\nbegin: {at_route_s_m: 600}"},
        "begin.at_route_s_m: 600 m is past the end of the route, which is 557.9 m long",
    ),
    ({"goal_enu_m: [500, 200, 100]": "goal_enu_m: [190000, 200, 100]"}, "a flight may take 1,998 s"),
    ({"speed_mps: 50": "speed_mps: 50\nlimits: {flight_s: 5}"}, "a flight may take 5 s"),
]


@pytest.mark.parametrize(("changes", "words"), TOGETHER)
def test_what_is_impossible_together_is_told(good: str, complaint: Complaint, changes: dict[str, str], words: str) -> None:
    for old, new in changes.items():
        assert old in good
        good = good.replace(old, new, 1)
    said = complaint(good)
    assert words in said
    assert "(in the cell" in said, "which of the sweep it is"


def test_a_sphere_that_no_planner_looks_for_may_be_as_large_as_it_likes(good: str, write: Write) -> None:
    alone = good.replace("radius_m: 25", "radius_m: 130").replace("[none, scoam]", "[none]").replace("kind: scoam", "kind: none")
    assert load_campaign(write(alone))


@pytest.mark.parametrize(("plant", "told"), [("jsbsim", True), ("point_mass", True), ("kinematic", False)])
def test_a_goal_behind_is_told_where_the_aircraft_cannot_turn_to_it(good: str, write: Write, plant: str, told: bool) -> None:
    behind = good.partition("sweep:")[0].replace("goal_enu_m: [500, 200, 100]", "goal_enu_m: [-400, -300, 100]")
    behind = behind.replace("kind: kinematic", f"kind: {plant}")
    if not told:
        assert load_campaign(write(behind))
        return
    with pytest.raises(SpecError, match=r"8:15: route\.goal_enu_m: lies behind the start: the path to it has a bend of \d+ m radius"):
        load_campaign(write(behind))


def test_an_airspeed_that_the_wind_takes_away_is_told(good: str, complaint: Complaint) -> None:
    text = good.replace("speed_mps: 50", "speed_mps: 50\nspeed_hold: groundspeed").replace(
        "speed_mps: 5, from_deg: 270", "speed_mps: 30, from_deg: 230"
    )
    assert "through the air at the start; gtm_t2 holds" in complaint(text.replace("kind: kinematic", "kind: jsbsim"))


# ---- in bounded time and at a readable length


def test_a_list_of_problems_is_cut_at_a_readable_length(good: str, complaint: Complaint) -> None:
    said = complaint(good + "".join(f"key{k}: 1\n" for k in range(MOST_SHOWN + 7)))
    assert said.count("unknown key") == MOST_SHOWN
    assert said.endswith("\nand 7 more")
    assert "more" not in complaint(good + "".join(f"qqq{k}: 1\n" for k in range(MOST_SHOWN))).splitlines()[-1]


def in_time(text: str, write: Write, seconds: float = 5.0) -> str:
    """The complaint about a text, or an empty one; processor seconds, so that a busy computer counts no other work."""
    began, said = process_time(), ""
    try:
        load_campaign(write(text))
    except SpecError as error:
        said = str(error)
    assert process_time() - began < seconds
    return said


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("x: [" + "[]," * 90_000 + "]\n", f"more than {MAX_MARKS:,} lines, commas, colons and brackets"),
        ("x: " + "[" * 15_000 + "]" * 15_000 + "\n", "nested too deeply"),
        ("".join(f"keyy{k}: 1\n" for k in range(15_000)), "and 480 more"),
        ("replicates: 100000\n", ""),
    ],
)
def test_a_file_that_is_hard_to_read_is_refused_in_time(good: str, write: Write, what: str, words: str) -> None:
    base = good.partition("sweep:")[0].replace("replicates: 2\n", "")
    said = in_time(base + what, write)
    assert words in said
    assert bool(said) == bool(words)


@pytest.mark.slow
def test_more_values_than_can_be_tried_are_refused_at_once(good: str, write: Write) -> None:
    base = good.partition("sweep:")[0]
    axis = f"sweep:\n  replan.swell_m: [{', '.join(str(k / 1000) for k in range(9000))}]\n"
    assert "sweep: has 9,002 values, each of which is tried with all the settings" in in_time(base + axis, write)


def test_a_large_grid_is_sampled_and_a_fault_of_one_value_found(good: str, write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    """160,000 cells: every value of every axis is tried, and cells that meet in any two."""
    monkeypatch.setattr(findings, "CELLS_TRIED", 600)
    base = good.partition("sweep:")[0]
    axes = {"speed_mps": range(40, 60), "sensor.range_m": range(100, 120), "replan.swell_m": range(20), "replan.horizon_s": range(5, 25)}
    sweep = "sweep:\n" + "".join(f"  {path}: {list(values)}\n" for path, values in axes.items())
    assert in_time(base + sweep, write, 5.0) == ""
    bad = in_time(base.replace("radius_m: 25", "radius_m: 119") + sweep, write, 5.0)
    assert "can never be seen before it is entered" in bad


def test_cells_are_counted_without_making_them(parted: str, good: str, write: Write) -> None:
    for text in (good, parted):
        campaign = load_campaign(write(text))
        plans = expand(campaign)
        counted = sizes(campaign)
        assert sum(flights for _, flights in counted.values()) == len(plans)
        assert sum(cells for cells, _ in counted.values()) == len({plan.cell for plan in plans})


def test_a_sample_of_cells_never_has_one_that_is_skipped() -> None:
    sweep = {"a": {f"l{k}": {} for k in range(7)}, "b": {f"m{k}": {} for k in range(11)}}
    (block,), problems = blocks_of(Tree.plain({"sweep": sweep, "skip": [{"a": "l3"}, {"b": ["m1", "m2"], "a": "l0"}]}))
    assert not problems
    every, some = list(block.cells()), list(block.some_cells(40))
    assert block.left() == len(every) == 7 * 11 - 11 - 2
    assert set(map(block.cell_id, some)) <= set(map(block.cell_id, every))
    assert {level.label for cell in some for level in cell} == {level.label for cell in every for level in cell}
    assert list(map(block.cell_id, block.some_cells(77))) == list(map(block.cell_id, every))


# ---- limits


def test_limits_are_checked_before_anything_is_made(good: str, complaint: Complaint) -> None:
    said = complaint(good.replace("replicates: 2", "replicates: 3\nlimits: {flights: 11}"))
    assert "22:1: sweep: makes 12 flights; at most 11" in said or "makes 12 flights; at most 11" in said
    assert "limits.flights sets that" in said


def test_limits_of_the_campaign_are_no_axis(good: str, complaint: Complaint) -> None:
    assert "belongs to the campaign as a whole" in complaint(good.replace("  method.kind:", "  limits.flights:"))
    assert "belongs to the campaign as a whole" in complaint(good.replace("  method.kind:", "  limits.wall_limit_s:"))


def test_limits_that_change_nothing_that_is_flown_leave_the_flight_what_it_is(good: str, write: Write) -> None:
    def ids(more: str) -> list[str]:
        return [plan.flight_id for plan in expand(load_campaign(write(good + more)))]

    plain = ids("")
    assert ids("limits: {wall_limit_s: 20, flights: 50}\n") == plain
    assert not set(ids("limits: {flight_s: 20}\n")) & set(plain)


def test_the_schema_tells_the_bounds(good: str) -> None:
    schema = (Path(__file__).resolve().parents[2] / "campaigns" / "campaign.schema.json").read_text()
    assert '"maximum": 200000.0' in schema
    assert "limits.flight_s" in schema
