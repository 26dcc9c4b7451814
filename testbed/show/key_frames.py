"""Key frames of an encounter as static SVG: what the moving one says without JavaScript and on paper. From above, and from the side.

Across the page runs the track of the focus at instant 0; upwards what lies to its left (from above) or over it (from the side).
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from markupsafe import Markup, escape

from testbed.flight.record import AVOIDING, inside
from testbed.show import words
from testbed.show.close_up import DECISION, EVERY
from testbed.show.words import number

Point = tuple[float, float, float]
CloseUp = Mapping[str, Any]
Ghosts = Sequence[tuple[Mapping[str, Any], Mapping[str, Any]]]
"""What the page is told of a ghost (id, name, colours), and its flight (``close_up``, ``paths``)."""

WIDTH, MARGIN, GAP = 320.0, 8.0, 16.0
SEEN_BEFORE_S, SEEN_AFTER_S = 0.8, 0.8  # the box holds where everybody is from so long before 0 until so long after the closest approach
ROUNDING = 1e-3  # of a sample: instants are kept to a millionth of a second
CALM_MPS = 0.05
SAME_S = 0.02  # instants nearer than this are one
STROKES: Final = {"dot": "2 3", "dash": "7 4", "dashdot": "7 3 2 3", "longdash": "11 4"}
"""Dashes by their names in the plot library, as SVG has them."""
ICON_PX: Final = ((7.0, 0.0), (-5.0, 4.5), (-2.5, 0.0), (-5.0, -4.5))


def frames(ghosts: Ghosts, focus: int) -> list[dict[str, Any]]:
    """At detection, decision, closest approach of the focus and end: a title, a picture, and the clearance of every ghost."""
    told = ghosts[focus][1]["close_up"]
    to_track = _turned(told)
    box = _box(ghosts, told, to_track)
    return [
        {
            "title": title,
            "svg": _svg(ghosts, focus, at_s, box, to_track, title),
            "clearances": [_clearance_cell(flight["close_up"], at_s) for _, flight in ghosts],
        }
        for title, at_s in _instants(told)
    ]


def _instants(told: CloseUp) -> list[tuple[str, float]]:
    """What happens when, in the order of time; instants that coincide are told together."""
    end_s = (told["first"] + len(told["clearance_m"]) - 1) / told["hz"]
    begin_s = told["first"] / told["hz"]
    found = [("the planner decides" if told["zero_is"] == DECISION else told["zero_is"], 0.0)]
    if told["detected_s"] is not None and begin_s <= told["detected_s"] <= 0.0:
        found.append(("detected", told["detected_s"]))
    found += [("closest approach", told["nearest_s"]), ("afterwards", min(end_s, max(told["nearest_s"], 0.0) + SEEN_AFTER_S))]
    merged: dict[float, list[str]] = {}
    for name, at_s in sorted(found, key=lambda pair: (pair[1], pair[0])):
        near = next((other for other in merged if abs(other - at_s) < SAME_S), at_s)
        merged.setdefault(near, [])
        if name not in merged[near]:
            merged[near].append(name)
    return [(f"{words.capital(words.listed(names))}, {number(at_s, 2)} s", at_s) for at_s, names in merged.items()]


def clearance_at(told: CloseUp, at_s: float) -> float:
    """The logged clearance at the last sample that is not later; NaN outside of what was sampled."""
    k = math.floor(at_s * told["hz"] - told["first"] + ROUNDING)
    found = told["clearance_m"][k] if 0 <= k < len(told["clearance_m"]) else None
    return math.nan if found is None else float(found)


def _clearance_cell(told: CloseUp, at_s: float) -> dict[str, Any]:
    clearance = clearance_at(told, at_s)
    return {"text": number(clearance, 2), "bad": bool(inside(clearance))}


def _places(told: Mapping[str, Any]) -> list[Point | None]:
    """Points of ``x``, ``y``, ``z``; None where one is not known."""
    return [None if None in point else point for point in zip(told["x"], told["y"], told["z"], strict=True)]


def _row(told: CloseUp, at_s: float) -> int:
    """The coarse sample that is not later; the first or last one outside."""
    k = math.floor((at_s * told["hz"] - told["first"]) / EVERY + ROUNDING)
    return min(max(k, 0), len(told["x"]) - 1)


def _turned(told: CloseUp) -> Any:
    """From ENU to along the track at instant 0, to its left, and up; about where the focus is then."""
    places = [place for place in _places(told) if place is not None]
    k = min(_row(told, 0.0), len(places) - 1)
    (ax, ay, _), (bx, by, _) = places[max(0, k - 1)], places[min(len(places) - 1, k + 1)]
    length = math.hypot(bx - ax, by - ay) or 1.0
    c, s = (bx - ax) / length, (by - ay) / length
    ox, oy, _ = places[k]

    def to_track(point: Point) -> Point:
        x, y = point[0] - ox, point[1] - oy
        return c * x + s * y, -s * x + c * y, point[2]

    return to_track


def _box(ghosts: Ghosts, focus: CloseUp, to_track: Any) -> tuple[list[float], list[float]]:
    """Lowest and highest along, left and up of what is to be seen."""
    low, high = [math.inf] * 3, [-math.inf] * 3
    last_s = max(focus["nearest_s"], 0.0) + SEEN_AFTER_S

    def include(point: Point | None, radius: float) -> None:
        if point is not None:
            for k, amount in enumerate(to_track(point)):
                low[k], high[k] = min(low[k], amount - radius), max(high[k], amount + radius)

    for _, flight in ghosts:
        told = flight["close_up"]
        for place in _places(told)[_row(told, -SEEN_BEFORE_S) : _row(told, last_s) + 1]:
            include(place, 4.0)
    for obstacle in focus["obstacles"][:2]:
        for place in _places(obstacle)[_row(focus, 0.0) : _row(focus, last_s) + 1]:
            include(place, obstacle["radius_m"] + 2.0)
    return low, high


def _svg(ghosts: Ghosts, focus: int, at_s: float, box: tuple[list[float], list[float]], to_track: Any, title: str) -> Markup:
    low, high = box
    scale = (WIDTH - 2 * MARGIN) / max(high[0] - low[0], 1.0)
    tall = [scale * (high[k] - low[k]) + 2 * MARGIN for k in (1, 2)]
    parts = [
        f'<svg viewBox="0 0 {WIDTH:.0f} {sum(tall) + GAP:.0f}" role="img" aria-label="{escape(title)}: from above, and from the side">'
    ]
    for panel, (upward, name) in enumerate(((1, "from above"), (2, "from the side"))):
        top = panel * (tall[0] + GAP)

        def px(point: Point, upward: int = upward, top: float = top) -> tuple[float, float]:
            turned = to_track(point)
            return MARGIN + scale * (turned[0] - low[0]), top + MARGIN + scale * (high[upward] - turned[upward])

        clip = f"kf{panel}-{round(1000 * at_s)}"
        parts.append(f'<clipPath id="{clip}"><rect x="0" y="{top:.1f}" width="{WIDTH:.0f}" height="{tall[panel]:.1f}"/></clipPath>')
        parts.append(f'<rect class="kf-panel" x="0" y="{top:.1f}" width="{WIDTH:.0f}" height="{tall[panel]:.1f}" rx="6"/>')
        parts.append(f'<g clip-path="url(#{clip})">')
        parts += _obstacles(ghosts[focus][1]["close_up"], at_s, px, scale)
        for k, (ghost, flight) in enumerate(ghosts):
            if ghost["shown"]:
                parts += _ghost(ghost, flight["close_up"], at_s, px, k == focus)
        parts.append(f'</g><text x="{MARGIN:.0f}" y="{top + tall[panel] - 6:.1f}">{name}</text>')
    parts += _wind(ghosts[focus][1]["close_up"], at_s, to_track)
    length = 50.0 if scale * 50.0 < WIDTH / 2 else 10.0
    right, low_y = WIDTH - MARGIN, tall[0] - 8
    parts.append(f'<path class="kf-bar" d="M{right - scale * length:.1f} {low_y:.1f}H{right:.1f}"/>')
    parts.append(f'<text x="{right:.0f}" y="{low_y - 4:.1f}" text-anchor="end">{length:.0f} m</text></svg>')
    return Markup("".join(parts))


def _wind(told: CloseUp, at_s: float, to_track: Any) -> list[str]:
    """An arrow the way the air goes, and how fast and from where, in the upper right corner."""
    row = _row(told, at_s)
    east, north, _ = air = tuple(told["wind"][axis][row] or 0.0 for axis in "xyz")
    speed = math.hypot(east, north)
    right = WIDTH - MARGIN
    if speed < CALM_MPS:
        return [f'<text x="{right:.0f}" y="18" text-anchor="end">calm air</text>']
    here, there = to_track((0.0, 0.0, 0.0)), to_track(air)
    turn = math.degrees(math.atan2(here[1] - there[1], there[0] - here[0]))  # clockwise on paper, where y leads down
    said = f"wind {number(speed, 1)} m/s from {round(math.degrees(math.atan2(-east, -north))) % 360:03d}\N{DEGREE SIGN}"
    return [
        f'<text x="{right - 34:.0f}" y="18" text-anchor="end">{said}</text>',
        f'<path class="kf-wind" d="M-12 0H10M3 -5L11 0L3 5" transform="translate({right - 14:.0f} 16) rotate({turn:.0f})"/>',
    ]


def _line(points: Sequence[tuple[float, float]]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _obstacles(told: CloseUp, at_s: float, px: Any, scale: float) -> list[str]:
    """Spheres, red once they are decided about, with the cone of relative velocities that lead into each."""
    row, parts = _row(told, at_s), []
    own = _places(told)[row]
    threats = {one["obstacle"] for one in told["decisions"] if one["time_s"] <= at_s + ROUNDING}
    for obstacle in told["obstacles"]:
        places = _places(obstacle)
        centre, trail = places[row], [px(place) for place in places[: row + 1] if place is not None]
        if centre is None:
            continue
        (x, y), radius = px(centre), scale * obstacle["radius_m"]
        threat = obstacle["name"] in threats
        if threat and own is not None and at_s < told["nearest_s"]:
            parts += _cone(px(own), (x, y), radius)
        parts.append(f'<polyline class="kf-track" points="{_line(trail)}"/>')
        parts.append(f'<circle class="{"kf-threat" if threat else "kf-obstacle"}" cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"/>')
    parts += [
        '<circle class="kf-insertion" cx="{:.1f}" cy="{:.1f}" r="4"/>'.format(*px(tuple(one["insertion_enu_m"])))
        for one in told["decisions"]
        if one["insertion_enu_m"] and one["decision"] in AVOIDING and one["time_s"] <= at_s + ROUNDING
    ]
    return parts


def _cone(apex: tuple[float, float], centre: tuple[float, float], radius: float) -> list[str]:
    """A cone about a sphere looks, from anywhere, like the tangents to the sphere's outline."""
    dx, dy = centre[0] - apex[0], centre[1] - apex[1]
    far = math.hypot(dx, dy)
    if far <= radius:
        return []
    along, across = (far - radius**2 / far) / far, radius * math.sqrt(1.0 - (radius / far) ** 2) / far
    ends = [(apex[0] + along * dx - side * across * dy, apex[1] + along * dy + side * across * dx) for side in (1.0, -1.0)]
    return [f'<polygon class="kf-cone" points="{_line([apex, *ends])}"/>']


