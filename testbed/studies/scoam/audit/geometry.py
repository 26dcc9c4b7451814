"""From the printed numbers to threats, caps, directions and insertion points (eq. 1-35). Angles in degrees."""

import math
from collections.abc import Callable

from testbed.core.frames import vec3
from testbed.core.units import DEG
from testbed.studies.scoam.audit.case import Case
from testbed.studies.scoam.audit.readings import CHAIN, COMPONENTS, DETECTION
from vosc import Cap, Obstacle, Own, cap, insertion_point, threat
from vosc.encounter import cone_margin
from vosc.spherical_cap import critical_velocity
from vosc.vec import Vec, add, along, azimuth_elevation, combine, cross, deflection, direction, dot, norm, perpendicular, scale, sub, unit

CAP_OF = {"o": "g", "o1": "g1", "o2": "g2"}
K_FACTOR = 1.25
NO_POINT: Vec = (math.nan, math.nan, math.nan)


def heading(case: Case, name: str) -> Vec:
    """Unit vector of a printed direction."""
    return direction(case[f"{name}.az"] * DEG, case[f"{name}.el"] * DEG)


def position(case: Case, name: str) -> Vec:
    """A printed point, m."""
    return (case[f"{name}.x"], case[f"{name}.y"], case[f"{name}.z"])


def own(case: Case) -> Own:
    """The UAV at P_t (Table 1)."""
    return Own(position(case, "own"), scale(case["own.speed"], heading(case, "own")))


def obstacle(case: Case, name: str) -> Obstacle:
    """An obstacle of Table 1 or 3."""
    return Obstacle(position(case, name), scale(case[f"{name}.speed"], heading(case, name)), case[f"{name}.radius"])


def seen(case: Case, name: str) -> Obstacle:
    """The obstacle whose cone has the half-angle in force: arcsin(R / d_0) at detection distance is that of a radius R |P_u P_o| / d_0."""
    body = obstacle(case, name)
    if not case.has(DETECTION):
        return body
    distance = norm(sub(body.pos_m, position(case, "own")))
    return Obstacle(body.pos_m, body.vel_mps, body.radius_m * distance / case["own.d0"])


def degrees(v: Vec) -> tuple[float, float]:
    """Azimuth and elevation of a vector."""
    azimuth, elevation = azimuth_elevation(v)
    return azimuth / DEG, elevation / DEG


def threat_margin(case: Case, name: str) -> float:
    """alpha_0 - alpha (section 2): positive for a threat."""
    found = threat(own(case), seen(case, name))
    return (found.alpha0_rad - found.alpha_rad) / DEG


def computed_cap(case: Case, name: str) -> Cap:
    """G of eq. 24-28; the obstacles of the paper are slower than the UAV, so it exists."""
    found = cap(own(case), seen(case, name))
    if found is None:
        raise ValueError(f"obstacle '{name}' has no spherical cap")
    return found


def cap_value(case: Case, name: str, which: str) -> float:
    """One of r, psi_r, theta_r and gamma of G (eq. 26-28)."""
    found = computed_cap(case, name)
    return {"r": found.radius_mps, "az": found.azimuth_rad / DEG, "el": found.elevation_rad / DEG, "gamma": found.half_angle_rad / DEG}[
        which
    ]


def rim(case: Case, name: str) -> tuple[Vec, float]:
    """Axis and half-angle (rad) of the cap in force: printed or computed."""
    g = CAP_OF[name]
    if case.has(CHAIN):
        return heading(case, g), case[f"{g}.gamma"] * DEG
    found = computed_cap(case, name)
    return direction(found.azimuth_rad, found.elevation_rad), found.half_angle_rad


def implied_speed(case: Case, g: str) -> float:
    """Own speed by a printed cap, r / cos(gamma): the radius of the velocity sphere it was cut from."""
    return case[f"{g}.r"] / math.cos(case[f"{g}.gamma"] * DEG)


