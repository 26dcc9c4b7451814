"""Figures 1 to 7: what the method is, on the encounters of section 5."""

import math

import numpy as np

from testbed.core.units import DEG
from testbed.show.drawing import Picture, Sketch, Value
from testbed.studies.scoam.audit.geometry import k_velocity
from testbed.studies.scoam.figures.stage import (
    ALPHA,
    DELTA,
    GAMMA,
    LAMBDA,
    MULTI,
    PRIME,
    PSI,
    SINGLE,
    THETA,
    V_FAR,
    V_NEW,
    W_FAR,
    W_NEW,
    Encounter,
    angle_deg,
    case_of,
    direction,
    encounter,
    g_values,
    judged,
    printed,
    threat_words,
    unit,
)
from vosc import threat
from vosc.direction import boundary_curves, cap_gap, corner_points
from vosc.encounter import cone_margin
from vosc.methods import avoid
from vosc.spherical_cap import generatrices

UP = np.array([0.0, 0.0, 1.0])
IN_A_SECOND = "Velocities are drawn as the way that they lead in one second."


def collision_cone() -> Picture:
    """Figure 1."""
    meeting, s = encounter(SINGLE, "o"), Sketch()
    found = threat(meeting.me, meeting.body)
    side = found.distance_m * math.cos(found.alpha0_rad)
    _po(s, meeting)
    s.cone(meeting.at, meeting.sight, found.alpha0_rad, side, "obstacle")
    s.line([meeting.at, meeting.there], "ink", 1.0, dashed=True)
    s.line([meeting.at, meeting.at + 1.9 * meeting.v_uo], "relative", 1.2, dashed=True)
    s.text(meeting.at + 1.9 * meeting.v_uo, "l_uo", "relative", (6, 4))
    s.arrow(meeting.at, meeting.v_u, "own", "v_u")
    s.arrow(meeting.there, meeting.v_o, "obstacle", "v_o")
    s.arrow(meeting.at, meeting.v_uo, "relative", "v_uo", (-10, 22))
    s.angle(meeting.at, meeting.sight, meeting.v_uo, 34.0, "relative", ALPHA, (-4, 18))
    rim = unit(meeting.sight * math.cos(found.alpha0_rad) + unit(UP - (UP @ meeting.sight) * meeting.sight) * math.sin(found.alpha0_rad))
    s.angle(meeting.at, meeting.sight, rim, 60.0, "obstacle", f"{ALPHA}_0", (8, -4))
    s.dot(meeting.at, "ink", "P_u", (-26, 4))
    values = [
        *judged(meeting),
        Value("|v_uo|", "relative speed", float(np.linalg.norm(meeting.v_uo)), "m/s", 1),
        Value("t", "until the straight lines are closest", found.time_to_cpa_s, "s"),
    ]
    note = f"{threat_words(SINGLE, 'o', meeting)} {IN_A_SECOND}"
    return Picture(1, "The collision cone CC: v_uo in it, the obstacle is a threat", s.things, (0.45, -0.62, 0.55), values, note)


def absolute_cone() -> Picture:
    """Figure 2."""
    meeting, s = encounter(SINGLE, "o"), Sketch()
    found = threat(meeting.me, meeting.body)
    apex = meeting.at + meeting.v_o
    s.cone(meeting.at, meeting.sight, found.alpha0_rad, 78.0, "relative", 0.07)
    s.cone(apex, meeting.sight, found.alpha0_rad, 78.0, "obstacle", 0.18)
    s.arrow(meeting.at, meeting.v_u, "own", "v_u", (-4, -10))
    s.arrow(meeting.at, meeting.v_o, "obstacle", "v_o", (-30, 0), 0.6)
    s.arrow(meeting.at, meeting.v_uo, "relative", "v_uo", (4, 18))
    s.line([apex, meeting.at + meeting.v_u], "relative", 1.4, dashed=True)
    s.dot(meeting.at, "ink", "P_u", (-26, 4))
    s.dot(apex, "obstacle", "P_{3-DVO}", (-40, -10))
    s.text(meeting.at + 78.0 * meeting.sight, "RCC", "relative", (10, 30))
    s.text(apex + 78.0 * meeting.sight, "ACC = RCC \N{CIRCLED PLUS} v_o", "obstacle", (-40, -34))
    values = [
        direction("v_u", "velocity of the UAV", meeting.v_u),
        direction("v_o", "velocity of the obstacle", meeting.v_o),
        direction("v_uo", "v_u \N{MINUS SIGN} v_o, eq. 1", meeting.v_uo),
        Value("P_{3-DVO}", "P_u + v_o, eq. 6", tuple(float(x) for x in apex), "m", 1),
        Value(
            f"{ALPHA}_0 \N{MINUS SIGN} {ALPHA}", "v_u is so far inside ACC",
            -cone_margin(meeting.me.pos_m, meeting.me.vel_mps, meeting.body) / DEG, "deg",
        ),
    ]  # fmt: skip
    note = f"v_uo lies in RCC exactly when v_u lies in ACC, the same cone carried along by v_o (eq. 3, 4). {IN_A_SECOND}"
    return Picture(2, "The velocity obstacle: RCC carried along by v_o is ACC", s.things, (0.75, -0.55, 0.45), values, note)


