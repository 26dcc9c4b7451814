"""An aircraft whose data are not the published ones: what is scaled, by how much, and that nothing else is touched."""

import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from testbed import fly, measure
from testbed.airframe.linearise import LATERAL, LONGITUDINAL, linearise
from testbed.campaign.reading.expand import flight_id
from testbed.flight.plants.aircraft import Aircraft, load_aircraft
from testbed.flight.plants.jsbsim_model import read_model
from testbed.flight.plants.jsbsim_start import load_model, model_file, trim_level
from testbed.flight.plants.rig import Rig
from testbed.flight.record import FlightRecord
from testbed.flight.variation import DERIVATIVES, GAINS, LAGS, variation, varied
from tests.plans import C172P, GTM, KINEMATIC, plan

T37: dict[str, Any] = {"plant": {"kind": "jsbsim"}, "aircraft": "t37", "geometry": "level", "speed_mps": 90}
POINT: dict[str, Any] = {"plant": {"kind": "point_mass"}}
CASES = {"gtm_t2": GTM, "c172p": C172P, "t37": T37}
SPREAD = {"derivatives_share": 0.2, "lags_share": 0.2, "gains_share": 0.3}
NOTHING = dict.fromkeys(SPREAD, 1e-300)  # 1 + 1e-300 u is 1: every factor is drawn, written and applied, and is 1
AERO = [f"forces/fb{axis}-aero-lbs" for axis in "xyz"] + [f"moments/{axis}-aero-lbsft" for axis in "lmn"]


def with_factors(aircraft: Aircraft, factors: dict[str, float]) -> Aircraft:
    return aircraft.model_copy(update={"model": aircraft.model.model_copy(update={"factors": factors})})


def wheel(name: str) -> Aircraft:
    nominal = load_aircraft("c172p")
    return nominal.model_copy(update={"model": nominal.model.model_copy(update={"name": name})})


def loads(aircraft: Aircraft, factors: dict[str, float]) -> np.ndarray:
    """Aerodynamic forces and moments in a state where everything is away from zero.

    Without what the rate of the angle of attack adds: that rate is no state, it comes from the forces.
    """
    still = {name: 0.0 for name in derivatives(aircraft) if "adot" in name}
    fdm = load_model(with_factors(aircraft, factors | still), 120)
    for name, value in {"h-sl-ft": 2000.0, "beta-deg": 3.0, "alpha-deg": 4.0, "vt-fps": 160.0}.items():
        fdm[f"ic/{name}"] = value
    fdm["ic/p-rad_sec"], fdm["ic/q-rad_sec"], fdm["ic/r-rad_sec"] = 0.2, 0.1, -0.15
    for surface, value in {"elevator": 0.2, "aileron": -0.3, "rudder": 0.25}.items():
        fdm[f"fcs/{surface}-cmd-norm"] = value
    fdm.set_trim_status(True)  # surfaces are where they are told to be
    fdm.run_ic()
    return np.array([fdm[name] for name in AERO])


def derivatives(aircraft: Aircraft) -> list[str]:
    return read_model(model_file(aircraft)).derivatives


def same(a: FlightRecord, b: FlightRecord) -> bool:
    return a.columns.keys() == b.columns.keys() and all(np.array_equal(a.columns[key], b.columns[key], equal_nan=True) for key in a.columns)


@pytest.mark.parametrize(
    "aircraft", [*map(load_aircraft, CASES), *map(wheel, ["F450", "ZLT-NT", "f16", "t6texan2"])], ids=lambda a: a.model.name
)
def test_all_derivatives_times_f_are_all_aerodynamic_loads_times_f(aircraft: Aircraft) -> None:
    """Nothing is left out and nothing counts twice. F450 and ZLT-NT include their aerodynamics from another file."""
    nominal = loads(aircraft, {})
    assert np.count_nonzero(nominal) >= 2  # a quadcopter has drag only
    assert loads(aircraft, dict.fromkeys(derivatives(aircraft), 1.25)) == pytest.approx(1.25 * nominal, rel=1e-9)


