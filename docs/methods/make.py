"""Writes the pictures and the tables of this folder: ``python docs/methods/make.py [--encounters N] [--scenes N]``.

Pictures: the velocity sphere seen along the present velocity, azimuthal equidistant (distance from the centre is the angle to v_u,
up is up), for the paper's single case (reading azimuth_106) and for its two obstacles (Table 3 with the elevation of O_2 positive,
so that both are threats).

Table: status of every method on random encounters with 1 to 6 obstacles, fixed by seed, all with the present velocity inside some cone.

Times: the scenes of ``tests/benchmarks/bench_vosc.py``, process time, every method and RVO2-3D (the package jt-pyrvo23d) on each scene in
turn, the least of three calls. RVO2-3D decides for every agent of a step, so its time is a step's divided by the agents (with 1000
obstacles: of one step, which takes seconds).
"""

import argparse
import importlib.util
import math
import platform
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

import numpy as np

from vosc import Obstacle, Own, cap
from vosc.direction import boundary_curves, point_on_cap
from vosc.methods import METHODS, avoid

HERE = Path(__file__).parent
SIZE, REACH_DEG = 300, 60.0
SEED, ENCOUNTERS = 20210, 10_000


def polar(size: float, azimuth_deg: float, elevation_deg: float) -> tuple[float, float, float]:
    """Vector of a size and a direction."""
    a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return (size * math.cos(e) * math.cos(a), size * math.cos(e) * math.sin(a), size * math.sin(e))


OWN = Own((162, 101, 64.3), polar(50, 24.7, 12.0))
SINGLE = [Obstacle((254, 63.6, 60.7), polar(40, 106.0, 12.4), 25)]
DOUBLE = [Obstacle((254, 63.8, 59.8), polar(35, 106.0, 11.4), 25), Obstacle((208, 186, 42.5), polar(32, -50.3, 15.4), 30)]


def seen_from(own: Own, velocities: np.ndarray) -> np.ndarray:
    """Picture coordinates (n,2), degrees: right, up."""
    ahead = np.array(own.vel_mps) / np.linalg.norm(own.vel_mps)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    v = velocities / np.linalg.norm(velocities, axis=1)[:, None]
    x, y, z = v @ right, v @ up, v @ ahead
    angle = np.degrees(np.arctan2(np.hypot(x, y), z))
    return np.stack([x, y], axis=1) / np.maximum(np.hypot(x, y), 1e-15)[:, None] * angle[:, None]


def path(points: np.ndarray, style: str) -> str:
    """A closed line through picture coordinates."""
    scale = 0.5 * SIZE / REACH_DEG
    pixels = [f"{0.5 * SIZE + scale * x:.1f},{0.5 * SIZE - scale * y:.1f}" for x, y in points]
    return f'<polygon points="{" ".join(pixels)}" {style}/>'


def panel(method: str, own: Own, obstacles: list[Obstacle], offset: int, title: str) -> list[str]:
    """One half of the picture."""
    middle, scale = 0.5 * SIZE, 0.5 * SIZE / REACH_DEG
    out = [f'<g transform="translate({offset},22)" clip-path="url(#frame)">', f'<rect width="{SIZE}" height="{SIZE}" fill="#f7f7f5"/>']
    for colour, obstacle in zip(("#c44e52", "#4c72b0"), obstacles, strict=False):
        for curve in boundary_curves(own, obstacle, n=120):
            out.append(path(seen_from(own, curve), f'fill="{colour}" fill-opacity="0.25" stroke="{colour}" stroke-width="1.2"'))
        found = cap(own, obstacle)
        if found is not None:
            circle = np.array([point_on_cap(found, 2.0 * math.pi * k / 120) for k in range(120)])
            out.append(path(seen_from(own, circle), f'fill="none" stroke="{colour}" stroke-width="1" stroke-dasharray="4 3"'))
    for ring in range(10, int(REACH_DEG) + 1, 10):
        out.append(f'<circle cx="{middle:.1f}" cy="{middle:.1f}" r="{ring * scale:.1f}" fill="none" stroke="#999" stroke-width="0.4"/>')
        out.append(f'<text x="{middle + 2:.1f}" y="{middle - ring * scale + 9:.1f}" font-size="8" fill="#777">{ring}°</text>')
    answer = avoid(method, own, obstacles)
    ((x, y),) = seen_from(own, np.array([answer.velocity_mps]))
    px, py = middle + scale * x, middle - scale * y
    out.append(f'<path d="M{middle - 5:.1f} {middle:.1f}h10M{middle:.1f} {middle - 5:.1f}v10" stroke="#000" stroke-width="1.5"/>')
    out.append(f'<line x1="{middle:.1f}" y1="{middle:.1f}" x2="{px:.1f}" y2="{py:.1f}" stroke="#000" stroke-width="1"/>')
    fill = {"avoided": "#2a7a2a", "unsafe": "#d00000"}.get(answer.status, "#888")
    out.append(f'<circle cx="{px:.1f}" cy="{py:.1f}" r="4.5" fill="{fill}" stroke="#fff"/></g>')
    label = f"{title}: {answer.status}, {math.degrees(answer.deflection_rad):.2f}°"
    out.append(f'<text x="{offset + 4}" y="15" font-size="12" fill="#222">{label}</text>')
    return out


