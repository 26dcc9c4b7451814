"""The linear model and what is read from it, against published figures and against the aircraft itself."""

from typing import Any

import jsbsim
import numpy as np
import pytest
from scipy.optimize import least_squares

from testbed.airframe.identify import full_control, servo_lag_s, thrust_lag_s
from testbed.airframe.linearise import LATERAL, LONGITUDINAL, Mode, linearise, modes, respond
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.plants.aircraft import Aircraft, load_aircraft
from testbed.flight.plants.jsbsim_start import load_model
from testbed.flight.plants.rig import Controls, Rig

GTM = load_aircraft("gtm_t2")
MODEL = linearise(Rig(GTM, 50.0))


def by_name() -> dict[str, Mode]:
    return {mode.name: mode for mode in modes(MODEL)}


@pytest.mark.parametrize(
    ("name", "frequency", "damping", "rounding"),
    [("short period", 8.99, 0.420, 0.0005), ("phugoid", 0.23, 0.133, 0.005), ("Dutch roll", 7.17, 0.138, 0.005)],
)
def test_modes_of_gtm_t2_as_published(name: str, frequency: float, damping: float, rounding: float) -> None:
    """Within 2 %, and half a unit of the published last digit (the phugoid's frequency has two of them)."""
    mode = by_name()[name]
    assert mode.frequency_rad_s == pytest.approx(frequency, abs=0.02 * frequency + rounding)
    assert mode.damping == pytest.approx(damping, abs=0.02 * damping + 0.0005)


def test_roll_mode_of_gtm_t2_as_published() -> None:
    assert by_name()["roll"].time_constant_s == pytest.approx(0.110, rel=0.02)
    assert by_name()["spiral"].time_constant_s > 10.0


def test_full_controls_of_gtm_t2_as_published() -> None:
    controls = full_control(GTM, 50.0)
    assert controls.time_to_45_s == pytest.approx(0.425, abs=0.02)
    assert controls.peak_rate_radps / DEG == pytest.approx(163.0, abs=1.0)
    # 3.98 was taken with Euler's rule at 120 Hz, which is 1.2 % high: see the next test
    assert controls.peak_load_factor == pytest.approx(3.98, rel=0.02)


@pytest.mark.slow
def test_full_controls_hardly_depend_on_the_step() -> None:
    """Peaks of a violent pull and of a roll at 120 Hz, against the same at 1920 Hz, where halving the step moves neither by 1e-4."""
    peaks = []
    for hz in (120, 1920):
        pull = Rig(GTM, 50.0, hz=hz).release(2.0, Controls(elevator=-1.0))
        roll = Rig(GTM, 50.0, hz=hz).release(1.0, Controls(aileron=1.0))
        peaks.append((pull["load_factor"].max(), roll["p"].max()))
    assert peaks[0] == pytest.approx(peaks[1], rel=0.0015)


def test_lags_of_gtm_t2_are_those_in_its_model() -> None:
    """Servo 5 Hz first order, rate 300 deg/s; thrust t63 2.4 to 2.5 s."""
    assert servo_lag_s(GTM, MODEL) == pytest.approx(1.0 / 31.4, abs=0.01)
    assert thrust_lag_s(GTM, 50.0) == pytest.approx(2.45, abs=0.1)


def test_gravity_and_kinematics_are_exact() -> None:
    """Columns that follow from the definition of the axes."""
    pitch = MODEL.pitch_rad
    assert MODEL.a_long[0, LONGITUDINAL.index("pitch")] == pytest.approx(-G0_MPS2 * np.cos(pitch), rel=2e-3)
    assert MODEL.a_long[1, LONGITUDINAL.index("pitch")] == pytest.approx(-G0_MPS2 * np.sin(pitch), rel=5e-3)
    assert MODEL.a_lat[0, LATERAL.index("bank")] == pytest.approx(G0_MPS2 * np.cos(pitch), rel=2e-3)


