"""Campaigns that may be flown: a plain one with a few settings drawn from all that the vocabulary has, the absurd included."""

import math
import random
from collections.abc import Callable
from typing import Any

from testbed.campaign.words.settings import Campaign
from vosc.methods import METHODS

Draw = Callable[[random.Random], Any]


def _of(*values: Any) -> Draw:
    return lambda rng: rng.choice(values)


def _number(low: float, high: float, *odd: float) -> Draw:
    """Mostly a number of the range, evenly in its logarithm; sometimes an odd one."""

    def draw(rng: random.Random) -> float:
        if odd and rng.random() < 0.25:
            return rng.choice(odd)
        return float(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.4g}")

    return draw


def _point(size_m: float) -> Draw:
    return lambda rng: [round(rng.uniform(-1.0, 1.0) * rng.choice([0.0, 0.1, 1.0]) * size_m, 2) for _ in range(3)]


def _direction(rng: random.Random) -> list[float]:
    return [
        rng.choice([0.0, 90.0, 180.0, -90.0, 360.0, round(rng.uniform(-180, 180), 2)]),
        rng.choice([0.0, 0.0, 90.0, -90.0, round(rng.uniform(-89, 89), 2)]),
    ]


def _gently(rng: random.Random) -> list[float]:
    return [round(rng.uniform(-180, 180), 2), round(rng.uniform(-20, 20), 2)]


def _route(rng: random.Random) -> dict[str, Any]:
    start = _point(rng.choice([0.0, 100.0, 1e4]))(rng)
    end = rng.choice([300.0, 600.0, 600.0, 2000.0, 5.0, 1e-3, 2e4])
    direction = rng.choice([_direction, _gently])
    route: dict[str, Any] = {"start_enu_m": start, "start_direction_deg": direction(rng)}
    if rng.random() < 0.65:
        route |= {"goal_enu_m": _point(end)(rng), "goal_direction_deg": direction(rng)}
        if rng.random() < 0.4:
            route["magnitude_chords"] = _number(0.01, 3, 1.0, 1e-9)(rng)
        return route
    return route | {"shape": rng.choice(SHAPES)(rng)}


SHAPES: list[Draw] = [
    lambda rng: {
        "kind": "circle",
        "radius_m": _number(5, 2000, 0.01, 1e5)(rng),
        "turns": _number(0.01, 2, 5)(rng),
        "side": rng.choice(["left", "right"]),
    },
    lambda rng: {
        "kind": "racetrack",
        "straight_m": _number(1, 1000, 1e-6)(rng),
        "radius_m": _number(20, 500, 0.1)(rng),
        "laps": rng.choice([1, 1, 2]),
    },
    lambda rng: {
        "kind": "swerve",
        "heading_deg": _number(0.1, 60, 1e-6)(rng),
        "swing_m": _number(5, 400, 0.01)(rng),
        "swings": rng.choice([1, 2, 5, 20]),
    },
    lambda rng: {
        "kind": "random",
        "least_radius_m": sorted([_number(10, 500)(rng), _number(10, 500)(rng)]),
        "climb_at_most_deg": _number(0.1, 60, 0)(rng),
    },
]


def _obstacle(name: str) -> Draw:
    def draw(rng: random.Random) -> dict[str, Any]:
        spec = {
            "name": name,
            "radius_m": _number(0.5, 100, 1e-6, 1e4, 25)(rng),
            "position_enu_m": rng.choice([_point(600), lambda _: [254, 63.6, 60.7], lambda _: [0, 0, 0]])(rng),
            "speed_mps": _number(1, 300, 0, 1e-9, 50)(rng),
            "direction_deg": _direction(rng),
        }
        when: Draw = rng.choice(
            [_of(None), lambda r: {"time_s": _number(0.1, 20, 0, -5, 1e4)(r)}, lambda r: {"own_reaches_enu_m": _point(500)(r)}]
        )
        return spec | ({"when": found} if (found := when(rng)) else {})

    return draw


def _wind(rng: random.Random) -> dict[str, Any]:
    kind = rng.choice(["calm", "steady", "steady", "power_law", "logarithmic"])
    if kind == "calm":
        return {"kind": kind}
    wind = {"kind": kind, "speed_mps": _number(0.1, 40, 0)(rng), "from_deg": round(rng.uniform(-360, 360), 1)}
    if kind == "power_law":
        wind |= {"exponent": _number(0.01, 1, 0)(rng), "reference_height_m": _number(1, 500)(rng)}
    elif kind == "logarithmic":
        wind |= {"roughness_m": _number(0.001, 1)(rng), "reference_height_m": _number(2, 500)(rng)}
    return wind


def _gust(rng: random.Random) -> dict[str, Any]:
    gust = {"kind": rng.choice(["step", "one_minus_cosine"]), "amplitude_mps": _number(0.1, 40, 0)(rng), "direction_deg": _direction(rng)}
    gust |= {"frame": rng.choice(["track", "enu"]), rng.choice(["at_time_s", "at_route_s_m"]): _number(0.1, 50, 0, 1e6)(rng)}
    if gust["kind"] == "one_minus_cosine":
        gust |= {"rise_m": _number(0.1, 300, 1e-6)(rng), "hold_m": rng.choice([0, None, 30])}
    return gust


def _rates(rng: random.Random) -> dict[str, int]:
    plant = rng.choice([60, 120, 120, 240, 480, 960])
    guidance = rng.choice([hz for hz in (10, 20, 30, 60, 120, 240) if plant % hz == 0])
    return {
        "plant_hz": plant,
        "guidance_hz": guidance,
        "planner_hz": rng.choice([hz for hz in (1, 2, 5, 10, 20, 60) if guidance % hz == 0]),
    }