@pytest.mark.parametrize("name", CASES)
def test_the_loads_are_the_sum_of_what_the_derivatives_add(name: str) -> None:
    """Each derivative's own share, found by scaling it alone; together they are the whole."""
    aircraft = load_aircraft(name)
    nominal = loads(aircraft, {})
    shares = [loads(aircraft, {one: 1.5}) - nominal for one in derivatives(aircraft)]
    assert sum(shares) == pytest.approx(0.5 * nominal, rel=1e-7)


def test_a_factor_of_the_roll_damping_is_seen_in_the_linear_model() -> None:
    """Clp = -0.484 in the c172p's file: dp'/dp changes by 0.2 Clp q S b^2 / (2 V) times the inverse inertia; dq'/dq does not."""
    nominal = load_aircraft("c172p")
    more = with_factors(nominal, {"aero/coefficient/Clp": 1.2})
    before, after = (linearise(Rig(aircraft, 50.0)) for aircraft in (nominal, more))
    fdm = load_model(nominal, 120)
    trim_level(fdm, nominal, 50.0, 150.0)
    ixx, izz, ixz = (fdm[f"inertia/{axes}-slugs_ft2"] for axes in ("ixx", "izz", "ixz"))
    span, speed = fdm["metrics/bw-ft"], fdm["velocities/vt-fps"]
    moment = -0.484 * fdm["aero/qbar-psf"] * fdm["metrics/Sw-sqft"] * span * span / (2.0 * speed)
    p, q = LATERAL.index("p"), LONGITUDINAL.index("q")
    assert after.a_lat[p, p] - before.a_lat[p, p] == pytest.approx(0.2 * moment * izz / (ixx * izz - ixz * ixz), rel=1e-3)
    assert after.a_long[q, q] == pytest.approx(before.a_long[q, q], rel=1e-9)


def test_a_factor_of_a_polynomial_derivative_scales_all_its_powers() -> None:
    """gtm_t2: Cm of q is -44.718 + 53.248 alpha - 14969 alpha^6 in gtm_t2.json; one factor for it, none for Cm of alpha."""
    nominal = load_aircraft("gtm_t2")
    rig = Rig(nominal, 35.0)  # slow: alpha is large enough for the powers to count
    more = with_factors(nominal, {"aero/gtm/Cm(velocities/q-aero-rad_sec)": 1.3})
    before, after = linearise(rig), linearise(Rig(more, 35.0))
    fdm = load_model(nominal, 120)
    trim_level(fdm, nominal, 35.0, 150.0)
    chord, speed, a = fdm["metrics/cbarw-ft"], fdm["velocities/vt-fps"], rig.alpha_rad
    slope = (-44.718 + 53.248 * a - 14969.0 * a**6) * fdm["aero/qbar-psf"] * fdm["metrics/Sw-sqft"] * chord * chord / (2.0 * speed)
    q, w = LONGITUDINAL.index("q"), LONGITUDINAL.index("w")
    assert after.a_long[q, q] - before.a_long[q, q] == pytest.approx(0.3 * slope / fdm["inertia/iyy-slugs_ft2"], rel=2e-3)
    assert after.a_long[q, w] == pytest.approx(before.a_long[q, w], rel=1e-9)


def test_gtm_t2_has_the_derivatives_of_its_data_sheet() -> None:
    """Cm of gtm_t2.json: 1 | alpha.. | q.. | de.. | da^2 | beta^2 | dr^2."""
    of_cm = [name for name in derivatives(load_aircraft("gtm_t2")) if name.startswith("aero/gtm/Cm(")]
    controls = [f"fcs/{surface}-pos-rad" for surface in ("aileron", "elevator", "rudder")]
    assert of_cm == [f"aero/gtm/Cm({on})" for on in ("", "aero/alpha-rad", "aero/beta-rad", *controls, "velocities/q-aero-rad_sec")]