@pytest.mark.parametrize(("name", "speed"), [("gtm_t2", 50.0), ("c172p", 50.0), ("t37", 90.0)])
@pytest.mark.parametrize(("control", "shown"), [("elevator", "q"), ("aileron", "p"), ("rudder", "r")])
def test_the_linear_model_answers_as_the_aircraft(name: str, speed: float, control: str, shown: str) -> None:
    """A small step of a control, held for two seconds, behind the servo that only gtm_t2's model has (5 Hz).

    The difference stays within 5 % of the peak; 8 % for the T37's elevator, whose linkage has a kink where it trims, and 10 % for
    gtm_t2's rudder, whose lightly damped Dutch roll adds up a small difference in frequency.
    """
    aircraft = load_aircraft(name)
    model = linearise(Rig(aircraft, speed))
    size = -0.02
    flown = Rig(aircraft, speed).release(2.0, Controls(**{control: size}))
    states, a, b = LONGITUDINAL, model.a_long, model.b_long[:, 0]
    if control != "elevator":
        states, a, b = LATERAL, model.a_lat, model.b_lat[:, 0 if control == "aileron" else 1]
    servo = 31.416 if name == "gtm_t2" else 1e4
    with_servo = np.vstack([np.column_stack([a, b]), [0.0, 0.0, 0.0, 0.0, -servo]])
    push = np.array([0.0, 0.0, 0.0, 0.0, servo * size])
    linear = respond(with_servo, push, np.zeros(5), flown["time_s"])[:, states.index(shown)]
    rate = flown[shown] - flown[shown][0]
    error = np.abs(rate[1:] - linear[:-1]).max()  # JSBSim takes a command in the step after it is set
    bound = {("t37", "elevator"): 0.08, ("gtm_t2", "rudder"): 0.10}.get((name, control), 0.05)
    assert error < bound * np.abs(linear).max()


def test_response_of_the_linear_model_is_exact() -> None:
    time_s = np.linspace(0.0, 2.0, 41)
    states = respond(np.array([[-2.0]]), np.array([3.0]), np.array([0.5]), time_s)
    assert states[:, 0] == pytest.approx(1.5 - np.exp(-2.0 * time_s))


@pytest.mark.slow
def test_phugoid_is_the_one_flown_in_air_of_one_density(monkeypatch: pytest.MonkeyPatch) -> None:
    """gtm_t2 let go 0.5 m/s fast, the same flight from trim taken off: frequency and damping within 0.5 %, with no model between.

    The published damping, 0.133, is that of JSBSim's own linearisation, which takes 2 % too much.
    """

    def one_density(aircraft: Aircraft, plant_hz: int) -> Any:
        fdm = load_model(aircraft, plant_hz)
        for name, air in (("density", "rho-slugs_ft3"), ("pressure", "P-psf"), ("temperature", "T-R")):
            fdm[f"atmosphere/override/{name}"] = level_air[f"atmosphere/{air}"]
        return fdm

    level_air = Rig(GTM, 50.0)._fdm
    monkeypatch.setattr("testbed.flight.plants.rig.load_model", one_density)
    rig = Rig(GTM, 50.0)
    fast, trimmed = rig.release(80.0, motion=rig.motion._replace(u=rig.motion.u + 0.5)), Rig(GTM, 50.0).release(80.0)
    late = slice(3 * 120, None, 12)  # the short period is over
    time_s, u = fast["time_s"][late], (fast["u"] - trimmed["u"])[late]

    def misfit(p: np.ndarray) -> np.ndarray:
        frequency, damping, cosine, sine, rest = p
        angle = frequency * np.sqrt(1.0 - damping**2) * time_s
        return np.exp(-damping * frequency * time_s) * (cosine * np.cos(angle) + sine * np.sin(angle)) + rest - u

    frequency, damping = least_squares(misfit, [0.23, 0.13, 0.5, 0.0, 0.0]).x[:2]
    assert by_name()["phugoid"].frequency_rad_s == pytest.approx(frequency, rel=0.005)
    assert by_name()["phugoid"].damping == pytest.approx(damping, rel=0.005)
    jsbsims_own = jsbsim.FGLinearization(level_air)
    names, matrix = jsbsims_own.x_names, np.array(jsbsims_own.system_matrix)
    four = [names.index(state) for state in ("Vt", "Alpha", "Theta", "Q")]
    slowest = min(np.linalg.eigvals(matrix[np.ix_(four, four)]), key=abs)
    assert -slowest.real / abs(slowest) == pytest.approx(0.133, abs=0.0005)
    print(frequency, damping, -slowest.real / abs(slowest))
