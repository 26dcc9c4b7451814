"""Aircraft from JSBSim's wheel: what ``aircraft new`` measures, marks and refuses, and that the result tunes and flies."""

import math
import re
import shutil
from pathlib import Path

import pytest

from testbed import expand, fly, load_campaign, measure
from testbed.airframe import new
from testbed.airframe.gains_file import PLACEHOLDER
from testbed.airframe.new import NewAircraftError, add_aircraft, new_aircraft, wheel_source
from testbed.airframe.new_file import draft_of, rule_load_factor
from testbed.airframe.trial import follow
from testbed.airframe.trim import trim
from testbed.airframe.tune import tune
from testbed.campaign.reading.aircraft import read_aircraft
from testbed.campaign.words.aircraft import Aircraft, Model
from testbed.core.catalogue import AIRCRAFT_ROOT, PATH_VARIABLE, add_aircraft_path
from testbed.core.units import DEG
from testbed.flight.plants.base import TrimFailedError
from testbed.flight.plants.rig import Rig

MARKED = re.compile(r"#.* ?(measured|chosen|copied)")


def wheel(name: str, start: str) -> Aircraft:
    return draft_of(Model(files="wheel", name=name, start=start), Path())  # type: ignore[arg-type]


@pytest.mark.parametrize(("name", "speed"), [("c172p", 50.0), ("T37", 90.0), ("t6texan2", 80.0), ("f16", 120.0)])
def test_a_settled_trim_is_the_one_that_jsbsim_finds(name: str, speed: float) -> None:
    """Where JSBSim's own trim works: the same angle of attack to 0.1 deg, throttle and elevator to 1 %."""
    settled, own = (Rig(wheel(name, start), speed) for start in ("settled", "trimmed"))
    assert settled.alpha_rad == pytest.approx(own.alpha_rad, abs=0.1 * DEG)
    assert settled.throttle == pytest.approx(own.throttle, abs=0.01)
    assert settled.elevator == pytest.approx(own.elevator, abs=0.01)


@pytest.mark.parametrize(("name", "speed"), [("c310", 65.0), ("pc7", 60.0), ("DHC6", 60.0)])
def test_what_jsbsim_s_trim_stops_the_engines_of_stays_where_it_was_put(name: str, speed: float) -> None:
    """Let go with its controls held for 3 s, it keeps airspeed to 0.1 m/s, pitch and bank to 0.2 deg, and its thrust to 1 %.

    A turboprop that a start had set back to idle would have lost half its thrust.
    """
    rig = Rig(wheel(name, "settled"), speed)
    flown = rig.release(3.0)
    assert abs(flown["airspeed"] - speed).max() < 0.1
    assert abs(flown["pitch"] - rig.motion.pitch).max() < 0.2 * DEG
    assert abs(flown["bank"] - rig.motion.bank).max() < 0.2 * DEG
    assert flown["thrust"][0] > 0.0
    assert flown["thrust"] == pytest.approx(flown["thrust"][0], rel=0.01)


def test_a_settled_start_is_the_same_whether_its_trim_was_known_or_not() -> None:
    from testbed.flight.plants.jsbsim_start import _balance

    aircraft = wheel("c310", "settled")
    _balance.cache_clear()
    first, again = (Rig(aircraft, 65.0).release(1.0) for _ in range(2))
    assert all((first[column] == again[column]).all() for column in first)


@pytest.mark.parametrize(
    ("name", "reason"),
    [("C130", "full throttle is too little"), ("X15", "full throttle is too little"), ("p51d", "a closed throttle is too much")],
)
def test_an_engine_that_does_not_answer_is_no_trim(name: str, reason: str) -> None:
    with pytest.raises(TrimFailedError, match=rf"no level trim at 100 m/s, 150 m: {reason}"):
        Rig(wheel(name, "settled"), 100.0)
    assert trim(wheel(name, "settled"), 100.0) is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"wheel": "sgs233"}, "'sgs233' has no engine: gliders are not supported"),
        ({"wheel": "minisgs"}, "'minisgs' has no engine: gliders are not supported"),
        ({"wheel": "SGS"}, "'SGS' has no engine: gliders are not supported"),
        ({"wheel": "L17"}, "'L17' cannot be started in JSBSim: .*flaps-pos-deg"),
        ({"wheel": "Pterosaur"}, "'Pterosaur' cannot be started in JSBSim: .*wing-fold"),
        ({"wheel": "c31"}, "JSBSim's wheel has no aircraft 'c31'; did you mean 'c310'"),
        ({"path": Path("nowhere.xml")}, "nowhere.xml: no such file"),
        ({}, "name the model: --wheel"),
        ({"wheel": "c310", "path": Path("x")}, "name the model: --wheel"),
        ({"wheel": "c310", "speed_mps": math.nan}, "--speed must be a finite number"),
        ({"wheel": "c310", "name": "../c310"}, "is no name for an aircraft"),
    ],
)
def test_what_cannot_be_an_aircraft_is_refused_in_words(arguments: dict[str, object], message: str, tmp_path: Path) -> None:
    given = {"name": "mine", "wheel": None, "path": None, "speed_mps": None, "out": tmp_path / "hangar"} | arguments
    with pytest.raises(NewAircraftError, match=message):
        add_aircraft(**given)  # type: ignore[arg-type]
    assert not (tmp_path / "hangar").exists()