def test_a_factor_of_a_lag_is_that_of_the_time_constant() -> None:
    """The elevator's servo, first order with 31.416 1/s: 1 - exp(-31.416 t / f) of the way at t."""
    aircraft = with_factors(load_aircraft("gtm_t2"), {"fcs/elevator-servo": 1.5})
    fdm = load_model(aircraft, 960)
    trim_level(fdm, aircraft, 50.0, 150.0)
    began = fdm["fcs/elevator-pos-deg"]
    fdm["fcs/elevator-cmd-norm"] = 0.1  # 3 deg: 63 deg/s at first, within the servo's rate
    for _ in range(48):
        fdm.run()
    way = (fdm["fcs/elevator-pos-deg"] - began) / 3.0
    assert way == pytest.approx(1.0 - math.exp(-31.416 * 0.05 / 1.5), abs=0.01)


def test_an_own_aircraft_may_include_its_aerodynamics_from_a_file(tmp_path: Path) -> None:
    own = load_aircraft("gtm_t2")
    folder = tmp_path / "gtm_t2"
    shutil.copytree(own.folder, folder)
    text = (folder / "gtm_t2.xml").read_text()
    head, rest = text.split("<aerodynamics>")
    inside, tail = rest.split("</aerodynamics>")
    (folder / "aero.xml").write_text(f"<aerodynamics>{inside}</aerodynamics>")
    (folder / "gtm_t2.xml").write_text(f'{head}<aerodynamics file="aero"/>{tail}')
    split = own.model_copy(update={"folder": folder})
    names = derivatives(own)
    assert derivatives(split) == names
    factors = {name: 1.0 + 0.01 * k for k, name in enumerate(names)}
    assert np.array_equal(loads(split, factors), loads(own, factors))


def test_where_links_are_not_allowed_the_aircraft_s_other_files_are_copied(monkeypatch: pytest.MonkeyPatch) -> None:
    own = load_aircraft("gtm_t2")
    factors = dict.fromkeys(derivatives(own)[:3], 1.1)
    linked = loads(own, factors)

    def refuse(*_: object) -> None:
        raise OSError("a required privilege is not held by the client")

    monkeypatch.setattr(Path, "symlink_to", refuse)
    assert np.array_equal(loads(own, factors), linked)


def test_no_file_is_left_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    load_model(with_factors(load_aircraft("c172p"), {"aero/coefficient/Clp": 1.1}), 120)
    with pytest.raises(KeyError, match="aero/coefficient/Nonsense"):
        load_model(with_factors(load_aircraft("c172p"), {"aero/coefficient/Nonsense": 1.1}), 120)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("case", [*CASES.values(), POINT], ids=[*CASES, "point_mass"])
def test_factors_of_one_fly_the_published_aircraft_bit_for_bit(case: dict[str, Any]) -> None:
    written = plan(vary=NOTHING, **case)
    assert set(variation(written).values()) == {1.0}
    assert same(fly(written), fly(plan(**case)))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("replicate", [0, 1])
def test_the_three_aircraft_trim_and_fly_with_the_spread(name: str, replicate: int) -> None:
    drawn = plan(vary=SPREAD, replicate=replicate, **CASES[name])
    record = fly(drawn)
    assert measure(record).outcome == "reached"
    assert same(record, fly(drawn))
    assert not same(record, fly(plan(**CASES[name])))
    assert not same(record, fly(plan(vary=SPREAD, replicate=replicate + 1, **CASES[name])))


@given(seed=st.integers(0, 2**63 - 1), replicate=st.integers(0, 99_999), share=st.floats(0.001, 0.999))
def test_factors_are_within_the_share_and_scale_with_it(seed: int, replicate: int, share: float) -> None:
    spread = {"derivatives_share": share, "gains_share": share}
    whole = variation(plan(vary=spread, seed=seed, replicate=replicate, **GTM))
    half = variation(plan(vary=dict.fromkeys(spread, 0.5 * share), seed=seed, replicate=replicate, **GTM))
    assert all(abs(factor - 1.0) <= share for factor in whole.values())
    assert not set(LAGS) & whole.keys()
    assert {name: 1.0 + 2.0 * (factor - 1.0) for name, factor in half.items()} == pytest.approx(whole)