def picture(method: str) -> str:
    """The SVG of one method."""
    head = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * SIZE + 12}" height="{SIZE + 24}" font-family="sans-serif">',
        f'<clipPath id="frame"><rect width="{SIZE}" height="{SIZE}"/></clipPath>',
    ]
    body = panel(method, OWN, SINGLE, 0, "one obstacle") + panel(method, OWN, DOUBLE, SIZE + 12, "two obstacles")
    return "\n".join([*head, *body, "</svg>"]) + "\n"


def sized(rng: np.random.Generator, size: float) -> np.ndarray:
    """A vector of that size in a random direction."""
    v = rng.normal(size=3)
    return size * v / np.linalg.norm(v)


def encounter(rng: np.random.Generator, count: int) -> tuple[Own, list[Obstacle]]:
    """Two of three obstacles are aimed to pass within some 20 m in 1 to 4 s; radii 5-35 m, speeds 0-80 m/s, own speed 50 m/s."""
    own, obstacles = Own((0.0, 0.0, 0.0), sized(rng, 50.0)), []
    while len(obstacles) < count:
        velocity, radius = sized(rng, rng.uniform(0.0, 80.0)), rng.uniform(5.0, 35.0)
        aimed = (np.array(own.vel_mps) - velocity) * rng.uniform(1.0, 4.0) + 20.0 * rng.normal(size=3)
        offset = aimed if rng.random() < 2 / 3 else sized(rng, rng.uniform(40.0, 150.0))
        if np.linalg.norm(offset) > 1.02 * radius:
            obstacles.append(Obstacle(offset, velocity, radius))
    return own, obstacles


CASES: list[tuple[str, dict[str, object]]] = [(m, {}) for m in METHODS]
CASES[2:2] = [
    ("scoam", {"root": "nearer", "half_angle": "corrected"}),
    ("scoam", {"consider": "all"}),
    ("scoam", {"boundary": "exact", "consider": "all"}),
]


@dataclass
class Tally:
    """Statuses with one obstacle and with several, margins (rad) of unsafe answers, excess (rad) of safe ones over the least deflection."""

    one: Counter[str] = field(default_factory=Counter)
    several: Counter[str] = field(default_factory=Counter)
    margins: list[float] = field(default_factory=list)
    excess: list[float] = field(default_factory=list)


def measure(number: int) -> list[Tally]:
    """One tally per case."""
    rng = np.random.default_rng(SEED)
    out = [Tally() for _ in CASES]
    done = 0
    while done < number:
        own, obstacles = encounter(rng, int(rng.integers(1, 7)))
        least = avoid("least_deflection", own, obstacles)
        if least.status == "clear":
            continue
        done += 1
        for (method, options), tally in zip(CASES, out, strict=True):
            answer = avoid(method, own, obstacles, **options)
            (tally.one if len(obstacles) == 1 else tally.several)[answer.status] += 1
            if answer.status == "unsafe":
                tally.margins.append(answer.margin_rad)
            elif answer.status == "avoided":
                tally.excess.append(answer.deflection_rad - least.deflection_rad)
    return out


