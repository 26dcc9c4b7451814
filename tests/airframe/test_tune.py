"""The gains in aircraft.yaml are those that the command finds, and they fly as they should."""

import math
from pathlib import Path

import numpy as np
import pytest

from testbed.airframe import tune as tuning
from testbed.airframe.identify import StepResponse, gust_step
from testbed.airframe.linearise import linearise
from testbed.airframe.proof_courses import random_path, swerve, turn_radius
from testbed.airframe.trial import follow
from testbed.airframe.trim import steepest_climb
from testbed.core.frames import wind_enu_from_compass
from testbed.core.units import DEG
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.rig import Rig
from testbed.flight.route.path import ActivePath
from tests.plans import PAPER_ROUTE
from vosc import ph

SPEEDS = {"gtm_t2": 50.0, "c172p": 50.0, "t37": 90.0}


def original(name: str) -> tuple[ActivePath, float]:
    """The paper's route, turned level for an aircraft that cannot climb it; and where its climb has fallen to 18 deg."""
    level = name != "gtm_t2"
    ends = [np.zeros(3), np.array(PAPER_ROUTE["goal_enu_m"], float)]
    size = float(np.linalg.norm(ends[1])) * (SPEEDS[name] / 50.0) ** 2
    if level:
        ends[1] = size * np.array([ends[1][0], ends[1][1], 0.0]) / math.hypot(*ends[1][:2])
    directions = []
    for key in ("start_direction_deg", "goal_direction_deg"):
        azimuth, elevation = (a * DEG for a in PAPER_ROUTE[key])
        elevation = 0.0 if level else elevation
        directions.append(
            size * np.array([math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)])
        )
    path = ActivePath([ph.hermite(ends[0], directions[0], ends[1], directions[1])])
    begin = next(s for s in range(500) if path.frame(float(s))[1][2] <= math.sin(18.0 * DEG))
    return path, float(begin)