def test_the_load_factor_is_that_of_the_rule() -> None:
    """14 CFR 23.337: 3.8 up to 4,118 lb; 2.1 + 24000 / 30000 = 2.9 at 20,000 lb; 25.337: 2.5 at least."""
    pound = 0.45359237
    assert rule_load_factor(2000.0 * pound) == 3.8
    assert rule_load_factor(20000.0 * pound) == pytest.approx(2.9, abs=1e-3)
    assert rule_load_factor(800000.0 * pound) == 2.5


@pytest.mark.slow
def test_a_model_that_jsbsim_s_trim_fails_on_becomes_an_aircraft_that_flies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One of them; `make aircraft-table` makes and flies every model of the wheel."""
    model = "pa28"
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(PATH_VARIABLE, "")
    with pytest.raises(TrimFailedError):
        Rig(wheel(model, "trimmed"), 60.0)
    report = new_aircraft("mine", wheel_source(model), tmp_path / "hangar", 60.0)
    assert re.search(r"trims in level flight from \d+ to \d+ m/s", report)
    file = tmp_path / "hangar" / "mine" / "aircraft.yaml"
    assert_marked(file.read_text())
    assert PLACEHOLDER in file.read_text()
    limits = read_aircraft(file.parent).limits
    assert limits.stall_mps < limits.alpha_max_1g_mps < 60.0 < limits.speed_max_mps
    add_aircraft_path(file.parent.parent)
    tune("mine", write=True, accept=True)
    assert_marked(file.read_text())
    assert PLACEHOLDER not in file.read_text()
    aircraft = read_aircraft(file.parent)
    assert aircraft.gains_found_by == "testbed tune mine"
    assert aircraft.verified == (not aircraft.missed)
    Path("c.yaml").write_text(
        "name: c\nquestion: q\nspeed_mps: 60\naircraft: mine\nmethod: {kind: none}\nair: {turbulence: {kind: dryden, severity: moderate}}\n"
        "route: {start_enu_m: [0, 0, 0], start_direction_deg: [0, 0], shape: {kind: racetrack, straight_m: 600, radius_m: 500}}\n"
    )
    (plan,) = expand(load_campaign("c.yaml"))
    flown = measure(fly(plan))
    assert flown.outcome == "reached"
    assert flown.cross_track_rms_m < 3.0


def assert_marked(text: str) -> None:
    """Every line with a number says where it is from; the lines of ``missed`` are no numbers of the aircraft."""
    for line in text.partition("\nmissed:")[0].splitlines():
        if re.search(r": *-?\d", line.partition("#")[0]):
            assert MARKED.search(line), line


@pytest.mark.slow
def test_a_model_of_one_s_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its folder is copied, whatever it is called; where the file is already there, the yaml is written beside it."""
    source = tmp_path / "download"
    shutil.copytree(AIRCRAFT_ROOT / "gtm_t2", source, ignore=shutil.ignore_patterns("aircraft.yaml"))
    measured = []
    measure = new._measure
    monkeypatch.setattr(new, "_measure", lambda *asked: measured.append(measure(*asked)) or measured[0])
    add_aircraft("uav", None, source / "gtm_t2.xml", 50.0, tmp_path / "hangar")
    monkeypatch.setattr(new, "_measure", lambda *_: measured[0])  # the same model again
    aircraft = read_aircraft(tmp_path / "hangar" / "uav")
    assert (aircraft.model.files, aircraft.model.name) == ("own", "gtm_t2")
    published = read_aircraft(AIRCRAFT_ROOT / "gtm_t2").limits
    assert aircraft.limits.stall_mps == published.stall_mps
    assert aircraft.command_lag_s == 0.0, "its servos are in the model"
    with pytest.raises(NewAircraftError, match="is there already"):
        add_aircraft("uav", None, source / "gtm_t2.xml", 50.0, tmp_path / "hangar")
    add_aircraft("download", None, source / "gtm_t2.xml", 50.0, tmp_path)
    assert (source / "aircraft.yaml").exists()


@pytest.mark.slow
def test_a_settled_aircraft_climbs_and_turns_from_its_start() -> None:
    """A path that climbs at once, in a bend: the flight begins on it with the power of the climb, within 2 m."""
    from testbed.airframe.proof_courses import random_bends

    aircraft = read_aircraft(AIRCRAFT_ROOT / "c172p")
    settled = aircraft.model_copy(update={"model": aircraft.model.model_copy(update={"start": "settled"})})
    import numpy as np

    path = random_bends(np.random.default_rng(3), 350.0, 3.0 * DEG)
    flights = [follow(one, path, 50.0) for one in (aircraft, settled)]
    assert flights[1].rms_m == pytest.approx(flights[0].rms_m, abs=0.1)
    assert flights[1].most_m < 2.0