def insertion(case: Case, name: str) -> tuple[Vec, float]:
    """Q_avo and t of eq. 34-35."""
    body, me = obstacle(case, name), own(case)
    if case.has(DETECTION):
        time = (case["own.d0"] - body.radius_m) / norm(body.vel_mps)
        ahead = along(body.pos_m, K_FACTOR * body.radius_m, unit(body.vel_mps))
        return along(ahead, time, body.vel_mps), time
    found = insertion_point(me, body, k=K_FACTOR, time_rule="arrival")
    if found is None:
        return NO_POINT, math.nan
    x, y, z = found.point_m.tolist()
    return (x, y, z), found.time_s


def behind_off(case: Case) -> float:
    """Distance of the point k R behind the obstacle from the printed Q_avo, m: the words of 4.3.1 against eq. 35."""
    found = insertion_point(own(case), obstacle(case, "o"), k=K_FACTOR, side="behind")
    return math.nan if found is None else norm(sub(vec3(found.point_m), position(case, "q")))


def equation_23_off(case: Case) -> float:
    """Angle (deg) between v_u turned by the matrices of eq. 23 and v_u turned by (delta psi, delta theta) of eq. 21-22.

    The matrices have two rows: the right one is taken for the components (x, y), the left one for (horizontal, z).
    """
    turned = direction_in_force(case)
    (psi, theta), (new_psi, new_theta) = ([x * DEG for x in degrees(v)] for v in (heading(case, "own"), turned))
    d_psi, d_theta = new_psi - psi, new_theta - theta
    x = math.cos(d_psi) * math.cos(psi) + math.sin(d_psi) * math.sin(psi)
    y = -math.sin(d_psi) * math.cos(psi) + math.cos(d_psi) * math.sin(psi)
    flat = math.cos(d_theta) * math.cos(theta) + math.sin(d_theta) * math.sin(theta)
    z = -math.sin(d_theta) * math.cos(theta) + math.cos(d_theta) * math.sin(theta)
    return deflection((flat * x, flat * y, z), turned) / DEG


def point_in_force(case: Case, name: str) -> Vec:
    """Q_avo a path is laid through: printed or computed."""
    return position(case, "q" if name == "o" else "q2") if case.has(CHAIN) else insertion(case, name)[0]


def time_to_point(case: Case, name: str) -> float:
    """Time of the straight line from P_t to Q_avo at own speed."""
    return norm(sub(point_in_force(case, name), position(case, "own"))) / case["own.speed"]


def critical_direction(case: Case) -> Vec:
    """Section 4.1: the near critical velocity (eq. 18)."""
    x, y, z = computed_cap(case, "o").nearest_mps.tolist()
    return unit((x, y, z))


def scoam_direction(case: Case) -> Vec:
    """The avoidance direction; with printed results the point of the printed cap's rim nearest to v_u."""
    if not case.has(CHAIN):
        return critical_direction(case)
    axis, half = rim(case, "o")
    return combine(math.cos(half), axis, math.sin(half), perpendicular(axis, heading(case, "own")))


def direction_in_force(case: Case) -> Vec:
    """The avoidance direction of section 5.1 a path or a deflection starts from: printed or computed."""
    return heading(case, "dir") if case.has(CHAIN) else scoam_direction(case)


def turn(case: Case, new: Vec) -> float:
    """Deflection from the own velocity to ``new``: in space, or by components."""
    if case.has(COMPONENTS):
        azimuth, elevation = degrees(new)
        return math.hypot(azimuth - case["own.az"], elevation - case["own.el"])
    return deflection(heading(case, "own"), new) / DEG


