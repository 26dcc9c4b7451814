"""Draws ``insertion_pose.svg``: ``python docs/insertion_pose.py``.

The paper's pose of section 5.1 (first row of the table in insertion_pose.md): the canonical PH quintic with end tangents of one chord,
as the paper's curve is read here, beside the widest one. Left, seen from above; right, the turn that they ask for at 50 m/s, V^2 kappa / g.
"""

import math
from pathlib import Path

import numpy as np

from testbed.core.frames import unit_from_direction
from testbed.core.units import G0_MPS2
from vosc import ph, widest_join

HERE = Path(__file__).parent
START, ALONG = (162.0, 101.0, 64.3), (24.7, 12.0)  # P_t; azimuth and elevation, deg
END, THERE = (226.34, 159.56, 79.05), (36.6, 13.2)
SPEED_MPS = 50.0
PH, WIDEST, AXIS = "#c44e52", "#4c72b0", "#777"
WIDTH, HEIGHT = 300, 260
MOST_G = 5.0


def curves() -> list[tuple[str, str, np.ndarray, np.ndarray, np.ndarray]]:
    """Name, colour, arc lengths (n,), points (n,3) and curvatures (n,) of each."""
    chord = math.dist(START, END)
    along, there = unit_from_direction(*ALONG), unit_from_direction(*THERE)
    quintic = ph.hermite(START, [chord * c for c in along], END, [chord * c for c in there])
    s = np.linspace(0.0, quintic.length_m, 200)
    points, _, bend = quintic.sample(s)
    join = widest_join(START, along, END, there)
    wide_points, _, wide_bend = join.frames(200)
    wide_s = np.linspace(0.0, join.length_m, 200)
    return [
        (f"PH quintic, {quintic.min_radius_m:.1f} m", PH, s, points, np.linalg.norm(bend, axis=1)),
        (f"widest, {join.radius_m:.1f} m", WIDEST, wide_s, wide_points, np.linalg.norm(wide_bend, axis=1)),
    ]


def line(x: np.ndarray, y: np.ndarray, colour: str) -> str:
    """A polyline through picture coordinates."""
    through = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return f'<polyline points="{through}" fill="none" stroke="{colour}" stroke-width="1.8"/>'


def text(x: float, y: float, words: str, colour: str = "#222", anchor: str = "start") -> str:
    """A label."""
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="11" fill="{colour}" text-anchor="{anchor}">{words}</text>'


def from_above() -> list[str]:
    """East to the right, north up, equal scales."""
    scale = 2.9
    out = [text(8, 15, "from above, m east and north")]
    for name, colour, _, points, _ in curves():
        x, y = 30 + scale * (points[:, 0] - START[0]), HEIGHT - 50 - scale * (points[:, 1] - START[1])
        out += [line(x, y, colour), text(150, HEIGHT - (14 if colour == PH else 30), name, colour)]
    for place, tangent, label in ((START, ALONG, "P_t"), (END, THERE, "Q")):
        x, y = 30 + scale * (place[0] - START[0]), HEIGHT - 50 - scale * (place[1] - START[1])
        dx, dy, _ = unit_from_direction(*tangent)
        out.append(f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{x + 40 * dx:.1f}" y2="{y - 40 * dy:.1f}" stroke="#000" stroke-dasharray="3 2"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5"/>', text(x - 6, y + 16, label)]
    return out


def demanded() -> list[str]:
    """Over the arc length."""
    left, bottom, wide, high = 30, HEIGHT - 34, WIDTH - 44, HEIGHT - 64
    longest = max(s[-1] for _, _, s, _, _ in curves())
    out = [text(8, 15, "turn asked for at 50 m/s, g, over m of arc")]
    for g in range(int(MOST_G) + 1):
        y = bottom - high * g / MOST_G
        out.append(f'<line x1="{left}" y1="{y:.1f}" x2="{left + wide}" y2="{y:.1f}" stroke="#ccc" stroke-width="0.6"/>')
        out.append(text(left - 5, y + 4, str(g), AXIS, "end"))
    for metres in range(0, int(longest) + 1, 20):
        out.append(text(left + wide * metres / longest, bottom + 15, str(metres), AXIS, "middle"))
    for _, colour, s, _, curvature in curves():
        turn = SPEED_MPS**2 * curvature / G0_MPS2
        out.append(line(left + wide * s / longest, bottom - high * turn / MOST_G, colour))
    return out


def picture() -> str:
    """The SVG."""
    panels = [
        f'<g transform="translate({k * (WIDTH + 12)},0)"><rect width="{WIDTH}" height="{HEIGHT}" fill="#f7f7f5"/>{"".join(panel)}</g>'
        for k, panel in enumerate((from_above(), demanded()))
    ]
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * WIDTH + 12}" height="{HEIGHT}" font-family="sans-serif">'
    return "\n".join([head, *panels, "</svg>"]) + "\n"


if __name__ == "__main__":
    (HERE / "insertion_pose.svg").write_text(picture(), encoding="utf-8")