@pytest.mark.slow
def test_factors_are_even_over_the_spread() -> None:
    """Uniform in 1 -+ a: mean 1, standard deviation a / sqrt 3, lag and derivative of a replicate independent."""
    draws = [variation(plan(vary=SPREAD, replicate=k, **GTM)) for k in range(2000)]
    clp, servo = (np.array([d[name] for d in draws]) for name in ("aero/gtm/Cl(velocities/p-aero-rad_sec)", "fcs/elevator-servo"))
    for factor in (clp, servo):
        assert factor.mean() == pytest.approx(1.0, abs=4 * 0.2 / math.sqrt(3 * 2000))
        assert factor.std() == pytest.approx(0.2 / math.sqrt(3), rel=0.05)
        assert np.histogram(factor, bins=4, range=(0.8, 1.2))[0].min() > 400
    assert abs(np.corrcoef(clp, servo)[0, 1]) < 4 / math.sqrt(2000)


def test_the_draw_knows_the_replicate_and_the_seed_and_nothing_else() -> None:
    drawn = variation(plan(vary=SPREAD, **GTM))
    other = {"method": {"kind": "none"}, "guidance": {"kind": "l1"}, "rates": {"plant_hz": 240}, "replan": {"k": 2.0}}
    assert variation(plan(vary=SPREAD, **GTM, **other)) == drawn
    of_point = variation(plan(vary=SPREAD, **POINT))
    assert of_point == {name: drawn[name] for name in (*DERIVATIVES, *LAGS, *GAINS)}
    only_lags = variation(plan(vary={"lags_share": 0.2}, **GTM))
    assert only_lags == {name: factor for name, factor in drawn.items() if name in only_lags}
    assert drawn.keys() == variation(plan(vary=SPREAD, replicate=1, **GTM)).keys()
    for changes in ({"replicate": 1}, {"seed": 1}):
        again = variation(plan(vary=SPREAD, **GTM, **changes))
        assert all(again[name] != factor for name, factor in drawn.items())


def test_what_aircraft_yaml_says_is_scaled_where_it_stands_and_limits_are_not() -> None:
    spread = plan(vary=SPREAD, **C172P)
    nominal, factors = load_aircraft("c172p"), variation(spread)
    changed = varied(nominal, spread)
    assert changed.limits == nominal.limits
    assert changed.autopilot.reference_mps == nominal.autopilot.reference_mps
    assert changed.point_mass.thrust_max == nominal.point_mass.thrust_max
    assert changed.command_lag_s == nominal.command_lag_s * factors["command_lag_s"] != nominal.command_lag_s
    for section in ("autopilot", "guidance", "point_mass"):
        before, after = getattr(nominal, section).model_dump(), getattr(changed, section).model_dump()
        assert after == {name: value * factors.get(f"{section}.{name}", 1.0) for name, value in before.items()}
    assert changed.model.factors == {name: factors[name] for name in derivatives(nominal)}


def test_nothing_is_varied_without_a_share_nor_on_rails() -> None:
    nominal = load_aircraft("c172p")
    assert varied(nominal, plan(**C172P)) is nominal
    assert variation(plan(vary=SPREAD, **KINEMATIC)) == {}
    assert same(fly(plan(vary=SPREAD, **KINEMATIC)), fly(plan(**KINEMATIC)))


def test_a_share_is_part_of_who_the_flight_is_and_none_is_not() -> None:
    assert flight_id(plan(vary=dict.fromkeys(SPREAD, 0))) == flight_id(plan())
    assert len({flight_id(plan(vary={key: share})) for key in SPREAD for share in (0.1, 0.2)} | {flight_id(plan())}) == 7


@pytest.mark.parametrize("share", [-0.1, 1.0, math.nan, "0.2"])
def test_a_share_is_a_number_from_zero_to_below_one(share: object) -> None:
    with pytest.raises(ValidationError, match="derivatives_share"):
        plan(vary={"derivatives_share": share})
