"""What else the printed numbers imply, row by row: the second half of the sentences of evidence.

Figures in these notes are computed here, from the same printed numbers, unless they are themselves printed.
"""

from collections.abc import Callable, Mapping
from functools import cache, partial

from testbed.core.units import DEG
from testbed.studies.scoam.audit import geometry as geo
from testbed.studies.scoam.audit import manoeuvres as ma
from testbed.studies.scoam.audit.case import Case, numbers
from testbed.studies.scoam.audit.readings import AS_PRINTED, READINGS
from vosc import Obstacle, Own, cap, threat
from vosc.vec import along, norm, sub


def text(x: float, decimals: int) -> str:
    """A number to so many decimals, without negative zero."""
    return f"{round(x, decimals) + 0.0:.{decimals}f}"


def note(key: str) -> str:
    """The note of a row: its own, or that of its group (``dir2.az`` falls back on ``dir2``); empty if there is none."""
    found = NOTES.get(key) or NOTES.get(key.partition(".")[0]) or ""
    return found if isinstance(found, str) else found()


@cache
def _case(reading_name: str) -> Case:
    reading = next(r for r in (AS_PRINTED, *READINGS) if r.name == reading_name)
    return Case({key: number.value for key, number in numbers(reading).items()}, reading.switches)


def _angle(one: str, other: str) -> float:
    case = _case("as_printed")
    return geo.deflection(geo.heading(case, one), geo.heading(case, other)) / DEG


def _distance_for(name: str, reading: str) -> float:
    """The distance, along the line of sight, at which the obstacle's cap has the printed half-angle, m."""
    case = _case(reading)
    me, body = geo.own(case), geo.obstacle(case, name)
    sight, wanted = sub(body.pos_m, me.pos_m), case[f"{geo.CAP_OF[name]}.gamma"] * DEG
    low, high = 1.01 * body.radius_m / norm(sight), 1.0
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        found = cap(Own(me.pos_m, me.vel_mps), Obstacle(along(me.pos_m, middle, sight), body.vel_mps, body.radius_m))
        low, high = (middle, high) if found is None or found.half_angle_rad > wanted else (low, middle)
    return high * norm(sight)


def _family(value: Callable[[float], float], decimals: int = 1) -> str:
    """Range of a number over the unprinted end magnitudes."""
    values = [value(m) for m in ma.MAGNITUDES]
    chords = f"{ma.MAGNITUDES[0]:.1f} to {ma.MAGNITUDES[-1]:.1f} chords"
    return f"{text(min(values), decimals)} to {text(max(values), decimals)} m for end derivatives of {chords}"


def _length(name: str, method: str) -> str:
    case = _case("printed_results")
    chords = f"the straight pieces through the printed Q_avo measure {ma.chord_length(case, name):.1f} m"
    if method != "scoam":
        return f"no insertion point, direction or end magnitude of this path is printed; {chords}"
    family = _family(lambda m: ma.lengths(case, name, method, m)[0])
    return f"{chords}, and the path arriving there along the printed direction {family}: the paper prints none"


def _time(name: str, method: str) -> str:
    straight = geo.time_to_point(_case("printed_results"), name)
    if method == "scoam":
        return f"the printed Q_avo is {50.0 * straight:.1f} m away, {straight:.3f} s at 50 m/s along the straight line"
    return f"no insertion point of DROAM is printed; to that of SCOAM, common to all methods by eq. 34-35, it is {straight:.3f} s at least"


def _sides(name: str, plane: str, reading: str) -> str:
    case = _case(reading)
    names = ("left", "right") if plane == "hp" else ("up", "down")
    index = 0 if plane == "hp" else 1
    found = []
    for new in ma.droam(case, name, plane):
        change = geo.degrees(new)[index] - (case["own.az"], case["own.el"])[index]
        found.append(f"{abs(change):.1f} {names[change < 0]}")
    return " or ".join(found) + f" ({reading})"