def _method(rng: random.Random) -> dict[str, Any]:
    kind = rng.choice([*METHODS])
    options = {"planes": {"count": rng.choice([1, 2, 8])}, "scoam": {"consider": rng.choice(["all", "threats"])}}.get(kind)
    return {"kind": kind} | ({"options": options} if options and rng.random() < 0.3 else {})


SETTINGS: dict[str, Draw] = {
    "speed_mps": _number(1, 300, 50, 30, 90, 1000, 0.01),
    "speed_hold": _of("groundspeed"),
    "route": _route,
    "geometry": _of("level"),
    "terrain_z_m": _number(1, 1e4, 0, -1, -10, -1e4, -1e6),
    "begin": lambda rng: rng.choice(
        [{"at_route_s_m": _number(0.1, 600, 0, 1e6)(rng)}, {"climb_at_most_deg": rng.choice([0, 18, -89, 89])}]
    ),
    "obstacles": lambda rng: [_obstacle(f"O{n}")(rng) for n in range(rng.choice([0, 1, 1, 2, 5, 12]))],
    "traffic": lambda rng: {"in_wind": rng.choice(["drifts", "anchored"])},
    "sensor": lambda rng: {"range_m": _number(1, 1e4, 1e-6, 1e9)(rng)},
    "method": _method,
    "replan.answer": _of("direct"),
    "replan.rejoin.to": _of("route"),
    "replan.rejoin.when": _of("clear"),
    "replan.rejoin.margin_m": _number(0.1, 100, 0, 1e6),
    "replan.rejoin.bank_deg": _number(5, 70),
    "replan.k": _number(1, 100, 1.0, 1e9),
    "replan.time_rule": _of("paper_4_3_2"),
    "replan.swell_m": _number(0.1, 100, 1e6),
    "replan.horizon_s": _number(0.01, 100, 1e9, 1e-9),
    "replan.magnitude_chords": _number(0.01, 3, 1e-9),
    "replan.vo_frame": _of("ground_naive"),
    "replan.wind_known": _of("estimated", "none"),
    "replan.wind_estimate_sigma_mps": _number(0.1, 50, 0, 1e6),
    "guidance": lambda rng: {"kind": rng.choice(["look_ahead", "l1"]), "schedule": rng.choice(["keep", "let_go"])},
    "plant": lambda rng: {"kind": rng.choice(["kinematic", "point_mass", "jsbsim"])},
    "ideal": lambda rng: rng.sample(["roll", "load_factor", "speed", "gust"], rng.randint(1, 4)),
    "rates": _rates,
    "aircraft": _of("gtm_t2", "c172p", "t37"),
    "air.wind": _wind,
    "air.gust": _gust,
    "air.turbulence": lambda rng: {
        "kind": rng.choice(["dryden", "dryden", "jsbsim"]),
        "severity": rng.choice(["light", "moderate", "severe"]),
    },
    "vary": lambda rng: {name: _number(0.01, 0.99)(rng) for name in ("derivatives_share", "lags_share", "gains_share")},
    "seed": lambda rng: rng.randrange(2**63),
    "columns": _of("all"),
    "recordings": _of("all"),
}
"""Dotted path to how a value for it is drawn."""

LIKELY = ("plant", "method", "obstacles", "air.wind", "route", "speed_mps", "replan.rejoin.to", "replan.rejoin.when", "replan.answer")
SPEEDS = {"gtm_t2": 50, "c172p": 50, "t37": 100}


LIMITS = {"limits": {"flight_s": 90.0}} if "limits" in Campaign.model_fields else {}
"""A quarter of an hour in the air finds no more than a minute and a half."""


def plain() -> dict[str, Any]:
    """What is changed: the paper's encounter, on rails."""
    return {
        "name": "fuzz",
        "question": "Does every flight end in a row?",
        "seed": 1,
        "speed_mps": 50,
        "route": {
            "start_enu_m": [0, 0, 0],
            "goal_enu_m": [500, 200, 100],
            "start_direction_deg": [40.87, 26.13],
            "goal_direction_deg": [10.0, 2.84],
        },
        "begin": {"climb_at_most_deg": 18},
        "obstacles": [
            {
                "name": "O",
                "radius_m": 25,
                "position_enu_m": [254, 63.6, 60.7],
                "speed_mps": 40,
                "direction_deg": [106, 12.4],
                "when": {"own_reaches_enu_m": [162, 101, 64.3]},
            }
        ],
        "plant": {"kind": "kinematic"},
        "recordings": "none",
        **LIMITS,
    }


def mutated(rng: random.Random, most: int) -> dict[str, Any]:
    """A campaign with up to ``most`` settings drawn; it need not be valid."""
    found = plain()
    names = rng.choices([*SETTINGS, *LIKELY * 3], k=rng.randint(1, most))
    if "route" in names:
        del found["begin"]
    for name in dict.fromkeys(names):
        value = SETTINGS[name](rng)
        if name == "ideal":
            found["plant"] = {"kind": "point_mass", "ideal": value}
            continue
        *above, key = name.split(".")
        section = found
        for one in above:
            section = section.setdefault(one, {})
        section[key] = value
    if "aircraft" in found and "speed_mps" not in names:
        found["speed_mps"] = SPEEDS[found["aircraft"]]
    return found
