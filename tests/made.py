"""A flight in closed form: a level circular arc at constant speed past one obstacle, with one decision in it."""

import math
import shutil
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from testbed.campaign.words.settings import FlightPlan
from testbed.core.chain import Chain
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.record import FlightRecord, Outcome, PlannedPath, ReplanEvent, kept_clear
from testbed.results.columns import FlightMetrics
from vosc import ph

CHROMIUM = shutil.which("chromium")
SPEED_MPS, RADIUS_M, HZ = 50.0, 400.0, 120
TURN_RADPS = SPEED_MPS / RADIUS_M
BANK_RAD = math.atan(SPEED_MPS**2 / (RADIUS_M * G0_MPS2))
TRIGGER_S, INSERTION_S = 3.0, 1.75
OBSTACLE = {"name": "O", "radius_m": 25.0, "position_enu_m": [236.0, 110.0, 8.0], "speed_mps": 30.0, "direction_deg": [250.0, -4.0]}


def plan(**changes: object) -> FlightPlan:
    settings: dict[str, object] = {
        "flight_id": "f0123456789a",
        "campaign": "closed-form",
        "cell": "reading=one, method.kind=scoam",
        "labels": {"reading": "one", "method.kind": "scoam"},
        "replicate": 0,
        "seed": 7,
        "route": {
            "start_enu_m": [0, 0, 0],
            "goal_enu_m": [388.8, 306.0, 0],
            "start_direction_deg": [0, 0],
            "goal_direction_deg": [76.3, 0],
        },
        "obstacles": [OBSTACLE | {"when": {"time_s": 5.0}}],
        "method": {"kind": "scoam"},
        "plant": {"kind": "kinematic"},
    }
    return FlightPlan.model_validate(settings | changes)


def _arc(time_s: np.ndarray) -> dict[str, np.ndarray]:
    """Counter-clockwise circle through the origin, heading east at time 0."""
    angle = TURN_RADPS * time_s
    zero = np.zeros_like(time_s)
    pos = np.column_stack([RADIUS_M * np.sin(angle), RADIUS_M * (1 - np.cos(angle)), zero])
    vel = SPEED_MPS * np.column_stack([np.cos(angle), np.sin(angle), zero])
    roll = -BANK_RAD  # left wing down; body x forward, y right, z down, so ENU from body starts as a half turn about east
    quat = np.column_stack([  # (rotation about up by ``angle``) * (rotation about east by 180 deg + roll), as x, y, z, w
        np.cos(angle / 2) * math.sin((math.pi + roll) / 2), np.sin(angle / 2) * math.sin((math.pi + roll) / 2),
        np.sin(angle / 2) * math.cos((math.pi + roll) / 2), np.cos(angle / 2) * math.cos((math.pi + roll) / 2),
    ])  # fmt: skip
    return {"own.pos_enu_m": pos, "own.vel_enu_mps": vel, "own.quat_enu_from_body_xyzw": quat}


def record(duration_s: float = 8.0, **changes: object) -> FlightRecord:
    """``changes`` go into the plan. A kinematic plan has no controls, so its control columns are NaN."""
    flight = plan(**changes)
    time_s = np.arange(round(duration_s * HZ) + 1) / HZ
    n, unknown = len(time_s), np.full(len(time_s), math.nan)
    flown = flight.plant.kind != "kinematic"
    columns = {"time_s": time_s} | _arc(time_s)
    columns |= {
        "own.bank_rad": np.full(n, BANK_RAD),
        "own.pitch_rad": np.zeros(n),
        "own.heading_rad": math.pi / 2 - TURN_RADPS * time_s,
        "own.load_factor": np.full(n, 1 / math.cos(BANK_RAD)) + (0.05 * np.sin(3 * time_s) if flown else 0.0),
        "own.airspeed_mps": np.full(n, SPEED_MPS) - (0.2 * time_s if flown else 0.0),
        "own.alpha_rad": 0.05 + 0.01 * np.sin(time_s) if flown else unknown,
        "own.beta_rad": np.zeros(n),
        "own.rates_body_radps": np.zeros((n, 3)),
        "air.wind_enu_mps": np.zeros((n, 3)),
        **{f"own.{name}": (0.5 + 0.1 * np.sin(time_s) if flown else unknown) for name in ("throttle", "elevator", "aileron", "rudder")},
        "guidance.s_m": SPEED_MPS * time_s,
        "guidance.bank_cmd_rad": np.full(n, BANK_RAD) + 0.02,
        "guidance.load_factor_cmd": np.full(n, 1 / math.cos(BANK_RAD)),
        "guidance.saturated": np.zeros(n),
        "path.index": (time_s >= TRIGGER_S).astype(float) * bool(flight.obstacles),
        "path.leg": (time_s >= TRIGGER_S + INSERTION_S).astype(float) * bool(flight.obstacles),
        "path.cross_track_m": np.abs(0.3 * np.sin(time_s)),
    }
    events: tuple[ReplanEvent, ...] = ()
    if flight.obstacles:
        spec = flight.obstacles[0]
        azimuth, elevation = (angle * DEG for angle in spec.direction_deg)
        speed = (
            np.array([math.cos(azimuth) * math.cos(elevation), math.sin(azimuth) * math.cos(elevation), math.sin(elevation)])
            * spec.speed_mps
        )
        pos = np.array(spec.position_enu_m) + (time_s - 5.0)[:, None] * speed
        columns[f"obstacle.{spec.name}.pos_enu_m"] = pos
        columns[f"obstacle.{spec.name}.vel_enu_mps"] = np.tile(speed, (n, 1))
        columns[f"obstacle.{spec.name}.clearance_m"] = np.linalg.norm(pos - columns["own.pos_enu_m"], axis=1) - spec.radius_m
        events = (_event(columns, speed),)
    return FlightRecord(flight, Outcome.REACHED, columns, events, _paths(columns, bool(events)))