def _cap_note(name: str) -> str:
    readings = ("as_printed",) if name == "o1" else ("as_printed", "o2_elevation_plus")
    near = " or ".join(f"{_distance_for(name, reading):.0f} m ({reading})" for reading in readings)
    case = _case("as_printed")
    real = norm(sub(geo.position(case, name), geo.position(case, "own")))
    return f"a half-angle of {case[geo.CAP_OF[name] + '.gamma']:g} deg needs O_{name[1]} at {near}, not {real:.0f} m"


def _miss(name: str, reading: str) -> float:
    case = _case(reading)
    return float(threat(geo.own(case), geo.obstacle(case, name)).miss_m)


def _angle_k(g: str) -> float:
    case = _case("printed_results")
    return geo.deflection(geo.heading(case, g), geo.k_velocity(case)) / DEG


def _shorter(magnitude: float) -> float:
    case = _case("azimuth_106")
    droam = [x for plane in ("hp", "vp") for x in ma.lengths(case, "o", plane, magnitude)]
    return min(droam) - ma.lengths(case, "o", "scoam", magnitude)[0]


def _longer_leg(magnitude: float) -> float:
    case = _case("azimuth_106")
    others = [ma.legs(case, "o", new, magnitude)[0].length_m for plane in ("hp", "vp") for new in ma.droam(case, "o", plane)]
    return ma.legs(case, "o", ma.scoam(case, "o"), magnitude)[0].length_m - min(others)


def _direction_note() -> str:
    found = {r: geo.degrees(geo.critical_direction(_case(r))) for r in SINGLE}
    pairs = ", ".join(f"({azimuth:.1f}, {elevation:.1f}) with {r}" for r, (azimuth, elevation) in found.items())
    return f"the pair is {pairs}, printed (36.6, 13.2)"


def _table_2_note() -> str:
    case = _case("printed_results")
    azimuth = case["dir.az"] - case["own.az"]
    leave, turned = case["g.gamma"] - _angle("g", "own"), _angle("own", "dir")
    return f"the change of azimuth is {azimuth:.1f}, the least turn out of the printed cap {leave:.2f}, the turn in space {turned:.2f} deg"


def _too_high() -> str:
    high = geo.insertion(_case("azimuth_106"), "o")[0][2] - _case("as_printed")["q.z"]
    return f"with the elevation of Table 1 the point comes out {high:.1f} m too high; direction_106_10 was read off this point"


def _path(reading: str, name: str) -> str:
    return f"over the unprinted end magnitudes it is {_family(lambda m: ma.clearance(_case(reading), name, m))}"


def _missed(name: str) -> str:
    case = _case("as_printed")
    radius = case[f"{name}.radius"]
    miss = _miss(name, "as_printed")
    return f"the straight lines pass at {miss:.1f} m, {'inside' if miss < radius else 'outside'} the radius of {radius:g} m"


def _held() -> str:
    case = _case("printed_results")
    least_out = case["g2.gamma"] - _angle("g2", "own")
    least_s = min(geo.deflection(geo.heading(case, "own"), s) for s in geo.crossings(case)) / DEG
    return f"no turn below {least_out:.1f} deg leaves the printed cap of O_2, and S or S' of the printed caps take {least_s:.1f} deg"


def _off_rim() -> str:
    return f"v-hat_u lies on the rim of G by definition, yet the printed direction lies {_angle('g', 'dir'):.2f} deg from the axis"


def _turns(name: str, plane: str, *readings: str) -> str:
    return f"in {'azimuth' if plane == 'hp' else 'elevation'} {', '.join(_sides(name, plane, reading) for reading in readings)}"


SPEED = "r and gamma belong together, whatever encounter they came from"
OFF_BOUNDARY = "the printed K is on the rim of neither cap, printed or computed"
SINGLE, MULTIPLE = ("azimuth_106", "direction_106_10"), ("as_printed", "printed_results")

