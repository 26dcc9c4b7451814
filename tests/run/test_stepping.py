"""``testbed.make_env``: the flight is that of ``fly``, to the last bit, and the environment is one as gymnasium has them."""

import dataclasses
import re
import sys
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import testbed.run
from testbed import expand, fly, load_campaign, make_env, measure
from testbed.campaign.words.settings import Campaign
from testbed.flight.laws.proportional_navigation import ProportionalNavigation
from testbed.flight.planning.steering import FROM_OUTSIDE
from testbed.flight.record import Decision, FlightRecord, Outcome
from testbed.results.columns import COLUMNS
from testbed.run.observation import OBSTACLE, SHOWN
from tests.plans import PAPER_ROUTE, paper_obstacle

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "stepping.md").read_text()
PLANTS = ("kinematic", "point_mass", "jsbsim")
STRAIGHT = {"start_enu_m": [0, 0, 0], "goal_enu_m": [300, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}


def campaign(**changes: Any) -> Campaign:
    """The paper's encounter on rails, without a sweep."""
    settings = {"route": PAPER_ROUTE, "obstacles": [paper_obstacle("azimuth_106")], "plant": {"kind": "kinematic"}}
    return Campaign.model_validate({"name": "stepped", "question": "?", **settings, **changes})


def straight(**changes: Any) -> Campaign:
    """300 m straight ahead with nothing in the way."""
    return campaign(**{"route": STRAIGHT, "obstacles": [], **changes})


def differing(one: FlightRecord, other: FlightRecord) -> list[str]:
    assert one.columns.keys() == other.columns.keys()
    return [name for name, column in one.columns.items() if not np.array_equal(column, other.columns[name], equal_nan=True)]


def flown_on(env: Any, command: Any) -> tuple[Any, ...]:
    """The last step of a flight that is given one command all the time."""
    while True:
        step = env.step(command)
        if step[2] or step[3]:
            return tuple(step)


def flown_on_all(both: Any, commands: Any) -> tuple[Any, ...]:
    """The step with which the first of several ends."""
    while True:
        step = both.step(commands)
        if step[2].any() or step[3].any():
            return tuple(step)


@pytest.mark.parametrize("plant", PLANTS)
def test_the_commands_that_a_law_gave_in_a_flight_fly_it_again_to_the_last_bit(plant: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a wind with gusts, and with an obstacle that is drawn: replicate 1 of the campaign is what the seed 1 begins."""
    asked = campaign(
        aircraft="gtm_t2",
        begin={"climb_at_most_deg": 18},
        method={"kind": "proportional_navigation"},
        replicates=2,
        draw={"obstacles.O.direction_deg": {"within": [0.5, 0.05]}},
        air={"wind": {"kind": "steady", "speed_mps": 5, "from_deg": 240}, "turbulence": {"kind": "dryden", "severity": "light"}},
        sweep={"plant.kind": list(PLANTS)},
    )
    real, said = ProportionalNavigation.steer, []

    def noted(self: Any, *told: Any) -> Any:
        memory, answer = real(self, *told)
        said.append(np.array(answer.acceleration_enu_mps2))
        return memory, answer

    monkeypatch.setattr(ProportionalNavigation, "steer", noted)
    (plan,) = [plan for plan in expand(asked) if plan.labels["plant.kind"] == plant and plan.replicate == 1]
    truth = fly(plan)
    commands = tuple(said)
    assert len(commands) > 50

    env = make_env(asked, cell=plant)
    shown, told = env.reset(seed=1)
    assert told == {"flight_id": plan.flight_id, "cell": plant, "replicate": 1}
    for command in commands[:-1]:
        assert shown in env.observation_space
        shown, reward, terminated, truncated, info = env.step(command)
        assert (reward, terminated, truncated, info) == (0.0, False, False, {})
    shown, reward, terminated, truncated, info = env.step(commands[-1])
    assert len(said) == len(commands), "the law itself is not asked"
    assert env.record is not None
    assert differing(truth, env.record) == []
    assert [event.time_s for event in env.record.events] == [event.time_s for event in truth.events]
    assert [event.decision for event in env.record.events] == [Decision.STEERED, Decision.REJOINED]
    assert (terminated, truncated) == (True, False)
    assert reward == (1.0 if truth.outcome is Outcome.REACHED else -1.0)
    row, metrics = info["row"], dataclasses.asdict(measure(truth))
    assert list(row) == [*(column.name for column in COLUMNS), "label.plant.kind"]
    assert {name: row[name] for name in metrics} == {k: None if isinstance(v, float) and np.isnan(v) else v for k, v in metrics.items()}
    assert (row["method"], row["flight_id"], row["replicate"]) == ("outside", "", 1)
    own = [*shown["own_pos_enu_m"], *shown["own_vel_enu_mps"], *shown["own_airspeed_mps"]]
    last = [truth.columns[f"own.{name}"][-1] for name in ("pos_enu_m", "vel_enu_mps", "airspeed_mps")]
    assert own == np.hstack(last).tolist()


SCRIPTED = """
import math
from testbed.flight.planning import Steer, Step
from testbed.flight.planning.steering import arc

class Scripted:
    slowest_s = 0.0

    def start(self, context):
        return None

    def step(self, memory, time_s, state, seen, path, s_m):
        command = (3.0 * math.sin(time_s), 12.0, 2.0 * math.cos(time_s))
        return Step(None, arc(Steer(command), state, s_m))
"""


@pytest.mark.parametrize("plant", PLANTS)
def test_always_asked_it_is_the_flight_of_a_planner_that_gives_the_same_commands(plant: str, tmp_path: Path) -> None:
    """Both miss the goal and fly on until their time is up, with the planner at half the guidance's rate."""
    (tmp_path / "scripted.py").write_text(SCRIPTED)
    text = f"""
name: scripted
question: '?'
route: {{start_enu_m: [0, 0, 0], goal_enu_m: [150, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}}
plant: {{kind: {plant}}}
rates: {{plant_hz: 120, guidance_hz: 60, planner_hz: 30}}
limits: {{flight_s: 4}}
"""
    (tmp_path / "own.yaml").write_text(text)
    (tmp_path / "scripted.yaml").write_text(text + "plugins: [./scripted.py]\nplanner: {kind: 'scripted:Scripted'}\n")
    truth = fly(expand(load_campaign(tmp_path / "scripted.yaml"))[0])
    assert truth.outcome is Outcome.TIMED_OUT

    env = make_env(tmp_path / "own.yaml", asks="always")
    shown, _ = env.reset(seed=0)
    ended, steps = False, 0
    while not ended:
        time_s = float(shown["time_s"][0])
        assert time_s == steps / 60
        shown, reward, terminated, ended, _ = env.step([3.0 * np.sin(time_s), 12.0, 2.0 * np.cos(time_s)])
        assert (terminated, reward) == (False, 0.0), "out of time is no end that counts"
        steps += 1
    assert steps == 240
    assert env.record is not None
    assert differing(truth, env.record) == []


def test_a_course_is_flown_round_by_what_is_seen_of_the_route() -> None:
    """Its goal is where it begins: it is reached after a turn. A velocity along the route is all that a point on rails needs."""
    circle = {"start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0], "shape": {"kind": "circle", "radius_m": 60, "turns": 1}}
    env = make_env(straight(route=circle), command="velocity", asks="always")
    shown, _ = env.reset(seed=0)
    length_m, errors, ended = float(shown["route_remaining_m"][0]), [], False
    assert length_m == pytest.approx(2 * np.pi * 60, rel=1e-3)
    while not ended:
        shown, reward, ended, _, info = env.step(shown["route_direction_enu"])
        errors.append(shown["route_error_m"])
    assert (reward, info["row"]["outcome"]) == (1.0, "reached")
    right_m, above_m = -np.array(errors)[:, 0], np.array(errors)[:, 1]
    assert right_m[0] == pytest.approx((50 / 60) ** 2 / 120, rel=0.01), "a tangent, flown for a 60th of a second, is off by this"
    assert right_m[-1] == pytest.approx(len(errors) * right_m[0], rel=0.1), "as much each time, outwards"
    assert len(errors) == pytest.approx(60 / 50 * (length_m + 2 * np.pi * right_m.mean()), abs=2), "once round"
    assert np.abs(above_m).max() < 1e-6


def test_after_laps_it_is_still_known_where_on_the_route_it_is() -> None:
    """Two and a half laps of a circle are flown before the first threat, which stands on the far side and appears late."""
    circle = {"start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0], "shape": {"kind": "circle", "radius_m": 100, "turns": 4}}
    crossing = {"name": "O", "radius_m": 10, "position_enu_m": [0, 200, 0], "speed_mps": 200, "direction_deg": [90, 0]}
    lapped_s = 2.5 * 2 * np.pi * 100 / 50
    asked = campaign(
        route=circle, obstacles=[crossing | {"when": {"time_s": lapped_s}}], sensor={"range_m": 150}, replan={"rejoin": {"to": "route"}}
    )
    shown, _ = make_env(asked).reset(seed=0)
    assert shown["time_s"] == pytest.approx(lapped_s, abs=1.0)
    assert shown["route_remaining_m"] == pytest.approx(4 * 2 * np.pi * 100 - 50 * shown["time_s"], abs=0.5)
    assert np.abs(shown["route_error_m"]).max() < 0.1


@pytest.mark.parametrize("how", [{"asks": "when_threatened"}, {"asks": "always", "command": "velocity"}])
def test_gymnasium_finds_nothing_wrong(how: dict[str, Any]) -> None:
    env = make_env(campaign(), **how)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*recommend using a symmetric and normalized space")  # it has units
        check_env(env, skip_render_check=True)


def test_what_gymnasium_wraps_it_with_works_as_the_page_says() -> None:
    """One vector, actions without units, and two at a time, of which each says how it ended."""

    def made() -> Any:
        plain = make_env(straight(route=STRAIGHT | {"goal_enu_m": [60, 0, 0]}), asks="always")
        return gymnasium.wrappers.RescaleAction(gymnasium.wrappers.FlattenObservation(plain), -1.0, 1.0)

    both = gymnasium.vector.SyncVectorEnv([made, made])
    shown, _ = both.reset(seed=[0, 1])
    assert shown.shape == (2, sum(one.size for one in (*SHOWN, *OBSTACLE)))
    _, rewards, ended, _, info = flown_on_all(both, np.array([[0.0, 0.2, 0.0], [0.0, -0.2, 0.0]]))
    assert (rewards.tolist(), ended.tolist()) == ([1.0, 1.0], [True, True])
    assert info["row"]["outcome"].tolist() == ["reached", "reached"]
    aside_m = 0.2 * 25.0 * (60 / 50) ** 2 / 2  # a fifth of 25 m/s^2 for the 1.2 s that it takes, to either side
    assert info["row"]["cross_track_max_m"].tolist() == pytest.approx([aside_m, aside_m], rel=0.05)
    both.close()


@pytest.mark.parametrize(
    ("kind", "command", "why"),
    [
        ("acceleration", [1.0, np.nan, 0.0], "3 finite numbers below 1e+30 in size (acceleration, ENU, m/s^2)"),
        ("acceleration", [1.0, np.inf, 0.0], "3 finite numbers"),
        ("acceleration", [1.0, 1e300, 0.0], "3 finite numbers"),
        ("acceleration", [1.0, 2.0], "3 finite numbers"),
        ("acceleration", np.zeros((3, 1)), "3 finite numbers"),
        ("acceleration", "left", "3 finite numbers"),
        ("acceleration", None, "3 finite numbers"),
        ("velocity", [0.0, 0.0, 0.0], "no direction to fly in"),
    ],
)
def test_a_command_that_is_none_is_refused_in_a_sentence_and_the_flight_goes_on(kind: Any, command: Any, why: str) -> None:
    env = make_env(straight(), asks="always", command=kind)
    env.reset()
    with pytest.raises(ValueError, match=re.escape(why)) as refused:
        env.step(command)
    assert "\n" not in str(refused.value)
    assert env.step([1.0, 0.0, 0.0])[0]["time_s"] == 1 / 60


def test_a_step_needs_a_flight() -> None:
    env = make_env(straight(route=STRAIGHT | {"goal_enu_m": [60, 0, 0]}), asks="always")
    with pytest.raises(gymnasium.error.ResetNeeded, match="no flight has begun: reset"):
        env.step(np.zeros(3))
    env.reset()
    _, reward, terminated, truncated, info = flown_on(env, np.zeros(3))
    assert (reward, terminated, truncated, info["row"]["outcome"]) == (1.0, True, False, "reached")
    with pytest.raises(gymnasium.error.ResetNeeded, match="the flight is over: reset"):
        env.step(np.zeros(3))
    env.reset()
    env.close()
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(3))
    with pytest.raises(ValueError, match="takes no options"):
        env.reset(options={"wind": 3})


def test_a_flight_in_which_nobody_is_asked_ends_with_its_first_step() -> None:
    """Nothing threatens; or it cannot begin, and there is nothing to see."""
    env = make_env(straight())
    shown, _ = env.reset(seed=7)
    assert shown["own_pos_enu_m"][0] == pytest.approx(300.0, abs=1.0)
    after, reward, terminated, truncated, info = env.step(np.ones(3))
    assert all(np.array_equal(shown[name], after[name]) and shown[name] is not after[name] for name in shown)
    assert (reward, terminated, truncated, info["row"]["outcome"], info["row"]["replicate"]) == (1.0, True, False, "reached", 7)

    env = make_env(straight(terrain_z_m=10.0), asks="always")
    shown, _ = env.reset()
    assert shown in env.observation_space
    assert not any(part.any() for part in shown.values())
    _, reward, terminated, _, info = env.step(np.ones(3))
    assert (reward, terminated, info["row"]["outcome"]) == (-1.0, True, "hit_ground")
    assert "10.0 m under the ground" in info["message"]


def test_episodes_are_replicates_in_turn_and_a_reward_of_ones_own_is_asked_at_each_step() -> None:
    asked = campaign(replicates=3, draw={"obstacles.O.radius_m": {"between": [20, 30]}}, sweep={"sensor.range_m": [90, 100]})
    plans = [plan for plan in expand(asked) if plan.cell == "90"]
    told: list[FlightRecord | None] = []

    def reward(before: Any, command: Any, after: Any, record: FlightRecord | None) -> float:
        assert command == (0.0, 0.0, 20.0)
        assert before["time_s"] < after["time_s"]
        told.append(record)
        return float(after["own_pos_enu_m"][2] - before["own_pos_enu_m"][2])

    env = make_env(asked, flight_id=plans[1].flight_id, reward=reward)
    seen = [env.reset() for _ in range(2)]
    assert [info["flight_id"] for _, info in seen] == [plan.flight_id for plan in plans[1:]]
    assert [shown["obstacles"][0, -1] for shown, _ in seen] == [plan.obstacles[0].radius_m for plan in plans[1:]]
    assert env.reset(seed=1000)[1]["replicate"] == 1000, "by the same rule past those of the campaign"
    z_m = env.reset(seed=0)[0]["own_pos_enu_m"][2]
    assert env.reset()[1]["replicate"] == 1, "after a seed they go on from there"
    env.reset(seed=0)
    rewards = []
    ended = False
    while not ended:
        shown, worth, ended, _, _ = env.step([0.0, 0.0, 20.0])
        rewards.append(worth)
    assert sum(rewards) == pytest.approx(shown["own_pos_enu_m"][2] - z_m)
    assert told[-1] is env.record
    assert not any(told[:-1])


def test_what_cannot_be_stepped_is_refused_in_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    swept = campaign(sweep={"sensor.range_m": [90, 100]})
    for message, asked, how in (
        ("several cells; say which by cell=: '90', '100'", swept, {}),
        ("no cell '95'; there are: '90', '100'", swept, {"cell": "95"}),
        ("no flight 'abc'", swept, {"flight_id": "abc"}),
        ("no flight '.*' in the cell '90'", swept, {"cell": "90", "flight_id": expand(swept)[1].flight_id}),
        ("command must be one of acceleration, velocity, not 'bank'", campaign(), {"command": "bank"}),
        ("asks must be one of when_threatened, always, not 'never'", campaign(), {"asks": "never"}),
        ("most must be a finite number above 0", campaign(), {"most": 0.0}),
        ("the planner 'survivor' asks nobody .* asks='always'", campaign(planner={"kind": "survivor"}), {}),
    ):
        with pytest.raises(ValueError, match=message):
            make_env(asked, **how)  # type: ignore[arg-type]
    monkeypatch.setattr(ProportionalNavigation, "steer", lambda *_: (None, FROM_OUTSIDE))
    with pytest.raises(ValueError, match=r"takes commands from outside, which testbed\.make_env asks for"):
        fly(expand(campaign(method={"kind": "proportional_navigation"}))[0])
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    monkeypatch.delitem(sys.modules, "testbed.run.env")
    monkeypatch.delattr(testbed.run, "env")
    with pytest.raises(ImportError, match=re.escape("make_env needs gymnasium, which is an extra: pip install 'vosc-testbed[env]'")):
        make_env(campaign())


def test_the_page_shows_what_is_shown_and_its_example_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    listed = re.findall(r"^\| `(\w+)` \| (\d) \| (.+) \|$", PAGE, re.M)
    assert listed == [(one.name, str(one.size), one.definition) for one in (*SHOWN, *OBSTACLE)]
    (block,) = re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S)
    monkeypatch.chdir(ROOT)
    exec(compile(block, "stepping.md", "exec"), {})
    said = capsys.readouterr().out.strip()
    assert re.fullmatch(r"1\.0 reached 3\.\d+", said)
    assert said[:15] in PAGE