def least_turn(case: Case) -> float:
    """The least deflection that leaves the exact cone of the obstacle of section 5.1, at constant speed.

    Generatrix by generatrix (eq. 12-18), then golden section; 0 where nothing has to be left.
    """
    me, body = own(case), seen(case, "o")
    if cone_margin(me.pos_m, me.vel_mps, body) >= 0.0:
        return 0.0
    axis = unit(sub(body.pos_m, me.pos_m))
    half = math.asin(body.radius_m / norm(sub(body.pos_m, me.pos_m)))
    side = perpendicular(axis, body.vel_mps)
    up = (axis[1] * side[2] - axis[2] * side[1], axis[2] * side[0] - axis[0] * side[2], axis[0] * side[1] - axis[1] * side[0])

    def cost(phi: float) -> float:
        across = combine(math.cos(phi), side, math.sin(phi), up)
        velocity = critical_velocity(me, body, combine(math.cos(half), axis, math.sin(half), across))
        return math.inf if velocity is None else deflection(me.vel_mps, velocity)

    start = min((2.0 * math.pi * i / 72 for i in range(72)), key=cost)
    return least(cost, start - 0.1, start + 0.1) / DEG


def least(cost: Callable[[float], float], low: float, high: float) -> float:
    """Least value of a function with one valley in the interval (golden section)."""
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    while high - low > 1e-8:
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        if cost(a) < cost(b):
            high = b
        else:
            low = a
    return float(cost(0.5 * (low + high)))


def k_point(case: Case) -> Vec:
    """K of section 5.2 from eq. 32-33 with the printed y_k, on the rim of either cap: of up to four points the nearest to the print."""
    speed, me = case["own.speed"], position(case, "own")
    y = case["k.y"] - me[1]
    across2 = speed * speed - y * y
    found: list[Vec] = []
    for name in ("o2", "o1"):
        axis, half = rim(case, name)
        level = speed * math.cos(half) - axis[1] * y  # axis_x x + axis_z z = level,  x^2 + z^2 = across2
        flat2 = axis[0] ** 2 + axis[2] ** 2
        beyond = across2 * flat2 - level * level
        if beyond < 0.0:
            continue
        for side in (math.sqrt(beyond), -math.sqrt(beyond)):
            found.append(add(me, ((axis[0] * level + axis[2] * side) / flat2, y, (axis[2] * level - axis[0] * side) / flat2)))
    printed = position(case, "k")
    return min(found, key=lambda p: math.dist(p, printed)) if found else NO_POINT


def crossings(case: Case) -> list[Vec]:
    """Directions of S and S' (eq. 29-31), where the rims of the caps of O_1 and O_2 cross; empty when they do not."""
    (m1, half1), (m2, half2) = rim(case, "o1"), rim(case, "o2")
    shared = dot(m1, m2)
    a = (math.cos(half1) - shared * math.cos(half2)) / (1.0 - shared * shared)
    b = (math.cos(half2) - shared * math.cos(half1)) / (1.0 - shared * shared)
    middle, across = combine(a, m1, b, m2), cross(m1, m2)
    beyond = 1.0 - dot(middle, middle)
    if beyond < 0.0:
        return []
    side = math.sqrt(beyond) / norm(across)
    return [along(middle, side, across), along(middle, -side, across)]


def k_velocity(case: Case) -> Vec:
    """P_u K from the K in force: printed or computed."""
    return sub(position(case, "k") if case.has(CHAIN) else k_point(case), position(case, "own"))


def multi_direction(case: Case) -> Vec:
    """The avoidance direction of section 5.2 a path starts from: printed or that of the computed K."""
    return heading(case, "dir2") if case.has(CHAIN) else unit(k_velocity(case))


def turned(case: Case) -> Vec:
    """The direction the printed deflection (dpsi, dtheta) of section 5.2 leads to."""
    return direction((case["own.az"] + case["turn2.az"]) * DEG, (case["own.el"] + case["turn2.el"]) * DEG)


def union_margin(case: Case, velocity: Vec) -> float:
    """Angle by which a direction lies outside both printed caps of Table 3; 0 on the critical boundary, negative inside."""
    return min((math.acos(max(-1.0, min(1.0, dot(heading(case, g), unit(velocity))))) / DEG - case[f"{g}.gamma"]) for g in ("g1", "g2"))
