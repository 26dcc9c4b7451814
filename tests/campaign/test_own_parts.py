"""Sections that name a planner, a sensor, a track or a steering law: what they say, what they refuse, and flights that do without."""

from pathlib import Path

import pytest

from testbed.campaign import SpecError, expand, load_campaign
from testbed.campaign.reading.expand import flight_id
from testbed.core import registry
from tests.plans import paper_obstacle, plan

HEAD = """name: own
question: What is refused?
plugins: [./mine.py]
route: {start_enu_m: [0, 0, 0], goal_enu_m: [900, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
"""
OBSTACLE = "radius_m: 25, position_enu_m: [420, 6, 4], speed_mps: 20, direction_deg: [180, 0]"
MINE = """
class Law:
    def __init__(self, gain: float = 1.0):
        if gain <= 0.0:
            raise ValueError(f"gain: give a number above 0, got {gain}")
    def start(self, context): ...
    def steer(self, memory, time_s, own, seen): ...

class Idle:
    def __init__(self, looks: int = 3): ...
    def start(self, context): ...

class Waits(Idle):
    def step(self, memory, time_s, state, seen): ...

class Track:
    def __init__(self, setting, rate_dps: float = 6.0): ...
    def at(self, time_s): ...
    def sampled(self, time_s): ...

class Veer:
    def __init__(self, setting, gain: float = 1.0): ...
    def start(self, s_m): ...

class Fixed:
    def __init__(self, setting): ...
    def at(self, time_s): ...

def made(looks: int):
    return Idle(looks)

def tangent(own, obstacles, side: bool = True):
    return own.vel_mps

def leaving(own, obstacles, goal: tuple[float, float, float] | None = None):
    raise SystemExit(3)
"""


def told(tmp_path: Path, more: str) -> str:
    (tmp_path / "mine.py").write_text(MINE)
    (tmp_path / "own.yaml").write_text(HEAD + more)
    with pytest.raises(SpecError) as refused:
        expand(load_campaign(tmp_path / "own.yaml"))
    return str(refused.value)


@pytest.mark.parametrize(
    ("more", "place", "words"),
    [
        ('method: {kind: "mine:Law", options: {gain: -1.0}}', "5:44", "give a number above 0, got -1.0"),
        ('method: {kind: "mine:Law", options: {own: 1}}', "5:38", "unknown option 'own'"),
        ('method: {kind: "mine:Idle"}', "5:1", "a steering law needs start and steer; Idle has no steer"),
        ('method: {kind: "mine:tangent", options: {side: true}}', "5:", "must return Choice"),
        ('method: {kind: "mine:leaving"}', "5:1", "the method 'mine:leaving' fails when it is tried: SystemExit: 3"),
        ('method: {kind: "mine:leaving", options: {goal: [1, 2]}}', "5:", "goal: must have 3 values, not 2"),
        ('method: {kind: "mine:leaving", options: {goal: [1]}}', "5:", "goal: must have 3 values, not 1"),
        ('method: {kind: "mine:leaving", options: {goal: [1, 2, 3, 4]}}', "5:", "goal: must have 3 values, not 4"),
        ('planner: {kind: "mine:Idle"}', "5:1", "a planner needs start and step; Idle has no step"),
        ('planner: {kind: "mine:Waits", options: {looks: 2.5}}', "5:", "whole number"),
        ("planner: {kind: replan, options: {k: 2}}", "5:", "unknown option 'k'"),
        ("planner: {kind: replane}", "5:", "no planner 'replane'"),
        ('sensor: {kind: "mine:Idle"}', "5:1", "a sensor needs start and sense; Idle has no sense"),
        ('guidance: {kind: "mine:Veer"}', "5:1", "a guidance law needs start and step; Veer has no step"),
        ('method: {kind: "mine:Veer"}', "5:1", "a steering law needs start and steer; Veer has no steer"),
        ('planner: {kind: "mine:Veer"}', "5:1", "a planner needs start and step; Veer has no step"),
        ('guidance: {kind: "mine:tangent"}', "5:1", "wants obstacles; a guidance law is a class with start and step"),
        (
            'planner: {kind: "mine:tangent"}',
            "5:1",
            "this is a function that wants own, obstacles; a planner is a class with start and step",
        ),
        ('sensor: {kind: "mine:tangent"}', "5:1", "this is a function that wants own, obstacles; a sensor is a class with start and sense"),
        ('planner: {kind: "mine:made", options: {looks: 3}}', "5:", "a planner needs start and step; Idle has no step"),
        ('obstacles: [{name: O, kind: "mine:Fixed", ' + OBSTACLE + "}]", "5:", "a track needs at and sampled; Fixed has no sampled"),
        ('obstacles: [{name: O, kind: "mine:Track", options: {rate: 1}, ' + OBSTACLE + "}]", "5:53", "it has: rate_dps"),
        ("obstacles: [{name: O, kind: curved, " + OBSTACLE + "}]", "5:", "no traffic 'curved'"),
    ],
)
def test_what_cannot_be_used_is_told_at_its_place(tmp_path: Path, more: str, place: str, words: str) -> None:
    message = told(tmp_path, more)
    assert f"own.yaml:{place}" in message
    assert words in message
    assert "Traceback" not in message


