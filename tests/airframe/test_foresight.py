"""How an aircraft answers and how far its flights differ from their predictions: found again where it is known, and by the command."""

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from testbed.airframe import foresight
from testbed.airframe.foresight import IdentifyError, fitted, margin_of, out_by
from testbed.airframe.foresight_trial import Trial
from testbed.cli import app
from testbed.core.catalogue import aircraft_folders
from testbed.flight.planning.prediction import FILE, Lags, aeroplane_of, read_prediction
from testbed.flight.plants.aircraft import load_aircraft
from vosc.predict import Directions, Motion, fly_on

TRUE = Lags(bank_lag_s=0.15, roll_start_s=0.1, load_lag_s=0.2, load_start_s=0.05)


@dataclass
class Flown:
    """As much of a record as is looked at."""

    columns: dict[str, np.ndarray]
    plan: Any


@dataclass
class Plan:
    speed_mps: float = 50.0


def trials(count: int) -> list[Trial]:
    """Held directions, flown by the prediction itself with known lags."""
    rng = np.random.default_rng(5)
    aeroplane = aeroplane_of(load_aircraft("gtm_t2"), TRUE)
    off, around = rng.uniform(0.1, 0.9, count), rng.uniform(0, 2 * np.pi, count)
    ways = Directions(np.cos(off), np.sin(off) * np.cos(around), np.sin(off) * np.sin(around))
    values = (0.0, 0.0, 0.0, 50.0, 0.0, 0.5 * np.pi, 0.0, 0.0, 1.0, 0.0, aeroplane.drag_zero + aeroplane.drag_lift)
    times = np.concatenate([np.arange(0.0, 0.975, 0.05), np.arange(1.0, 2.05, 0.1)])
    flown = fly_on(aeroplane, Motion(*(np.full(count, value) for value in values)), ways, times, (0.0, 0.0, 0.0), 50.0)
    made, level = [], np.array([50.0, 0.0, 0.0])
    for k in range(count):
        place = np.array([flown.x[:, k], flown.y[:, k], flown.z[:, k]]).T
        still = {"own.vel_enu_mps": np.tile(level, (len(times), 1)), "own.rates_body_radps": np.zeros((len(times), 3))}
        straight = {"own.bank_rad": np.zeros(len(times)), "own.load_factor": np.ones(len(times))}
        record: Any = Flown({"time_s": times, "own.pos_enu_m": place, **still, **straight}, Plan())
        told = ((0.0, 0.4, 1.0 + 0.01 * k), (0.1, 1.7, 2.0))
        made.append(Trial(record, (ways.x[k], ways.y[k], ways.z[k]), 0.0, 2.0, 1.0, told))
    return made


def test_lags_that_made_the_flights_are_found_again() -> None:
    flown, aircraft = trials(20), load_aircraft("gtm_t2")
    found = fitted(aircraft, flown)
    assert list(found.model_dump().values()) == pytest.approx([0.15, 0.1, 0.2, 0.05], abs=0.02)
    assert float(out_by(aircraft, flown, "", found).split()[0]) < 0.02
    assert float(out_by(aircraft, flown, "", None).split()[0]) > 0.3


def test_the_margin_is_the_99th_percentile_of_each_range_and_never_falls(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(foresight, "WITHIN_S", (1.0, 2.0))
    margin = margin_of(trials(100))
    assert margin.margin_m == (0.99, 1.0)  # of 0, 0.01 ... 0.99; of 1 alone
    assert margin.median_m == pytest.approx((0.5, 1.0), abs=0.011)
    assert margin.at(np.array([0.2, 1.0, 1.5, 30.0])).tolist() == [0.99, 0.99, 1.0, 1.0]
    monkeypatch.setattr(foresight, "WITHIN_S", (0.1, 2.0))
    with pytest.raises(IdentifyError, match=r"only 0 predictions with 0 to 0\.1 s to go"):
        margin_of(trials(20))


@pytest.mark.slow
def test_the_command_writes_what_the_planner_reads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A few flights in JSBSim of a copy of the aircraft; margins of another air stay where the lags are the same."""
    shutil.copytree(aircraft_folders()["gtm_t2"], tmp_path / "copied", ignore=shutil.ignore_patterns(FILE))
    monkeypatch.setenv("TESTBED_AIRCRAFT_PATH", str(tmp_path))
    for name, value in {"LEAST_FLIGHTS": 3, "LAG_FLIGHTS": 5, "WITHIN_S": (20.0,), "EVALUATIONS": 40}.items():
        monkeypatch.setattr(foresight, name, value)
    fly = foresight._flown
    flown: dict[object, list[Trial]] = {}

    def once(*asked: Any) -> list[Trial]:
        key = asked[2:]
        if key not in flown:
            flown[key] = fly(*asked)
        return flown[key]

    monkeypatch.setattr(foresight, "_flown", once)
    for air in ("calm", "turbulence"):
        result = CliRunner().invoke(app, ["identify", "copied", "--air", air, "--encounters", "3"])
        assert result.exit_code == 0, result.output
    assert "moderate turbulence (Dryden): 3 flights" in result.output
    found = read_prediction(tmp_path / "copied")
    assert found
    assert set(found.margins) == {"calm", "turbulence"}
    assert found.lags.roll_start_s > 0.03  # an aeroplane does not roll at once
    assert found.margins["calm"].margin_m[0] <= 4.0


def test_too_few_flights_are_refused_in_words() -> None:
    result = CliRunner().invoke(app, ["identify", "gtm_t2", "--encounters", "3"])
    assert result.exit_code == 1
    assert "give at least 20, a percentile of fewer says nothing" in result.output