NOTES: Mapping[str, str | Callable[[], str]] = {
    "eq_23": "its sines turn by minus delta psi and minus delta theta; eq. 18 gives the velocity itself, and nothing here uses eq. 23",
    "q_behind": "the printed points follow eq. 35: ahead of the obstacle on its course",
    "threat_o": partial(_missed, "o"),
    "threat_o1": partial(_missed, "o1"),
    "threat_o2": partial(_missed, "o2"),
    "g.az": "no reading turns the cap's axis past the UAV's own azimuth of 24.7 deg",
    "g1.r": partial(_cap_note, "o1"),
    "g1.gamma": partial(_cap_note, "o1"),
    "g2.r": partial(_cap_note, "o2"),
    "g2.gamma": partial(_cap_note, "o2"),
    "g2.az": "only the rounding of 32 m/s makes the interval that wide: with exactly 32 m/s it ends below 22.3 deg",
    "speed_g": SPEED,
    "speed_g1": SPEED,
    "speed_g2": SPEED,
    "q": "direction_106_10 was read off this point, so only its distance is a test, and k was chosen to pass it",
    "q.z": _too_high,
    "q2": "k and the time rule are the same as in section 5.1",
    "dir": _direction_note,
    "dir_on_cap": _off_rim,
    "deflection_least": "eq. 5-18 turn the relative velocity least, and that is not the least turn of v_u wherever O is a threat",
    "route_flyable": "no limit of curvature, climb or bank is printed to hold it against",
    "path_safe": lambda: f"as printed O flies elsewhere, and with azimuth_106 {_path('azimuth_106', 'o')}",
    "path_flyable": "no limit of curvature, climb or bank is printed, and the paper leaves the dynamics out",
    "path2_safe": lambda: f"{_path('as_printed', 'o1')}: the printed point and direction bring the UAV into O_1",
    "t2.scoam_deflection": _table_2_note,
    "t2.hp_deflection": partial(_turns, "o", "hp", *SINGLE),
    "t2.vp_deflection": lambda: f"{_turns('o', 'vp', *SINGLE)}; only the turn down, the larger one, meets the print",
    "t2_least_deflection": "the rounding of the inputs hides which of the two is smaller",
    "t2_shortest": lambda: f"with azimuth_106 and the unprinted end magnitudes it is {_family(_shorter)}",
    "t2_fastest": lambda: f"with azimuth_106 SCOAM's leg to Q_avo is longer by {_family(_longer_leg, 2)}",
    "k.x": OFF_BOUNDARY,
    "k.z": OFF_BOUNDARY,
    "k_norm": "eq. 32 demands the own speed exactly",
    "dir2": "the printed K lies straight ahead in x and above P_u, the printed direction to the left and below",
    "turn2": "printed direction minus own direction is (-2.5, -50.9) deg, the deflection printed beside them (-3.88, 12.86) deg",
    "k_on_boundary": lambda: f"K is {_angle_k('g1'):.1f} and {_angle_k('g2'):.1f} deg from the two axes, inside both caps",
    "dir2_on_boundary": "the printed direction lies outside both caps, not on either rim",
    "turn2_on_boundary": "the printed deflection leads deep inside both caps",
    "t4.scoam_deflection": lambda: f"it is the size of the printed pair (-3.88, 12.86) deg, but {_held()}",
    "t4.hp_deflection": lambda: f"{_turns('o1', 'hp', *MULTIPLE)}; {_held()}",
    "t4.vp_deflection": lambda: f"{_turns('o1', 'vp', *MULTIPLE)}; {_held()}",
    "t4_least_deflection": lambda: (
        f"13.4 deg ends inside both printed caps, and the direction printed with it needs {_angle('own', 'dir2'):.1f} deg"
    ),
    **{f"{t}.{m}_length": partial(_length, n, m) for t, n in (("t2", "o"), ("t4", "o1")) for m in ("scoam", "hp", "vp")},
    **{f"{t}.{m}_time": partial(_time, n, m) for t, n in (("t2", "o"), ("t4", "o1")) for m in ("scoam", "hp", "vp")},
}
