"""``--set a.b=value``: what it changes, and what it says when it cannot."""

from collections.abc import Callable

import pytest

from testbed.campaign import Campaign, expand, load_campaign

Write = Callable[[str], str]


@pytest.mark.parametrize(
    ("override", "read", "value"),
    [
        ("speed_mps=45", lambda c: c.speed_mps, 45.0),
        (" speed_hold = groundspeed ", lambda c: c.speed_hold, "groundspeed"),
        ("obstacles.O.radius_m=30", lambda c: c.obstacles[0].radius_m, 30.0),
        ("obstacles.O.when={own_reaches_enu_m: [1, 2, 3]}", lambda c: c.obstacles[0].when.own_reaches_enu_m, (1.0, 2.0, 3.0)),
        (
            "obstacles.O={radius_m: 1, position_enu_m: [0, 0, 0], speed_mps: 0, direction_deg: [0, 0]}",
            lambda c: c.obstacles[0].radius_m,
            1.0,
        ),
        ("obstacles=[]", lambda c: c.obstacles, ()),
        ("begin={at_route_s_m: 9}", lambda c: c.begin.at_route_s_m, 9.0),
        ("air.wind={kind: calm}", lambda c: c.air.wind.kind, "calm"),
        ("air.wind.speed_mps=7", lambda c: (c.air.wind.speed_mps, c.air.wind.from_deg), (7.0, 270.0)),
        ("replan={k: 3}", lambda c: c.replan.k, 3.0),
        ("replan.k=2", lambda c: c.replan.k, 2.0),  # a section that the file does not have
        ("seed=8", lambda c: c.seed, 8),
        ("name=other", lambda c: c.name, "other"),
        ("question='a=b'", lambda c: c.question, "a=b"),
        ("sweep={}", lambda c: len(expand(c)), 2),
        ("sweep.method.kind=[none]", lambda c: len(expand(c)), 4),
        ("sweep.sensor.range_m=[50, 100, 200]", lambda c: len(expand(c)), 24),
    ],
)
def test_an_override_changes_one_thing(write: Write, good: str, override: str, read: Callable[[Campaign], object], value: object) -> None:
    path = write(good)
    assert read(load_campaign(path)) != value
    assert read(load_campaign(path, [override])) == value


def test_the_last_of_two_overrides_wins(write: Write, good: str) -> None:
    assert load_campaign(write(good), ["sensor.range_m=60", "sensor.range_m=70"]).sensor.range_m == 70


def test_an_override_can_repair_a_file(write: Write, good: str) -> None:
    assert load_campaign(write(good.replace("speed_mps: 50", "speed_mps: x")), ["speed_hold=groundspeed", "speed_mps=50"]).speed_mps == 50


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("plant.kind=foo", "--set plant.kind=foo: no plant 'foo'; there are: kinematic, point_mass, jsbsim"),
        (
            "plant.kind=kinematik",
            "--set plant.kind=kinematik: no plant 'kinematik'; there are: kinematic, point_mass, jsbsim (did you mean 'kinematic'?)",
        ),
        ("plnat.kind=jsbsim", "--set plnat.kind=jsbsim: unknown setting 'plnat.kind' (did you mean 'plant.kind'?)"),
        ("seed=-1", "--set seed=-1: must be at least 0, not -1"),
        (
            "replan={kay: 1}",
            "--set replan={kay: 1}: replan.kay: unknown key 'kay' (known here: policy, again, answer, rejoin, k, time_rule, insertion_side,"
            " arrival_root, path, search, swell_m, horizon_s, magnitude_chords, vo_frame, wind_known, wind_estimate_sigma_mps)",
        ),
        ("obstacles.P.speed_mps=30", "--set obstacles.P.speed_mps=30: there is no obstacle 'P' (there are: O)"),
        ("obstacles.O.speed_mps=-3", "--set obstacles.O.speed_mps=-3: must be at least 0 m/s, not -3 m/s"),
        ("obstacles.O.name=a b", "--set obstacles.O.name=a b: must be letters, digits, '_' and '-' only, not the text 'a b'"),
        (
            "obstacles.O.when.own_reaches_enu_m=[1, 2, 3]",
            "--set obstacles.O.when.own_reaches_enu_m=[1, 2, 3]: obstacles.O.when: give exactly one of time_s and own_reaches_enu_m",
        ),
        ("speed_mps", "--set speed_mps: expected KEY=VALUE, for example method.kind=none"),
        ("=3", "--set =3: expected KEY=VALUE, for example method.kind=none"),
        ("speed_hold=[1", "--set speed_hold=[1: this '[' is not closed"),
        ("question={a: 1, a: 2}", "--set question={a: 1, a: 2}: the key 'a' is there twice"),
        ("begin=", "--set begin=: must be a section (keys and values), not empty"),
        (
            "sweep.plnt.kind=[jsbsim]",
            "--set sweep.plnt.kind=[jsbsim]: sweep.plnt.kind: unknown setting 'plnt.kind' (did you mean 'plant.kind'?)",
        ),
        ("sweep.rates.plant_hz=[1]", "--set sweep.rates.plant_hz=[1]: sweep.rates.plant_hz[0]: must be at least 60 Hz, not 1 Hz"),
        (
            "method.kind=none",
            "--set method.kind=none: has no effect: the sweep's axis 'method.kind' sets it for every flight"
            " (set sweep.method.kind instead)",
        ),
    ],
)
def test_a_bad_override_is_named_as_it_was_typed(complaint: Callable[..., str], good: str, override: str, message: str) -> None:
    assert complaint(good, override).split("\n")[0] == message


def test_a_fault_of_the_file_keeps_its_place_beside_overrides(complaint: Callable[..., str], good: str) -> None:
    assert complaint(good.replace("radius_m: 25", "radius_m: 0"), "obstacles.O.speed_mps=30").startswith(
        "bad.yaml:13:15: obstacles.O.radius_m"
    )


def test_a_speed_that_the_aircraft_does_not_hold_is_named_as_it_was_typed(complaint: Callable[..., str], good: str) -> None:
    told = complaint(good, "speed_mps=900").split("\n")[0]
    assert told.startswith("--set speed_mps=900: speed_mps: gtm_t2 holds ")
    assert "not 900 m/s" in told