def test_a_class_is_given_nothing_and_a_function_the_encounter() -> None:
    class Law: ...

    def avoid(): ...

    assert (registry.given("method", Law), registry.given("method", avoid)) == (0, 2)
    assert registry.given("plant", Law) == registry.given("plant", avoid) == 1


def test_a_flight_that_does_without_is_the_one_it_was() -> None:
    """To say the default is to say nothing; another planner, another track or an option of it is another flight."""
    plain = plan(obstacles=[paper_obstacle()])
    said = plan(obstacles=[paper_obstacle(kind="straight", options={})], planner={"kind": "replan", "options": {}})
    assert flight_id(said) == flight_id(plain) == "e34d472f8681"
    turning = plain.obstacles[0].model_copy(update={"kind": "turning:Turning"})
    faster = turning.model_copy(update={"options": {"rate_dps": 3.0}})
    others = [plain.model_copy(update={"obstacles": (one,)}) for one in (turning, faster)]
    others.append(plain.model_copy(update={"planner": plain.planner.model_copy(update={"kind": "holder:Planner"})}))
    assert len({flight_id(other) for other in (plain, *others)}) == 4


def test_a_track_is_among_the_parts_that_say_who_a_flight_is() -> None:
    plain = plan(obstacles=[paper_obstacle()])
    assert [(section.family, section.kind) for section in plain.plugged if section.family in ("traffic", "planner")] == [
        ("planner", "replan"),
        ("traffic", "straight"),
    ]


RAISES = {  # what a function of somebody's own may do when it is tried, and what is said of it
    'raise ValueError("bad \\ud800 text")': r"bad \ud800 text",
    'raise ValueError("x" * 1_000_000)': "characters more",
    "raise Odd()": "Odd: its text cannot be read (RuntimeError)",
    "raise Number()": "Number: its text cannot be read (TypeError)",
    'raise Base("mine")': "Base: mine",
    "raise GeneratorExit": "GeneratorExit",
    "raise SystemExit(3)": "SystemExit: 3",
}
ODD = """
class Odd(Exception):
    def __str__(self): raise RuntimeError("str of me")
class Number(Exception):
    def __str__(self): return 5
class Base(BaseException): ...
def avoid(own, obstacles):
"""


@pytest.mark.parametrize(("does", "said"), RAISES.items(), ids=list(RAISES))
def test_whatever_a_part_raises_when_it_is_tried_is_a_sentence(tmp_path: Path, does: str, said: str) -> None:
    (tmp_path / "mine.py").write_text(f"{ODD}    {does}\n")
    (tmp_path / "own.yaml").write_text(f'{HEAD}method: {{kind: "mine:avoid"}}\n')
    with pytest.raises(SpecError) as refused:
        load_campaign(tmp_path / "own.yaml")
    assert said in str(refused.value)
    assert len(str(refused.value)) < 5_000
    str(refused.value).encode()