def _at(columns: dict[str, np.ndarray], name: str, time_s: float) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in columns[name][round(time_s * HZ)])
    return x, y, z


def _event(columns: dict[str, np.ndarray], obstacle_vel: np.ndarray) -> ReplanEvent:
    return ReplanEvent(
        time_s=TRIGGER_S, obstacle="O", decision="replanned", method="scoam", status="avoided",
        own_pos_enu_m=_at(columns, "own.pos_enu_m", TRIGGER_S), own_vel_enu_mps=_at(columns, "own.vel_enu_mps", TRIGGER_S),
        obstacle_pos_enu_m=_at(columns, "obstacle.O.pos_enu_m", TRIGGER_S), obstacle_vel_enu_mps=tuple(float(v) for v in obstacle_vel),
        radius_m=25.0, alpha_rad=6.24 * DEG, alpha0_rad=14.57 * DEG, time_to_cpa_s=1.31, miss_m=10.8, route_miss_m=7.2,
        cap_radius_mps=46.1, cap_azimuth_rad=0.3, cap_elevation_rad=0.1, cap_half_angle_rad=22.75 * DEG,
        command_enu_mps=_at(columns, "own.vel_enu_mps", TRIGGER_S + INSERTION_S), deflection_rad=12.31 * DEG, margin_rad=0.0,
        insertion_enu_m=_at(columns, "own.pos_enu_m", TRIGGER_S + INSERTION_S), insertion_time_s=INSERTION_S,
        max_curvature_to_insertion_1pm=1 / 103.0, max_curvature_to_goal_1pm=1 / 400.0, planned_length_m=350.0,
    )  # fmt: skip


def _paths(columns: dict[str, np.ndarray], replanned: bool) -> tuple[PlannedPath, ...]:
    def piece(start_s: float, end_s: float) -> ph.Curve:
        ends = [np.array(_at(columns, "own.pos_enu_m", t)) for t in (start_s, end_s)]
        chord = float(np.linalg.norm(ends[1] - ends[0])) / SPEED_MPS
        slopes = [np.array(_at(columns, "own.vel_enu_mps", t)) * chord for t in (start_s, end_s)]
        return ph.hermite(ends[0], slopes[0], ends[1], slopes[1])

    end_s = float(columns["time_s"][-1])
    original = PlannedPath(0.0, Chain((piece(0.0, end_s),)))
    if not replanned:
        return (original,)
    middle_s = TRIGGER_S + INSERTION_S
    return original, PlannedPath(TRIGGER_S, Chain((piece(TRIGGER_S, middle_s), piece(middle_s, end_s))))


def metrics(flight: FlightRecord) -> FlightMetrics:
    """The row of a synthetic flight, straight from its columns."""
    columns = flight.columns
    name = flight.plan.obstacles[0].name if flight.plan.obstacles else ""
    clearance = columns[f"obstacle.{name}.clearance_m"] if name else np.full(1, math.nan)
    at = int(np.argmin(clearance))
    airspeed, load = columns["own.airspeed_mps"], columns["own.load_factor"]
    last_s = float(columns["time_s"][-1])
    return FlightMetrics(
        outcome=flight.outcome.value, least_clearance_m=float(clearance[at]),
        time_at_least_clearance_s=float(columns["time_s"][at]) if name else math.nan, nearest_obstacle=name,
        replans=len(flight.events), trigger_time_s=TRIGGER_S, deflection_deg=12.31, path_length_m=SPEED_MPS * last_s,
        flight_time_s=last_s, cross_track_rms_m=0.21, cross_track_max_m=0.3, schedule_error_s=0.0, max_bank_deg=BANK_RAD / DEG,
        max_load_factor=float(load.max()), min_load_factor=float(load.min()), max_roll_rate_dps=0.0,
        min_airspeed_mps=float(airspeed.min()), max_airspeed_mps=float(airspeed.max()), max_alpha_deg=math.nan,
        planned_length_m=402.5, planned_min_radius_m=103.0, planned_clearance_m=6.1, saturated_share=0.0, begin_s_m=0.0, limits_hit="",
        airspeed_rms_error_mps=0.2, wind_along_std_mps=0.0, schedule_part_m=0.1, cross_track_part_m=-0.2, route_miss_m=7.2,
        deflection_ground_deg=12.31, flown_deflection_deg=12.2, flown_deflection_air_deg=12.2, peak_deflection_deg=23.6,
        peak_deflection_air_deg=23.6, avoidance_time_s=1.8, insertion_miss_m=0.2, clear_time_s=2.1, rejoin_time_s=6.4,
        rejoin_length_m=321.0, kept_clear=kept_clear(float(clearance[at])), encounter_radius_m=25.0, encounter_speed_mps=30.0,
        encounter_closing_mps=64.0, encounter_miss_m=10.8, encounter_crossing_deg=132.0,
    )  # fmt: skip


@pytest.fixture
def make_record() -> Callable[..., FlightRecord]:
    return record


@pytest.fixture
def make_metrics() -> Callable[[FlightRecord], FlightMetrics]:
    return metrics


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Chromium, or a skip."""
    if CHROMIUM is None:
        pytest.skip("no chromium (Debian: chromium)")
    from playwright.sync_api import sync_playwright

    flags = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking"]
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
        yield opened
        opened.close()