def cut_sphere() -> Picture:
    """Figure 3."""
    meeting, s = encounter(SINGLE, "o"), Sketch()
    found, speed = threat(meeting.me, meeting.body), float(np.linalg.norm(meeting.v_u))
    zero = np.zeros(3)
    s.sphere(zero, speed, "own", 0.06)
    s.cone(meeting.v_o, meeting.sight, found.alpha0_rad, 85.0, "obstacle", 0.14)
    s.cap(zero, meeting.middle, meeting.cap.half_angle_rad, speed, "cap", 0.36)
    for curve in boundary_curves(meeting.me, meeting.body):
        s.line([*curve, curve[0]], "obstacle", 2.2)
    s.arrow(zero, meeting.v_u, "own", "v_u", (8, 14))
    s.arrow(zero, meeting.v_o, "obstacle", "v_o", (-30, -6))
    s.dot(zero, "ink", "P_u", (-28, 6))
    s.text(np.array([0.0, 0.0, speed]), "VS", "own", (6, -8))
    s.text(meeting.v_o + 85.0 * meeting.sight, "3-DVO", "obstacle", (-20, -36))
    s.text(speed * unit(meeting.middle), "SC", "cap", (6, 34))
    gap = cap_gap(meeting.me, meeting.body)
    assert gap is not None, "it has a cap"
    values = [
        Value("|v_u|", "radius of VS", speed, "m/s", 1),
        Value(GAMMA, "half-angle of SC", meeting.cap.half_angle_rad / DEG, "deg", 1, printed("g.gamma")),
        Value("out", "SC's circle lies outside of 3-DVO by up to", float(gap.max()) / DEG, "deg"),
        Value("in", "and inside of it, where it collides, by up to", -float(gap.min()) / DEG, "deg"),
    ]
    note = (
        "The velocity sphere VS holds the directions at the present speed; the velocity obstacle cuts SC out of it. Filled: the paper's "
        "circle. Thick: the exact border, which touches that circle at two critical velocities only."
    )
    return Picture(3, "The spherical cap SC on the velocity sphere", s.things, (0.85, -0.35, 0.40), values, note, "m/s")


def cap_numbers() -> Picture:
    """Figure 4."""
    meeting, s = encounter(SINGLE, "o"), Sketch()
    zero, speed, found = np.zeros(3), float(np.linalg.norm(meeting.v_u)), meeting.cap
    flat = np.array([math.cos(found.azimuth_rad), math.sin(found.azimuth_rad), 0.0])
    s.sphere(zero, speed, "own", 0.05)
    s.cap(zero, meeting.middle, found.half_angle_rad, speed, "cap", 0.30)
    for axis, name in zip(np.eye(3), "xyz", strict=True):
        s.arrow(zero, 1.25 * speed * axis, "faint", name, (4, -2))
    s.line([zero, 1.1 * speed * flat], "faint", 1.2, dashed=True)
    s.arrow(zero, meeting.middle, "cap", "r", (0, 18), 0.55)
    s.line([zero, found.nearest_mps, found.farthest_mps, zero], "cap", 1.2)
    s.angle(zero, np.array([1.0, 0.0, 0.0]), flat, 0.75 * speed, "ink", f"{PSI}_r", (4, 14))
    s.angle(zero, flat, meeting.middle, 1.05 * speed, "ink", f"{THETA}_r", (8, 4))
    s.angle(zero, meeting.middle, found.nearest_mps, 0.40 * speed, "cap", GAMMA, (2, -6))
    s.dot(zero, "ink", "P_u", (-28, 6))
    s.dot(meeting.middle, "cap", "M", (8, 14))
    values = g_values(meeting, "g")
    values.append(
        Value(
            "r / cos \N{GREEK SMALL LETTER GAMMA}",
            "radius of the sphere that they belong to",
            found.radius_mps / math.cos(found.half_angle_rad),
            "m/s",
            1,
        )
    )
    note = f"G = (r, {PSI}_r, {THETA}_r, {GAMMA}), eq. 24-28. The printed direction belongs to no reading of Table 1; r and {GAMMA} do."
    return Picture(4, "Size and direction of the cap: G", s.things, (0.70, -0.65, 0.42), values, note, "m/s")