def _ghost(ghost: Mapping[str, Any], told: CloseUp, at_s: float, px: Any, is_focus: bool) -> list[str]:
    row, places = _row(told, at_s), _places(told)
    flown = [px(place) for place in places[: row + 1] if place is not None]
    if not flown:
        return []
    style = f'style="--l:{_colour(ghost["light"])};--d:{_colour(ghost["dark"])}"'
    dash = f' stroke-dasharray="{STROKES[ghost["dash"]]}"' if ghost["dash"] in STROKES else ""
    bad = " kf-inside" if inside(clearance_at(told, at_s)) else ""
    (x, y), (bx, by) = flown[-1], flown[-2] if len(flown) > 1 else (flown[-1][0] - 1.0, flown[-1][1])
    turn = math.degrees(math.atan2(y - by, x - bx))
    corners = " ".join(f"{a:g},{b:g}" for a, b in ICON_PX)
    return [
        f'<g class="kf-ghost{" kf-focus" if is_focus else ""}{bad}" {style}><polyline points="{_line(flown[::2] + flown[-1:])}"{dash}/>',
        f'<polygon points="{corners}" transform="translate({x:.1f} {y:.1f}) rotate({turn:.0f})">'
        f"<title>{escape(ghost['name'])}</title></polygon></g>",
    ]


def _colour(name: str) -> str:
    return "var(--ink)" if name == "ink" else name
