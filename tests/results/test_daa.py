"""Metrics of detect and avoid against closed forms, hand-made records, an independent reading of the standards and NASA's own numbers."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from testbed.campaign.words.daa import Daa, Volume, standards
from testbed.core.units import FT, G0_MPS2, KNOT
from testbed.flight.record import FlightRecord
from testbed.results.columns import Kind
from testbed.results.daa import volumes
from testbed.results.daa.columns import daa_columns, measure_daa, no_daa
from tests import made

NM, FPM = 1852.0, FT / 60.0
NAMES = list(standards())


def state(p: list[float], v: list[float], volume: Volume) -> bool:
    """Is one inside now? By the time inside from now on for an instant that a limit that is outside needs."""
    return bool(volumes.inside(np.array([p], dtype=float), np.array([v], dtype=float), np.array([1e-9]), volume).ever[0])


def by_the_book(p: np.ndarray, v: np.ndarray, volume: Volume) -> tuple[float, bool, float]:
    """(tau_mod, lost, severity) of one state, step by step as the standard says it, in scalars."""
    (x, y, z), (u, w, _) = p.tolist(), v.tolist()
    d, h, threshold = volume.radius_m, float(volume.half_height_m or 0.0), volume.tau_s
    r = math.hypot(x, y)
    rate = (x * u + y * w) / r
    tau = 0.0 if r <= d else (d * d - r * r) / (r * rate) if rate < 0.0 else math.inf
    nearest = max(0.0, -(x * u + y * w) / (u * u + w * w))
    miss = math.hypot(x + nearest * u, y + nearest * w)
    below = (lambda a, b: a <= b) if volume.edge == "in" else (lambda a, b: a < b)
    lost = (below(r, d) or (threshold > 0.0 and miss <= d and tau <= threshold)) and below(abs(z), h)
    begins = max(d, 0.5 * (math.sqrt((rate * threshold) ** 2 + 4.0 * d * d) - rate * threshold))
    pen = [min(r / begins, 1.0), min(miss / d, 1.0), min(abs(z) / h, 1.0)]
    first = math.sqrt(pen[0] ** 2 + (1.0 - pen[0] ** 2) * pen[1] ** 2)
    return tau, lost, 1.0 - math.sqrt(first**2 + (1.0 - first**2) * pen[2] ** 2)


def test_ten_thousand_random_states_are_what_the_standards_say() -> None:
    rng = np.random.default_rng(11)
    n = 10_000
    unit = rng.uniform(-1, 1, (n, 3))
    v = rng.uniform(-1, 1, (n, 3)) * [120.0, 120.0, 10.0]
    for name, volume in standards().items():
        p = unit * [3.0 * volume.radius_m, 3.0 * volume.radius_m, 1.5 * volume.half_height_m]
        told = [by_the_book(*one, volume) for one in zip(p, v, strict=True)]
        tau, lost, severity = (np.array(column) for column in zip(*told, strict=True))
        found = volumes.inside(p, v, np.full(n, 1e-9), volume).ever
        assert np.array_equal(found, lost), name
        assert 200 < lost.sum() < 9_800, name  # both are tried
        finite = np.isfinite(tau)
        ours = volumes.tau_mod(p[:, :2], v[:, :2], volume.radius_m)
        assert np.array_equal(np.isfinite(ours), finite)
        assert ours[finite] == pytest.approx(tau[finite], rel=1e-9, abs=1e-9)
        assert volumes.severity(p, v, volume) == pytest.approx(severity, abs=1e-9)
        assert np.array_equal(severity > 0.0, lost), name


def test_times_inside_are_those_of_dense_sampling() -> None:
    rng = np.random.default_rng(12)
    p, v = rng.uniform(-1, 1, (40, 3)) * [5000, 5000, 300], rng.uniform(-1, 1, (40, 3)) * [150, 150, 12]
    t = np.linspace(0.0, 60.0, 20_001)
    sphere = Volume(shape="sphere", radius_m=800.0)
    for volume in (standards()["do365_phase_1"], standards()["astm_f3442"], sphere):
        found = volumes.inside(p, v, np.full(40, 60.0), volume)
        for k in range(40):
            path = p[k] + t[:, None] * v[k]
            if volume.shape == "sphere":
                inside = np.linalg.norm(path, axis=1) < volume.radius_m
            else:
                inside = np.array([by_the_book(place, v[k], volume)[1] for place in path[::80]])
            step = t[1] if volume.shape == "sphere" else t[80]
            assert (found.last_s[k] - found.first_s[k] if found.ever[k] else 0.0) == pytest.approx(inside.sum() * step, abs=2.0 * step)


def test_the_examples_of_nasas_accord_library_come_out() -> None:
    """CDSSCoreTest.cpp, S003 and S047, WCV_TAUMOD: times in and out to its two decimals. Its default radius is 0.66 nmi."""

    def course(track_deg: float, knots: float) -> np.ndarray:
        return knots * KNOT * np.array([math.sin(math.radians(track_deg)), math.cos(math.radians(track_deg)), 0.0])

    volume = Volume(radius_m=0.66 * NM, half_height_m=450 * FT, tau_s=35.0, edge="in")
    p = np.array([[-23.66 * NM, -6.33 * NM, 0.0], [-0.1 * NM, -0.63 * NM, -200 * FT]])
    v = np.array([[518.99 * KNOT, 147.41 * KNOT, -10 * FPM], course(152.400803, 479) - course(182.368530, 489)])
    found = volumes.inside(p, v, np.full(2, 300.0), volume)
    assert found.first_s == pytest.approx([128.04, 0.0], abs=0.01)
    assert found.last_s == pytest.approx([167.02, 8.14], abs=0.01)


@pytest.mark.parametrize(
    ("name", "p", "v", "lost"),
    [
        ("do365_phase_1", [-3000.0, 1219.2, 0.0], [300.0, 0.0, 0.0], True),  # would pass at DMOD exactly
        ("do365_phase_1", [-3000.0, 1219.2 + 1e-9, 0.0], [300.0, 0.0, 0.0], False),
        ("do365_phase_1", [1219.2, 0.0, 137.16], [0.0, 0.0, 0.0], True),  # at DMOD and h* exactly, hanging there
        ("do365_phase_1", [1219.2, 0.0, 137.16 + 1e-9], [0.0, 0.0, 0.0], False),
        ("do365_phase_1", [1300.0, 0.0, 0.0], [1.0, 0.0, 0.0], False),  # outside and opening
        ("do365_non_cooperative", [670.56, 0.0, 0.0], [10.0, 0.0, 0.0], True),
        ("do365_terminal", [0.0, 457.2, -137.16], [0.0, 0.0, 0.0], True),
        ("astm_f3442", [609.6, 0.0, 0.0], [0.0, 0.0, 0.0], False),  # less than, not at
        ("astm_f3442", [609.6 - 1e-9, 0.0, 0.0], [0.0, 0.0, 0.0], True),
        ("astm_f3442", [-50.0, 609.6, 0.0], [100.0, 0.0, 0.0], False),  # grazes
        ("nmac", [0.0, 0.0, 30.48], [100.0, 0.0, 0.0], False),  # along the lid
        ("nmac", [0.0, 0.0, 30.48 - 1e-9], [100.0, 0.0, 0.0], True),
        ("nmac", [152.4, 0.0, 0.0], [0.0, 50.0, 0.0], False),
    ],
)
def test_states_on_a_limit(name: str, p: list[float], v: list[float], lost: bool) -> None:
    assert state(p, v, standards()[name]) is lost


def test_tau_on_its_threshold_is_in() -> None:
    """Straight in at 50 m/s: tau_mod is 35 s where r^2 - 35 * 50 r - DMOD^2 = 0."""
    d = 4000 * FT
    r = 0.5 * (35 * 50 + math.sqrt((35 * 50) ** 2 + 4 * d * d))
    assert float(volumes.tau_mod(np.array([r, 0.0]), np.array([-50.0, 0.0]), d)) == pytest.approx(35.0, abs=1e-9)
    volume = standards()["do365_phase_1"]
    assert state([r - 1e-6, 0.0, 0.0], [-50.0, 0.0, 0.0], volume)
    assert not state([r + 1e-6, 0.0, 0.0], [-50.0, 0.0, 0.0], volume)


def crossing(**changes: Any) -> FlightRecord:
    """East at 50 m/s; the obstacle comes west at 40 m/s, 12 m to the left and 5 m above: nearest after 4.001 s, between two ticks."""
    record = made.record(method={"kind": "scoam"}, **changes)
    t = record.columns["time_s"]
    zero = np.zeros_like(t)
    own = np.column_stack([50.0 * t, zero, zero])
    other = np.column_stack([90.0 * 4.001 - 40.0 * t, zero + 12.0, zero + 5.0])
    return replace(record, columns=record.columns | {"own.pos_enu_m": own, "obstacle.O.pos_enu_m": other})


DAA = Daa(volumes={"tube": Volume(radius_m=20.0, half_height_m=6.0), "ball": Volume(shape="sphere", radius_m=15.0)})


def test_a_straight_crossing_measures_what_a_pencil_does() -> None:
    found = measure_daa(crossing(), DAA)
    exact = pytest.approx
    assert found["slant_miss_m"] == exact(13.0, abs=1e-9)
    assert (found["horizontal_miss_m"], found["vertical_miss_m"], found["miss_time_s"]) == exact((12.0, 5.0, 4.001), abs=1e-9)
    assert found["entered_tube"]
    assert found["entered_ball"]
    assert found["time_in_tube_s"] == exact(2 * 16.0 / 90.0, abs=1e-9)
    assert found["time_in_ball_s"] == exact(2 * math.sqrt(15.0**2 - 13.0**2) / 90.0, abs=1e-9)
    assert found["severity_ball"] == exact(2.0 / 15.0, abs=1e-9)
    horizontal = math.sqrt(2 * 0.6**2 - 0.6**4)  # range and projected miss are both 12 of 20 m
    assert found["severity_tube"] == exact(1.0 - math.sqrt(horizontal**2 + (1 - horizontal**2) * (5 / 6) ** 2), abs=1e-9)
    assert found["entered_nmac"]
    assert found["time_in_nmac_s"] == exact(2 * math.sqrt(152.4**2 - 12.0**2) / 90.0, abs=1e-9)
    assert found["least_tau_mod_s"] == 0.0
    assert found["alert_lead_s"] == found["manoeuvre_lead_s"] == exact(4.001 - made.TRIGGER_S, abs=1e-9)
    assert found["manoeuvre_time_s"] == made.TRIGGER_S


def test_modified_tau_of_a_record_is_that_at_its_ticks() -> None:
    d = 100.0
    t = crossing().columns["time_s"]
    x = 90.0 * 4.001 - 90.0 * t
    far = replace(crossing(), columns=crossing().columns | {"obstacle.O.pos_enu_m": np.column_stack([50.0 * t + x, 0 * t + 150.0, 0 * t])})
    closing = x > 1e-6
    tau = (x[closing] ** 2 + 150.0**2 - d * d) / (90.0 * x[closing])
    assert measure_daa(far, Daa(dmod_m=d))["least_tau_mod_s"] == pytest.approx(tau.min(), abs=1e-9)


def test_what_a_manoeuvre_cost_and_whether_it_was_needed() -> None:
    """The arc of the made record, flown 7 m above its route and 2 m/s faster; its obstacle moved onto the route, or far from it."""
    record = made.record()
    arc, t = record.columns["own.pos_enu_m"], record.columns["time_s"]
    on_route = np.tile(arc[300], (len(t), 1))
    columns = record.columns | {
        "own.pos_enu_m": arc + np.array([0.0, 0.0, 7.0]),
        "own.airspeed_mps": np.full(len(t), 52.0),
    }
    near, far = (
        measure_daa(replace(record, columns=columns | {"obstacle.O.pos_enu_m": pos}), DAA)
        for pos in (on_route, on_route + np.array([0, 0, 900]))
    )
    assert near["height_change_m"] == pytest.approx(7.0, abs=1e-6)
    assert near["energy_change_m"] == pytest.approx(7.0 + (52.0**2 - 50.0**2) / (2 * G0_MPS2), abs=1e-6)
    assert (near["manoeuvre_needed"], near["false_manoeuvre"], near["missed_manoeuvre"]) == (True, False, False)
    assert (far["manoeuvre_needed"], far["false_manoeuvre"], far["missed_manoeuvre"]) == (False, True, False)
    idle = measure_daa(replace(record, events=(), columns=columns | {"obstacle.O.pos_enu_m": on_route}), DAA)
    assert (idle["manoeuvre_needed"], idle["false_manoeuvre"], idle["missed_manoeuvre"]) == (True, False, True)
    assert math.isnan(idle["height_change_m"])


def test_extra_length_and_time_count_to_the_goals_plane() -> None:
    """A straight route of 400 m in 8 s, flown along two sides of a flat triangle at the same speed."""
    from testbed import fly
    from tests.plans import KINEMATIC, plan

    route = {"start_enu_m": [0, 0, 0], "goal_enu_m": [400, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
    record = fly(plan(route=route, **KINEMATIC))
    t = np.arange(len(record.columns["time_s"]) + 30) / 120.0
    along = 50.0 * t * (200.0 / math.hypot(200.0, 30.0))
    pos = np.column_stack([along, np.where(along < 200.0, 0.15 * along, 60.0 - 0.15 * along), 0 * t])
    columns = {name: np.resize(one, (len(t), *one.shape[1:])) for name, one in record.columns.items()} | {"own.pos_enu_m": pos, "time_s": t}
    columns["guidance.s_m"] = along
    longer = 2 * math.hypot(200.0, 30.0)
    short = int(np.flatnonzero(along > 400.0)[0]) + 1
    cut = replace(record, columns={name: one[:short] for name, one in columns.items()})
    found = measure_daa(cut, Daa())
    assert found["extra_time_s"] == pytest.approx(longer / 50.0 - 8.0, abs=1e-9)
    assert found["extra_length_m"] == pytest.approx(longer - 400.0, abs=0.02)  # the corner between two ticks is cut


def test_reversals_are_turns_to_the_other_side() -> None:
    record = crossing()
    (event,) = record.events

    def commanded(*angles: tuple[float, float]) -> int:
        events = tuple(
            replace(
                event, own_vel_enu_mps=(50.0, 0.0, 0.0),
                command_enu_mps=(
                    50 * math.cos(math.radians(left)) * math.cos(math.radians(up)),
                    50 * math.sin(math.radians(left)) * math.cos(math.radians(up)),
                    50 * math.sin(math.radians(up)),
                ),
            )
            for left, up in angles
        )  # fmt: skip
        return int(measure_daa(replace(record, events=events), DAA)["reversals"])

    assert commanded((20, 0), (15, 0), (25, 0)) == 0
    assert commanded((20, 0), (0.5, 0), (-20, 0)) == 1  # half a degree has no side
    assert commanded((20, 5), (-20, -5)) == 2
    assert commanded((20, 0), (-20, 0), (20, 0)) == 2


def test_the_limits_stand_in_the_definitions_and_every_column_is_measured() -> None:
    columns = daa_columns(DAA)
    assert not daa_columns(None)
    assert len({column.name for column in columns}) == len(columns) == 16 + 3 * (len(NAMES) + 2)
    told = {column.name: column.definition for column in columns}
    assert "horizontal <= 1219.2 m (4000 ft), vertical <= 137.16 m (450 ft), modified tau <= 35 s" in told["entered_do365_phase_1"]
    assert "range < 15 m" in told["entered_ball"]
    found, none = measure_daa(crossing(), DAA), no_daa(DAA)
    assert list(found) == [column.name for column in columns] == list(none)
    kinds = {Kind.FLAG: bool, Kind.NUMBER: float, Kind.WHOLE: int}
    assert all(found[column.name] is None or type(found[column.name]) is kinds[column.kind] for column in columns)
    alone = measure_daa(made.record(obstacles=[]), DAA)
    assert alone["entered_nmac"] is None
    assert math.isnan(alone["slant_miss_m"])


def test_a_campaign_may_set_the_limits_of_a_standard() -> None:
    daa = Daa(standards=("nmac",), volumes={"nmac": Volume(radius_m=100.0, half_height_m=20.0)})
    assert list(daa.all_volumes) == ["nmac"]
    assert "horizontal < 100 m, vertical < 20 m" in daa_columns(daa)[-3].definition
