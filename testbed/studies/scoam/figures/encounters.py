"""Figures 8 to 14: the simulations of section 5, from the original path to the paths round one obstacle and round two."""

from functools import cache

import numpy as np

from testbed.core.units import DEG
from testbed.show.drawing import Picture, Sketch, Value
from testbed.studies.scoam.audit.geometry import insertion, k_velocity, turn
from testbed.studies.scoam.audit.manoeuvres import clearance, legs, path_length, route
from testbed.studies.scoam.figures.stage import (
    MULTI,
    PRIME,
    SINGLE,
    V_NEW,
    Encounter,
    case_of,
    direction,
    encounter,
    judged,
    printed,
    threat_words,
)
from vosc import Obstacle, Own, ph, threat
from vosc.methods import avoid
from vosc.vec import Vec, three, unit

ASSUMED = (
    "The paper prints no end tangents: those of the route are assumed so that it passes P_t in the printed direction, as long as the chord."
)
SIDE, PLAN = (0.35, -0.80, 0.50), (0.28, -0.60, 0.75)


def _around(meetings: list[Encounter]) -> tuple[float, float, float, float]:
    """The surroundings of the UAV and its obstacles."""
    middle = np.mean([meetings[0].at, *(meeting.there + meeting.v_o for meeting in meetings)], axis=0)
    return float(middle[0]), float(middle[1]), float(middle[2]), 118.0


def original() -> Picture:
    """Figure 8."""
    curve, s = route(case_of(SINGLE)), Sketch()
    _path(s, curve, "route", 2.6)
    _ends(s, curve)
    s.dot(np.array(encounter(SINGLE, "o").at), "own", "P_t", (-6, -10))
    climb = curve.climb_range_rad()
    at, off = curve.nearest(np.array([encounter(SINGLE, "o").at]))
    values = [
        Value("L", "length of the path", curve.length_m, "m", 1),
        Value("s(P_t)", "arc length nearest to P_t", float(at[0]), "m", 1),
        Value("off", "distance of P_t from the path", float(off[0]), "m"),
        Value("R_min", "least radius of curvature", 1.0 / curve.max_curvature(), "m", 0),
        Value("climb", "least and most", (climb[0] / DEG, climb[1] / DEG), "deg", 1),
        Value("T", "at 50 m/s", curve.length_m / case_of(SINGLE)["own.speed"], "s"),
    ]
    return Picture(8, "The original PH path from P_s to P_f", s.things, SIDE, values, ASSUMED)


def detected_one() -> Picture:
    """Figure 9."""
    return _detected(9, "The UAV at P_t detects the obstacle O", SINGLE, ("o",))


def detected_two() -> Picture:
    """Figure 12."""
    return _detected(12, "The UAV at P_t detects the obstacles O_1 and O_2", MULTI, ("o1", "o2"))


def _detected(number: int, title: str, reading: str, names: tuple[str, ...]) -> Picture:
    case, s = case_of(reading), Sketch()
    meetings = [encounter(reading, name) for name in names]
    _path(s, route(case), "route", 2.2)
    _ends(s, route(case))
    reach, at = case["own.d0"], meetings[0].at
    around = np.linspace(0.0, 2.0 * np.pi, 73)
    s.line(list(at + reach * np.column_stack([np.cos(around), np.sin(around), np.zeros_like(around)])), "own", 1.0, dashed=True)
    way = reach * np.array([-0.6, -0.8, 0.0])
    s.line([at, at + way], "own", 1.0, dashed=True)
    s.text(at + 0.5 * way, f"d_0 = {reach:g} m", "own", (10, 6))
    s.arrow(at, meetings[0].v_u, "own", "v_u", (-4, -8))
    s.dot(at, "own", "P_t", (-26, 4))
    values = [direction("v_u", "velocity of the UAV at P_t", meetings[0].v_u, "own.az", "own.el")]
    for name, meeting in zip(names, meetings, strict=True):
        sign = name.upper() if len(name) == 1 else f"O_{name[1]}"
        s.sphere(meeting.there, meeting.body.radius_m, "obstacle", 0.18)
        s.arrow(meeting.there, meeting.v_o, "obstacle")
        s.text(meeting.there, sign, "obstacle", (-8, 26))
        distance = float(np.linalg.norm(meeting.there - meeting.at))
        values += [
            Value(sign, "distance of its centre", distance, "m", 1),
            Value("R", "its radius", meeting.body.radius_m, "m", 0),
            direction("v_o", f"its direction, at {np.linalg.norm(meeting.v_o):.0f} m/s", meeting.v_o, f"{name}.az", f"{name}.el"),
        ]
    return Picture(number, title, s.things, PLAN, values, threat_words(reading, names[-1], meetings[-1]), larger=_around(meetings))


def judged_one() -> Picture:
    """Figure 10."""
    return _judged(10, "Is O to be avoided? v_uo lies in its cone", SINGLE, ("o",))


def judged_two() -> Picture:
    """Figure 13."""
    return _judged(13, "Are O_1 and O_2 to be avoided? Each v_uo lies in its cone", MULTI, ("o1", "o2"))


