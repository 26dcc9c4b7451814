from collections.abc import Callable
from pathlib import Path

import pytest

from testbed.campaign import SpecError, load_campaign

CAMPAIGNS = Path(__file__).resolve().parents[2] / "campaigns"

GOOD = """\
name: demo
question: Does it load?
seed: 7
replicates: 2
speed_mps: 50
route:
  start_enu_m: [0, 0, 0]
  goal_enu_m: [500, 200, 100]
  start_direction_deg: [40.87, 26.13]
  goal_direction_deg: [10.00, 2.84]
obstacles:
  - name: O
    radius_m: 25
    position_enu_m: [254, 63.6, 60.7]
    speed_mps: 40
    direction_deg: [106, 12.4]
    when: {time_s: 3}
method: {kind: scoam}
plant: {kind: kinematic}
air: {wind: {kind: steady, speed_mps: 5, from_deg: 270}}
sweep:
  method.kind: [none, scoam]
  flown:
    slow: {speed_mps: 40}
    high: {begin: {climb_at_most_deg: 18}, plant.kind: jsbsim}
"""

PARTED = (
    GOOD.partition("sweep:\n")[0]
    + """\
draw: {replan.k: {within: 0.1}}
parts:
  calm:
    replicates: 1
    set: {air.wind: {kind: calm}}
    sweep:
      method.kind: [none, scoam]
      flown:
        slow: {speed_mps: 40}
        fast: {speed_mps: 60}
    skip:
      - {method.kind: none, flown: [fast]}
  wind:
    draw:
      obstacles.O.direction_deg: {within: [0.5, 0.05]}
      route.magnitude_chords: {between: [0.6, 2.2]}
  population:
    replicates: 3
    recordings: none
    set: {obstacles: []}
    encounters:
      own_at_enu_m: [162, 101, 64.3]
      own_direction_deg: [24.7, 12.0]
      trigger: {range_m: 100}
      obstacle_speed_mps: [20, 50]
      radius_m: [25, 30]
    sweep:
      sensor.range_m: [100, 200]
"""
)


@pytest.fixture
def good() -> str:
    return GOOD


@pytest.fixture
def parted() -> str:
    return PARTED


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str | bytes], str]:
    """Writes ``bad.yaml`` into a fresh working directory and gives its name, so that messages are the same everywhere."""
    monkeypatch.chdir(tmp_path)

    def save(text: str | bytes) -> str:
        Path("bad.yaml").write_bytes(text if isinstance(text, bytes) else text.encode())
        return "bad.yaml"

    return save


@pytest.fixture
def complaint(write: Callable[[str | bytes], str]) -> Callable[..., str]:
    """The message about a text (and overrides), which must be refused."""

    def load(text: str | bytes, *overrides: str) -> str:
        with pytest.raises(SpecError) as caught:
            load_campaign(write(text), overrides)
        return str(caught.value)

    return load