def table(measured: list[Tally], number: int) -> str:
    """The page of rates."""
    singles = measured[0].one.total()
    rows = [
        "# How often each method is safe",
        "",
        f"Written by `make.py`: {number} random encounters, seed {SEED}, {singles} with one obstacle and {number - singles} with 2 to 6,",
        "in all of which the present velocity is inside a cone. Own speed 50 m/s, obstacles 0-80 m/s, radii 5-35 m, two of three aimed to",
        "pass within some 20 m in 1 to 4 s; default options unless named.",
        "",
        "`unsafe`: the method's own formula gives a velocity inside an exact cone. `undefined`: its construction does not exist. Margin:",
        "median of the unsafe answers. Excess: median and 95th percentile of the deflection above the least possible, of the safe answers.",
        "",
        "| method | one: unsafe % | undefined % | several: unsafe % | undefined % | margin when unsafe | excess, median | 95 % |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for (method, options), tally in zip(CASES, measured, strict=True):
        shares = [f"{100 * c[s] / c.total():.2f}" for c in (tally.one, tally.several) for s in ("unsafe", "undefined")]
        margin = f"{math.degrees(float(np.median(tally.margins))):.2f}°" if tally.margins else "-"
        excess = [f"{math.degrees(float(np.percentile(tally.excess, q))):.2f}°" if tally.excess else "-" for q in (50, 95)]
        name = f"[{method}]({method}.md)" + (f" {', '.join(f'{k}={v}' for k, v in options.items())}" if options else "")
        rows.append(f"| {' | '.join([name, *shares, margin, *excess])} |")
    return "\n".join(rows) + "\n"


TIMED = {
    "10 obstacles": ("scoam", "least_deflection", "orca", "planes", "droam_hp"),
    "100 obstacles": ("scoam", "least_deflection", "orca", "planes", "droam_hp"),
    "1000 obstacles": ("scoam", "least_deflection", "orca", "planes", "droam_hp"),
}
CROWDED, FEW = 1000, 5  # from so many obstacles on: so many scenes, because a step of RVO2-3D takes seconds
TIMES_TITLE = "## How long an answer takes"


def bench() -> ModuleType:
    """The scenes of the benchmark."""
    spec = importlib.util.spec_from_file_location("bench_vosc", HERE.parents[1] / "tests" / "benchmarks" / "bench_vosc.py")
    if spec is None or spec.loader is None:
        raise FileNotFoundError("tests/benchmarks/bench_vosc.py")
    sys.modules["bench_vosc"] = module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def least_us(call: Callable[[], object], calls: int = 3) -> float:
    """Least process time of a few calls, us."""
    spent = []
    for _ in range(calls):
        start = time.process_time()
        call()
        spent.append(time.process_time() - start)
    return 1e6 * min(spent)


def times(number: int) -> str:
    """The section of times: medians over ``number`` scenes (fewer of the largest), and multiples of RVO2-3D's."""
    scenes, few = bench(), min(number, FEW)
    rows = [
        TIMES_TITLE,
        "",
        f"Written by `make.py --scenes {number}`: process time of `avoid`, us, "
        f"median over {number} scenes ({few} with {CROWDED} obstacles),",
        "and how many times that of RVO2-3D (C++, one agent's decision, no limit on neighbours), "
        "measured on the same scenes in the same run;",
        f"jt-pyrvo23d {version('jt-pyrvo23d')}, python {platform.python_version()}, numpy {np.__version__}, {platform.machine()}.",
        "",
        "| scene | RVO2-3D | " + " | ".join(TIMED["10 obstacles"]) + " |",
        "|---|---|" + "---|" * len(TIMED["10 obstacles"]),
    ]
    for name, methods in TIMED.items():
        scene = scenes.SCENES[name]
        spent: dict[str, list[float]] = {m: [] for m in ("rvo", *methods)}
        crowded = scene.count >= CROWDED
        for own, obstacles in scenes.draw(scene, few if crowded else number):
            step = scenes.rvo_step(own, obstacles)
            spent["rvo"].append(least_us(step, 1 if crowded else 3) / (len(obstacles) + 1))  # of a thousand agents: a mean already
            for m in methods:
                spent[m].append(least_us(lambda m=m, own=own, obstacles=obstacles: avoid(m, own, obstacles)))  # type: ignore[misc]
        middle = {m: float(np.median(v)) for m, v in spent.items()}
        cells = [f"{middle[m]:.0f} ({middle[m] / middle['rvo']:.1f})" for m in methods]
        rows.append(f"| {name} | {middle['rvo']:.1f} | {' | '.join(cells)} |")
    return "\n".join(rows) + "\n"


def main() -> None:
    """Write everything."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--encounters", type=int, default=ENCOUNTERS, help="0 leaves the table as it is")
    parser.add_argument(
        "--scenes", type=int, default=0, help="scenes to time the methods on (0, the default, leaves the times as they are)"
    )
    arguments = parser.parse_args()
    number, page = arguments.encounters, HERE / "rates.md"
    rates, _, kept = page.read_text(encoding="utf-8").partition(TIMES_TITLE)
    for method in METHODS:
        (HERE / f"{method}.svg").write_text(picture(method), encoding="utf-8")
    rates = table(measure(number), number) if number else rates.rstrip() + "\n"
    timed = times(arguments.scenes) if arguments.scenes else TIMES_TITLE + kept
    page.write_text(f"{rates}\n{timed}", encoding="utf-8")


if __name__ == "__main__":
    main()