@pytest.mark.parametrize("name", SPEEDS)
def test_the_file_says_which_command_found_its_gains(name: str) -> None:
    assert load_aircraft(name).gains_found_by == f"testbed tune {name}"
    assert load_aircraft(name).autopilot.reference_mps == SPEEDS[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gtm_t2", "t37"])
def test_tuning_again_finds_what_the_file_holds_and_writes_the_same_bytes(name: str, tmp_path: Path) -> None:
    aircraft = load_aircraft(name)
    file = tmp_path / "aircraft.yaml"
    file.write_bytes((aircraft.folder / "aircraft.yaml").read_bytes())
    found = tuning.find_gains(aircraft)
    assert found.autopilot == aircraft.autopilot
    assert found.guidance == aircraft.guidance
    tuning.write_gains(aircraft.model_copy(update={"folder": tmp_path}), tuning.changes(name, found))
    assert file.read_bytes() == (aircraft.folder / "aircraft.yaml").read_bytes()


def test_writing_gains_keeps_comments(tmp_path: Path) -> None:
    aircraft = load_aircraft("gtm_t2")
    text = (aircraft.folder / "aircraft.yaml").read_text()
    (tmp_path / "aircraft.yaml").write_text(text)
    tuning.write_gains(aircraft.model_copy(update={"folder": tmp_path}), {"guidance": {"damping": 0.7}})
    assert (tmp_path / "aircraft.yaml").read_text() == text.replace("damping: 0.8", "damping: 0.7")


def test_gains_that_fail_their_check_are_not_written(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tuning, "with_inner_loops", lambda aircraft: aircraft)
    monkeypatch.setattr(tuning, "identified", lambda aircraft, _pace: aircraft)
    monkeypatch.setattr(tuning, "verify", lambda _: [tuning.Check("overshoot", math.nan, 5.0, "%")])
    monkeypatch.setattr(tuning, "write_gains", lambda *_: pytest.fail("written"))
    with pytest.raises(tuning.TuneFailedError, match="FAILED"):
        tuning.tune("gtm_t2", write=True)


def test_slower_gains_are_tried_and_accepted_ones_say_what_they_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of four paces none passes; 0.6 misses least. Without --accept nothing is written; with it, that one is, and what it missed."""
    overshoot = {1.0: 9.0, 0.8: 7.0, 0.6: 6.0, 0.4: 8.0}
    written: list[dict[str, object]] = []
    monkeypatch.setattr(tuning, "with_inner_loops", lambda aircraft: aircraft)
    monkeypatch.setattr(
        tuning,
        "identified",
        lambda aircraft, pace: aircraft.model_copy(update={"guidance": aircraft.guidance.model_copy(update={"damping": pace})}),
    )
    monkeypatch.setattr(tuning, "verify", lambda aircraft: [tuning.Check("overshoot", overshoot[aircraft.guidance.damping], 5.0, "%")])
    monkeypatch.setattr(tuning, "write_gains", lambda _, found: written.append(found))
    with pytest.raises(tuning.TuneFailedError, match="--accept"):
        tuning.tune("gtm_t2", write=True)
    assert not written
    tuning.tune("gtm_t2", write=True, accept=True)
    assert written[0]["guidance"]["damping"] == 0.6  # type: ignore[index]
    assert written[0]["verified"] is False
    assert written[0]["missed"] == ["overshoot 6 (at most 5) %"]
    overshoot[0.8] = 4.0
    assert "ok" in tuning.tune("gtm_t2", write=True)
    assert "verified" not in written[1], "a file that never said otherwise says nothing"


def test_what_cannot_be_measured_ends_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    nowhere = load_aircraft("gtm_t2").model_copy(
        update={"autopilot": load_aircraft("gtm_t2").autopilot.model_copy(update={"reference_mps": 15.0})}
    )
    monkeypatch.setattr(tuning, "load_aircraft", lambda _: nowhere)
    with pytest.raises(tuning.TuneFailedError, match=r"gtm_t2: no gains were found at 15 m/s: no level trim at 15 m/s"):
        tuning.tune("gtm_t2", write=True)
    limits = nowhere.limits.model_copy(update={"roll_rate_dps": math.nan})
    with pytest.raises(ValueError, match=r"could not be measured: limits\.roll_rate_dps"):
        tuning.sound(nowhere.model_copy(update={"limits": limits}))


def test_lag_of_a_pure_delay_is_that_delay() -> None:
    time_s = np.arange(0.0, 5.0, 0.005)
    response = StepResponse(time_s, (time_s >= 0.3).astype(float))
    assert response.lag_s(1.0) == pytest.approx(0.3, abs=0.005)
    assert abs(response.transfer(np.array([1.0]))[0]) == pytest.approx(1.0, abs=0.005)


@pytest.mark.parametrize("name", SPEEDS)
def test_the_file_holds_what_a_gust_does(name: str) -> None:
    """The lift slope of the linear model is the jump that JSBSim makes in a gust, to 2 %; the decay is the one found again."""
    aircraft = load_aircraft(name)
    point, model = aircraft.point_mass, linearise(Rig(aircraft, SPEEDS[name]))
    for key, value in tuning._in_gusts(aircraft, model).items():
        assert getattr(point, key) == pytest.approx(value, rel=0.01), key
    for direction, jump in ((0.0, 0.0, 1.0), point.load_factor_per_rad), ((0.0, -1.0, 0.0), 2.0):
        _, added = gust_step(aircraft, SPEEDS[name], direction)
        assert added[0] == pytest.approx(jump, rel=0.02)


def test_guidance_bandwidth_falls_with_the_lag() -> None:
    time_s = np.arange(0.0, 5.0, 0.005)
    steps = [StepResponse(time_s, (time_s >= lag).astype(float)) for lag in (0.1, 0.2, 0.4)]
    found = [tuning.guidance_bandwidth(step, step, step) for step in steps]
    assert found[0] == pytest.approx(2.0 * found[1], rel=0.06)
    assert found[1] == pytest.approx(2.0 * found[2], rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("name", SPEEDS)
def test_tracks_the_original_path_in_calm_air_and_in_wind(name: str) -> None:
    """Calm: RMS 0.35 m, 0.8 m at most. 10 m/s from any of eight directions: RMS 0.5 m."""
    path, begin = original(name)
    calm = follow(load_aircraft(name), path, SPEEDS[name], from_s_m=begin)
    assert calm.rms_m <= 0.35
    assert calm.most_m <= 0.8
    for direction in range(0, 360, 45):
        blown = follow(load_aircraft(name), path, SPEEDS[name], wind_enu_from_compass(10.0, direction), from_s_m=begin)
        assert blown.rms_m <= 0.5, direction


def test_gtm_t2_tracks_an_s_swerve() -> None:
    """Heading from -15 to +15 deg in 150 m and back."""
    assert follow(load_aircraft("gtm_t2"), swerve(4), 50.0).rms_m <= 0.8


def test_c172p_tracks_the_swerve_that_its_ailerons_can_roll() -> None:
    """In 150 m it would have to roll at 84 deg/s, of which full aileron gives 57; in 220 m at 57 deg/s less than 40."""
    assert follow(load_aircraft("c172p"), swerve(4, swing_m=220.0), 50.0).rms_m <= 0.5


TIGHT = {2: 1.56, 4: 1.47, 5: 1.22, 7: 1.42, 11: 1.41, 12: 1.41}
"""Of twenty paths with a radius between 1.2 and 2.5 of the tightest, by their seed those below 1.6, which are the hardest to follow."""


@pytest.mark.slow
@pytest.mark.parametrize("name", SPEEDS)
def test_tracks_random_paths(name: str) -> None:
    """Bends near the tightest, climbs near the steepest: half a metre on each."""
    aircraft, speed = load_aircraft(name), SPEEDS[name]
    tightest = turn_radius(speed, aircraft.limits.bank_deg * DEG)
    climb = 0.8 * steepest_climb(aircraft, speed)
    for seed, times in TIGHT.items():
        rng = np.random.default_rng([7, seed])
        radius = tightest * rng.uniform(1.2, 2.5)
        assert radius == pytest.approx(times * tightest, abs=0.01 * tightest)
        assert follow(aircraft, random_path(rng, radius, climb), speed).rms_m <= 0.5, seed