def rotation() -> Picture:
    """Figure 5."""
    meeting, s = encounter(SINGLE, "o"), Sketch()
    pair, found, start = generatrices(meeting.me, meeting.body), threat(meeting.me, meeting.body), meeting.at
    assert pair is not None, "the UAV is outside of the obstacle"
    near, far = (np.array(q) for q in pair)
    apex, side = start + meeting.v_o, found.distance_m * math.cos(found.alpha0_rad)
    s.cone(apex, meeting.sight, found.alpha0_rad, side, "obstacle", 0.10)
    s.sphere(meeting.there + meeting.v_o, meeting.body.radius_m, "obstacle", 0.08)
    ends = [apex + 1.12 * side * q for q in (near, far)]
    s.line([ends[0], apex, ends[1], ends[0]], "faint", 1.2)
    s.line([apex, ends[0]], "obstacle", 2.0)
    s.line([apex, ends[1]], "obstacle", 2.0)
    s.text(ends[0], "l_3", "obstacle", (6, -4))
    s.text(ends[1], f"l{PRIME}_3", "obstacle", (6, 10))
    s.dot(apex + side * near, "obstacle", "Q", (6, -8))
    s.dot(apex + side * far, "obstacle", f"Q{PRIME}", (6, 16))
    s.dot(meeting.there + meeting.v_o, "obstacle", "Q_o", (8, 6))
    s.dot(apex, "obstacle", "P_{3-DVO}", (-50, -8))
    s.dot(start, "ink", "P_u", (-28, 6))
    s.arrow(start, meeting.v_u, "own", "v_u", (8, 14))
    s.arrow(start, meeting.v_o, "obstacle", "v_o", (-28, 4), 0.6)
    s.arrow(apex, meeting.v_uo, "relative", "v_uo", (-44, 4), 0.7)
    s.arrow(start, meeting.cap.nearest_mps, "chosen", V_NEW, (-30, -6))
    s.arrow(start, meeting.cap.farthest_mps, "cap", V_FAR, (8, 12))
    s.angle(apex, meeting.v_uo, near, 30.0, "relative", DELTA, (6, -6))
    lengths = [float(np.linalg.norm(v - meeting.v_o)) for v in (meeting.cap.nearest_mps, meeting.cap.farthest_mps)]
    values = [
        Value(DELTA, f"{ALPHA}_0 \N{MINUS SIGN} {ALPHA}, eq. 5: turn of v_uo onto l_3", (found.alpha0_rad - found.alpha_rad) / DEG, "deg"),
        Value(f"{LAMBDA}", f"|{W_NEW}|, eq. 14", lengths[0], "m/s", 1),
        Value(f"{LAMBDA}{PRIME}", f"|{W_FAR}|", lengths[1], "m/s", 1),
        direction(V_NEW, "least turn, eq. 18-20", meeting.cap.nearest_mps, "dir.az", "dir.el"),
        direction(V_FAR, "largest turn in this plane", meeting.cap.farthest_mps),
        Value("turn", f"from v_u to {V_NEW}", angle_deg(meeting.v_u, meeting.cap.nearest_mps), "deg", 1, printed("t2.scoam_deflection")),
    ]
    note = (
        f"The plane through the line of sight and v_uo cuts the cone in l_3 and l{PRIME}_3: critical velocities end on them. {IN_A_SECOND}"
    )
    return Picture(5, "Least and largest turn of v_u in the avoidance plane", s.things, (0.62, -0.50, 0.60), values, note)