def _judged(number: int, title: str, reading: str, names: tuple[str, ...]) -> Picture:
    s, values = Sketch(), list[Value]()
    for k, name in enumerate(names):
        meeting, index = encounter(reading, name), name[1:]
        found, ink = threat(meeting.me, meeting.body), ("obstacle", "cap")[k]
        s.sphere(meeting.there, meeting.body.radius_m, ink, 0.16)
        s.cone(meeting.at, meeting.sight, found.alpha0_rad, found.distance_m * float(np.cos(found.alpha0_rad)), ink, 0.12)
        s.line([meeting.at, meeting.there], ink, 1.0, dashed=True)
        ends = meeting.at + found.time_to_cpa_s * meeting.v_uo
        s.line([meeting.at, ends], "relative", 1.2, dashed=True)
        s.arrow(meeting.at, meeting.v_uo, "relative", f"v_uo{index}", (4, 18))
        s.dot(ends, "relative", "", (0, 0))
        s.line([ends, meeting.there], "relative", 1.0)
        s.text(meeting.there, f"O{f'_{index}' if index else ''}", ink, (8, -12))
        values += judged(meeting, index)
    first = encounter(reading, names[0])
    s.arrow(first.at, first.v_u, "own", "v_u", (-6, -10))
    s.dot(first.at, "ink", "P_t", (-30, 6))
    note = f"{threat_words(reading, names[-1], encounter(reading, names[-1]))} The short line: how far the straight lines pass."
    return Picture(number, title, s.things, (0.30, -0.60, 0.74), values, note)


def avoided_one() -> Picture:
    """Figure 11."""
    case = case_of(SINGLE)
    chosen = unit(three("the answer", avoid("scoam", *_met(SINGLE, ("o",))).velocity_mps))
    values = [
        direction(V_NEW, "avoidance direction", np.array(chosen), "dir.az", "dir.el"),
        Value("turn", "deflection in space", turn(case, chosen), "deg", 1, printed("t2.scoam_deflection")),
    ]
    lengths = printed("t2.scoam_length"), printed("t2.scoam_time")
    return _avoided(11, "The path round O", SINGLE, "o", ("o",), chosen, values, lengths)


def avoided_two() -> Picture:
    """Figure 14."""
    case = case_of(MULTI)
    chosen = unit(three("the answer", avoid("scoam", *_met(MULTI, ("o1", "o2"))).velocity_mps))
    values = [
        direction("K", "of the critical boundary, nearest to v_u", np.array(chosen), "dir2.az", "dir2.el"),
        direction("K(y_k)", "with the printed y_k instead", np.array(k_velocity(case))),
        Value("turn", "deflection in space", turn(case, chosen), "deg", 1, printed("t4.scoam_deflection")),
    ]
    lengths = printed("t4.scoam_length"), printed("t4.scoam_time")
    return _avoided(14, "The path round O_1 and O_2", MULTI, "o1", ("o1", "o2"), chosen, values, lengths)


def _met(reading: str, names: tuple[str, ...]) -> tuple[Own, list[Obstacle]]:
    """The UAV and its obstacles."""
    meetings = [encounter(reading, name) for name in names]
    return meetings[0].me, [meeting.body for meeting in meetings]


def _avoided(
    number: int, title: str, reading: str, major: str, names: tuple[str, ...], chosen: Vec, values: list[Value], lengths: tuple[str, str]
) -> Picture:
    """The route, the path through the insertion point, and the obstacles where they are then."""
    case, s = case_of(reading), Sketch()
    point, time_s = insertion(case, major)
    first, second = legs(case, major, chosen)
    _path(s, route(case), "route", 1.6, dashed=True)
    _path(s, first, "avoid", 2.8)
    _path(s, second, "rejoin", 2.8)
    _ends(s, route(case))
    meetings: list[Encounter] = [encounter(reading, name) for name in names]
    s.dot(meetings[0].at, "own", "P_t", (-28, 4))
    s.dot(np.array(point), "chosen", "Q_avo", (-20, -12))
    speed = case["own.speed"]
    for name, meeting in zip(names, meetings, strict=True):
        then = meeting.there + time_s * meeting.v_o
        s.sphere(meeting.there, meeting.body.radius_m, "obstacle", 0.06)
        s.sphere(then, meeting.body.radius_m, "obstacle", 0.18)
        s.line([meeting.there, then], "obstacle", 1.2, dashed=True)
        s.text(then, f"O{PRIME}{f'_{name[1]}' if len(name) > 1 else ''}", "obstacle", (6, -8))
    key = "q" if major == "o" else "q2"
    values = [
        Value("Q_avo", "insertion point, eq. 34-35, k 1.25", point, "m", 1, printed(f"{key}.x", f"{key}.y", f"{key}.z")),
        *values,
        Value("t", "P_t to Q_avo along the path", first.length_m / speed, "s", 2, lengths[1]),
        Value("L", "P_s to P_f on it", path_length(case, major, chosen), "m", 1, lengths[0]),
        Value("R_min", "least radius before Q_avo", 1.0 / first.max_curvature(), "m", 0),
        Value("clear", "least clearance by the printed Q_avo and direction", clearance(case, major), "m", 1),
    ]
    note = f"{ASSUMED} Light: the obstacle at P_t. Dark: when the UAV is due at Q_avo."
    return Picture(number, title, s.things, PLAN, values, note, larger=_around(meetings))


def _path(s: Sketch, curve: ph.Curve, ink: str, width: float, dashed: bool = False) -> None:
    s.line(list(curve.points(np.linspace(0.0, curve.length_m, 90))), ink, width, dashed)


def _ends(s: Sketch, curve: ph.Curve) -> None:
    s.dot(np.array(curve.point(0.0)), "ink", "P_s", (-8, 22))
    s.dot(np.array(curve.point(curve.length_m)), "ink", "P_f", (-6, -10))


@cache
def figures() -> tuple[Picture, ...]:
    """All fourteen, in order."""
    from testbed.studies.scoam.figures import method

    return (
        method.collision_cone(),
        method.absolute_cone(),
        method.cut_sphere(),
        method.cap_numbers(),
        method.rotation(),
        method.triangle(),
        method.two_caps(),
        original(),
        detected_one(),
        judged_one(),
        avoided_one(),
        detected_two(),
        judged_two(),
        avoided_two(),
    )
