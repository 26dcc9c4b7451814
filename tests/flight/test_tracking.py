"""Trackers: what theory and another program say of the same measurements, when a track begins and ends, and what it costs to be wrong."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

from testbed.flight.fly import make_sensor
from testbed.flight.plants.base import State
from testbed.flight.sensing import Seen, SensorContext
from testbed.flight.sensing.imperfect import Imperfect
from testbed.flight.sensing.truth import Truth
from testbed.flight.tracking.alpha_beta import AlphaBeta
from testbed.flight.tracking.base import Filtered, Tracked
from testbed.flight.tracking.imm import InteractingModels
from testbed.flight.tracking.kalman import Kalman
from testbed.flight.traffic import Sampled, Traffic
from testbed.flight.traffic.straight import Straight
from tests.plans import plan

HERE = State(*[0.0] * 20)
REFERENCE: dict[str, Any] = json.loads(Path(__file__).with_name("tracker_reference.json").read_text())


def fed(tracker: Filtered, seen: list[Seen]) -> tuple[Any, tuple[Seen, ...]]:
    memory: Any = tracker.start()
    shown: tuple[Seen, ...] = ()
    for one in seen:
        memory, shown = tracker.track(memory, one.time_s, [one])
    return memory, shown


def at(time_s: float, values: Any, covariance: Any = None) -> Seen:
    x, y, z, vx, vy, vz = map(float, values)
    return Seen("O", 5.0, (x, y, z), (vx, vy, vz), time_s, covariance)


class Wanders(Sampled):
    """Accelerates anew at every measurement, by what the filter takes it to."""

    name, radius_m = "O", 5.0

    def __init__(self, random: np.random.Generator, step_s: float, size_mps2: float) -> None:
        self._step_s, self._a = step_s, size_mps2 * random.normal(size=(100, 3))
        self._v = np.cumsum(np.vstack([[-20.0, 5.0, 1.0], step_s * self._a]), axis=0)
        moved = step_s * self._v[:-1] + 0.5 * step_s**2 * self._a
        self._p = np.cumsum(np.vstack([[150.0, -20.0, 10.0], moved]), axis=0)

    def at(self, time_s: float):
        k = round(time_s / self._step_s)
        return tuple(self._p[k].tolist()), tuple(self._v[k].tolist())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("noise", "acceleration_mps2"),
    [
        ({"position_noise_m": 3.0, "velocity_noise_mps": 1.0}, 0.0),
        ({"position_noise_m": 3.0, "velocity_noise_mps": "unmeasured", "bearing_noise_deg": 0.5}, 2.0),
    ],
)
def test_the_kalman_filter_s_covariance_is_that_of_its_errors(noise: dict, acceleration_mps2: float) -> None:
    """NEES, the squared error in its own standard deviations, over 200 flights: chi-square of 6 x 200 degrees of freedom, at every look."""
    runs, looks, step_s = 200, 30, 0.1
    sensor, tracker = Imperfect(update_hz=10.0, **noise), Kalman(acceleration_mps2=acceleration_mps2, confirm_looks=1)
    nees, squares = np.zeros((runs, looks)), np.zeros((runs, looks))
    for run in range(runs):
        random = np.random.default_rng([14, run])
        line = Wanders(random, step_s, acceleration_mps2)
        both = Tracked(sensor, "kalman", tracker, is_ours=True)
        memory: Any = both.start(SensorContext(1e4, 10, random))
        for k in range(looks):
            memory, (one,) = both.sense(memory, k * step_s, HERE, Traffic((line,)))
            error = np.concatenate(np.subtract((one.pos, one.vel), line.at(k * step_s)))
            nees[run, k] = error @ np.linalg.solve(np.array(one.covariance), error)
            squares[run, k] = error[:3] @ error[:3]
    low, high = stats.chi2.ppf([0.025, 0.975], 6 * runs) / runs
    settled = nees.mean(axis=0)[5:]  # a first velocity is not drawn, but guessed
    assert np.mean((low <= settled) & (settled <= high)) >= 0.85  # of 25 looks that hang together, 95 % are expected
    assert low <= settled[-1] <= high
    assert squares[:, -1].mean() < 0.5 * squares[:, 0].mean()


def test_of_positions_alone_a_line_is_known_as_a_regression_knows_it() -> None:
    """Variances of place and velocity at the end of n even measurements of a straight line: least squares, in closed form."""
    n, step_s, sigma = 12, 0.25, 3.0
    covariance = np.diag([sigma**2] * 3 + [math.inf] * 3)
    rows = tuple(map(tuple, covariance.tolist()))
    seen = [at(k * step_s, (10.0 * k, 0, 0, 0, 0, 0), rows) for k in range(n)]
    _, (one,) = fed(Kalman(acceleration_mps2=0.0, first_speed_mps=10_000.0), seen)
    assert one.covariance is not None
    assert one.covariance[0][0] == pytest.approx(sigma**2 * 2 * (2 * n - 1) / (n * (n + 1)), rel=1e-5)
    assert one.covariance[3][3] == pytest.approx(12 * sigma**2 / (n * (n * n - 1) * step_s**2), rel=1e-5)
    assert one.vel == pytest.approx((10.0 / step_s, 0.0, 0.0), abs=1e-4)


def test_two_filters_agree_with_another_program() -> None:
    step_s, stays = REFERENCE["step_s"], REFERENCE["stays"]
    seen = [at(k * step_s, z) for k, z in enumerate(REFERENCE["measured"])]
    lasts_s = -2.0 * step_s / math.log(2.0 * stays - 1.0)
    for tracker, name in ((Kalman(), "kalman"), (InteractingModels(lasts_s=lasts_s), "imm")):
        memory, (one,) = fed(tracker, seen)
        np.testing.assert_allclose((*one.pos, *one.vel), REFERENCE[name]["values"], rtol=1e-9)
        np.testing.assert_allclose(one.covariance, REFERENCE[name]["covariance"], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(memory["O"].estimate.shares, REFERENCE["imm"]["shares"][-1], rtol=1e-9)
    quiet = [shares[0] for shares in REFERENCE["imm"]["shares"]]
    assert quiet[13] > 0.5 > quiet[-1]  # before the turn, and in it


def test_the_alpha_beta_filter_passes_on_the_share_of_noise_that_theory_says() -> None:
    """Of white noise in the place: (2 a^2 + 2 b - 3 a b) / (a (4 - 2 a - b)); of a straight line, nothing in the end."""
    a, b = 0.4, 0.1
    noise = np.random.default_rng(3).normal(size=6000)
    tracker, memory, shown = AlphaBeta(alpha=a, beta=b), {}, []
    for k, error in enumerate(noise):
        memory, found = tracker.track(memory, 0.1 * k, [at(0.1 * k, (error - 5.0 * k, 0, 0, 0, 0, 0))])
        shown += [found[0].pos[0] + 5.0 * k] if len(found) else []
    assert np.var(shown[50:]) == pytest.approx((2 * a**2 + 2 * b - 3 * a * b) / (a * (4 - 2 * a - b)), rel=0.06)
    _, (one,) = fed(AlphaBeta(), [at(0.1 * k, (-5.0 * k, 0, 0, 0, 0, 0)) for k in range(60)])
    assert one.pos[0] == pytest.approx(-5.0 * 59, abs=1e-6)
    assert one.covariance is None


@pytest.mark.parametrize("tracker", [AlphaBeta(coast_s=0.5), Kalman(coast_s=0.5), InteractingModels(coast_s=0.5)])
def test_a_track_is_confirmed_goes_on_and_ends(tracker: Filtered) -> None:
    """From the third measurement on; straight on while nothing comes, and what was told already is nothing; then no more."""
    memory, line = tracker.start(), [at(0.1 * k, (100 - 4.0 * k, 0, 0, -40.0, 0, 0)) for k in range(3)]
    shown = []
    for k in range(10):
        memory, found = tracker.track(memory, 0.1 * k, line[k : k + 1] if k < 3 else line[2:] if k == 3 else [])
        shown.append([(one.time_s, round(one.pos[0], 6)) for one in found])
    assert [len(found) for found in shown] == [0, 0, 1, 1, 1, 1, 1, 1, 0, 0]
    assert shown[6] == [(pytest.approx(0.6), pytest.approx(76.0, abs=1e-3))]
    assert not memory


def test_a_tracker_stands_behind_any_sensor_and_one_s_own_is_looked_at() -> None:
    assert type(make_sensor(plan())) is Truth
    sensor = make_sensor(plan(tracker={"kind": "kalman", "options": {"confirm_looks": 1}}))
    memory = sensor.start(SensorContext(200.0, 60, np.random.default_rng(0)))
    line = Straight("O", 5.0, (90.0, 0.0, 0.0), (-10.0, 0.0, 0.0))
    memory, (one,) = sensor.sense(memory, 0.5, HERE, Traffic((line,)))
    assert one.pos == pytest.approx((85.0, 0.0, 0.0))

    class Late:
        def start(self) -> None: ...

        def track(self, memory: Any, time_s: float, seen: Any) -> Any:
            return memory, [one._replace(time_s=time_s + 1.0) for one in seen]

    own = Tracked(Truth(), "mine:Late", Late(), is_ours=False)
    mine = own.start(SensorContext(200.0, 60, np.random.default_rng(0)))
    with pytest.raises(ValueError, match=r"the tracker mine:Late must return \(memory, tuple of Seen\), not .* later than now, 0\.5 s"):
        own.sense(mine, 0.5, HERE, Traffic((line,)))