def triangle() -> Picture:
    """Figure 6."""
    meeting, s = encounter(SINGLE, "o"), Sketch()
    zero, near, far, middle = np.zeros(3), meeting.cap.nearest_mps, meeting.cap.farthest_mps, meeting.middle
    s.arrow(zero, meeting.v_o, "obstacle", "v_o", (-28, -4), 0.6)
    s.arrow(zero, near, "chosen", V_NEW, (-8, -12), 0.7)
    s.arrow(zero, far, "cap", V_FAR, (-4, 22), 0.7)
    s.arrow(meeting.v_o, near - meeting.v_o, "relative", W_NEW, (2, -12), 0.6)
    s.arrow(meeting.v_o, far - meeting.v_o, "relative", W_FAR, (8, 4), 0.6)
    s.line([near, far], "cap", 1.4)
    s.arrow(zero, middle, "ink", "r", (0, -8), 0.5)
    s.line([meeting.v_o, middle], "faint", 1.4, dashed=True)
    s.angle(zero, middle, near, 14.0, "cap", GAMMA, (6, -2))
    for place, name, moved in (
        (zero, "A = P_u", (-30, 24)),
        (meeting.v_o, "P_{3-DVO}", (-20, -12)),
        (near, "B", (8, -4)),
        (far, "C", (8, 12)),
        (middle, "M", (9, 6)),
    ):
        s.dot(place, "ink", name, moved)
    chord, speed = float(np.linalg.norm(near - far)), float(np.linalg.norm(meeting.v_u))
    values = [
        Value("|BC|", f"{V_NEW} to {V_FAR}", float(np.linalg.norm(near - far)), "m/s", 1),
        Value("r", "|AM|, eq. 25", float(np.linalg.norm(middle)), "m/s", 1, printed("g.r")),
        Value(GAMMA, "arcsin |BC| / 2 |v_u|, eq. 28", math.asin(0.5 * chord / speed) / DEG, "deg", 1, printed("g.gamma")),
        Value("|P_{3-DVO}M|", "eq. 24", float(np.linalg.norm(middle - meeting.v_o)), "m/s", 1),
    ]  # fmt: skip
    normal = np.cross(near - meeting.v_o, far - meeting.v_o)
    towards = unit(normal) if normal[2] > 0.0 else -unit(normal)
    eye = unit(towards + 0.25 * np.array([0.0, 0.0, 1.0]))
    note = "Seen nearly along the normal of the avoidance plane, in which P_3-DVO, B, C and M lie; A does not lie in it."
    return Picture(
        6, "Vectors between the UAV and the obstacle", s.things, (float(eye[0]), float(eye[1]), float(eye[2])), values, note, "m/s"
    )


def two_caps() -> Picture:
    """Figure 7."""
    first, second, s = encounter(MULTI, "o1"), encounter(MULTI, "o2"), Sketch()
    zero, speed = np.zeros(3), float(np.linalg.norm(first.v_u))
    s.sphere(zero, speed, "own", 0.05)
    for meeting, ink, name, moved in ((first, "cap", "1", (8, 18)), (second, "obstacle", "2", (8, -10))):
        s.cap(zero, meeting.middle, meeting.cap.half_angle_rad, speed, ink, 0.26)
        s.arrow(zero, meeting.middle, ink)
        s.dot(meeting.middle, ink, f"M_{name}", moved)
    s.arrow(zero, first.v_u, "own", "v_u", (6, -6))
    corners = corner_points(first.cap, second.cap, speed)
    for place, name, moved in zip(corners, ("S", f"S{PRIME}"), ((8, -6), (8, 16)), strict=True):
        s.dot(place, "ink", name, moved)
    chosen = avoid("scoam", first.me, [first.body, second.body]).velocity_mps
    s.arrow(zero, chosen, "chosen", "K", (12, 14))
    s.dot(np.array(k_velocity(case_of(MULTI))), "chosen", "K(y_k)", (8, -6))
    s.dot(zero, "ink", "P_u", (-28, 6))
    at, given = (tuple(float(x) for x in first.at + v) for v in (chosen, np.array(k_velocity(case_of(MULTI)))))
    values = [
        *g_values(first, "g1", "_1"),
        *g_values(second, "g2", "_2"),
        *[direction(name, "eq. 29-31", place) for name, place in zip(("S", f"S{PRIME}"), corners, strict=True)],
        Value("K", "of the critical boundary, nearest to v_u", at, "m", 1),
        Value("K(y_k)", "eq. 32-33 with the printed y_k", given, "m", 1, printed("k.x", "k.y", "k.z")),
    ]
    note = f"{threat_words(MULTI, 'o2', second)}"
    return Picture(
        7,
        "Two caps: S and S\N{PRIME} where their circles meet, K on the critical boundary",
        s.things,
        (0.93, 0.10, 0.16),
        values,
        note,
        "m/s",
        sphere_around=True,
    )


def _po(s: Sketch, meeting: Encounter) -> None:
    """The position obstacle."""
    s.sphere(meeting.there, meeting.body.radius_m, "obstacle", 0.16)
    s.dot(meeting.there, "obstacle", "P_o", (8, 16))
