"""How long the planner library takes on one core: ``python tests/benchmarks/bench_vosc.py [--scenes N]``, not a test.

Scenes are fixed by their seed: obstacles uniform in a cube round the own aircraft (which flies 50 m/s), radii and speeds uniform in
the ranges stated, none nearer than 1.2 radii; only scenes in which the present velocity is inside some cone are kept, because a
clear one costs the threat test alone. Each scene is timed three times and the least counts; the table gives median and 90th
percentile over the scenes. RVO2-3D (jt-pyrvo23d, optional) decides for every agent of a step, so its time is a step's divided by
the agents.
"""

import argparse
import importlib.util
import math
import os
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vosc import Obstacle, Own, ph, threat
from vosc.methods import METHODS, avoid


@dataclass(frozen=True)
class Scene:
    """Count, edge of the cube (m), radii (m), speeds (m/s), seed."""

    count: int
    edge_m: float
    radius_m: tuple[float, float] = (15.0, 30.0)
    speed_mps: tuple[float, float] = (0.0, 50.0)
    seed: int = 20210


SCENES = {
    "1 obstacle": Scene(1, 250.0),
    "10 obstacles": Scene(10, 800.0),
    "10 obstacles, dense": Scene(10, 130.0),
    "100 obstacles": Scene(100, 2500.0),
    "1000 obstacles": Scene(1000, 8000.0),
    "1000 obstacles, dense": Scene(1000, 400.0),
}
LIMITS_US = {("scoam", "1 obstacle"): 60.0, ("least_deflection", "10 obstacles"): 400.0, ("least_deflection", "1000 obstacles"): 10_000.0}


def draw(scene: Scene, number: int) -> list[tuple[Own, list[Obstacle]]]:
    """``number`` encounters with at least one threat."""
    rng = np.random.default_rng(scene.seed)
    out: list[tuple[Own, list[Obstacle]]] = []
    while len(out) < number:
        heading = rng.normal(size=3)
        own = Own((0.0, 0.0, 0.0), 50.0 * heading / np.linalg.norm(heading))
        obstacles: list[Obstacle] = []
        while len(obstacles) < scene.count:
            pos, radius = rng.uniform(-0.5, 0.5, 3) * scene.edge_m, rng.uniform(*scene.radius_m)
            course = rng.normal(size=3)
            if np.linalg.norm(pos) > 1.2 * radius:
                obstacles.append(Obstacle(pos, rng.uniform(*scene.speed_mps) * course / np.linalg.norm(course), radius))
        if any(threat(own, o).is_threat for o in obstacles):
            out.append((own, obstacles))
    return out


def least_of(call: Callable[[], object], times: int = 3) -> float:
    """Least time of a few calls, us."""
    spent = []
    for _ in range(times):
        start = time.perf_counter()
        call()
        spent.append(time.perf_counter() - start)
    return 1e6 * min(spent)


def methods(number: int) -> None:
    print(f"\n{'scene':24s}{'threats':>8s}{'method':>23s}{'median us':>11s}{'90 % us':>10s}  limit")
    for name, scene in SCENES.items():
        drawn = draw(scene, max(10, number // (10 if scene.count >= 1000 else 1)))
        threats = np.mean([sum(threat(own, o).is_threat for o in obstacles) for own, obstacles in drawn])
        for method in (
            METHODS
            if scene.count <= 10
            else ("scoam", "least_deflection", "droam_hp", *(("orca", "planes") if scene.edge_m > 1000.0 else ()))
        ):
            spent = [least_of(lambda m=method, e=encounter: avoid(m, *e)) for encounter in drawn]
            limit = LIMITS_US.get((method, name))
            verdict = "" if limit is None else f"{limit:8.0f} {'kept' if np.median(spent) < limit else 'MISSED'}"
            print(f"{name:24s}{threats:8.1f}{method:>23s}{np.median(spent):11.1f}{np.percentile(spent, 90):10.1f}  {verdict}")
        if importlib.util.find_spec("rvo23d"):
            spent = [rvo(*encounter) for encounter in drawn]
            print(f"{name:24s}{threats:8.1f}{'RVO2-3D (C++)':>23s}{np.median(spent):11.2f}{np.percentile(spent, 90):10.2f}")


def rvo(own: Own, obstacles: list[Obstacle]) -> float:
    """Time of one RVO2-3D decision, us."""
    return least_of(rvo_step(own, obstacles)) / (len(obstacles) + 1)


def rvo_step(own: Own, obstacles: list[Obstacle]) -> Callable[[], object]:
    """One step of RVO2-3D, in which all decide: neighbours unlimited, horizon 5 s."""
    import rvo23d

    everyone = len(obstacles) + 1
    sim = rvo23d.PyRVOSimulator(1.0 / 60.0, 1e5, everyone, 5.0, 0.0, 50.0)
    sim.addAgent(own.pos_m, 1e5, everyone, 5.0, 0.0, 50.0, own.vel_mps)
    for o in obstacles:
        sim.addAgent(o.pos_m, 1e5, everyone, 5.0, o.radius_m, 50.0, o.vel_mps)
    step: Callable[[], object] = sim.doStep
    return step


def paths() -> None:
    chord = math.dist((0, 0, 0), (500, 200, 100))
    ends = (0.0, 0.0, 0.0), (0.7 * chord, 0.6 * chord, 0.4 * chord), (500.0, 200.0, 100.0), (chord, 0.2 * chord, 0.05 * chord)
    curve = ph.hermite(*ends)
    s = np.linspace(0.0, curve.length_m, 600)
    near = curve.sample(s)[0] + np.random.default_rng(1).normal(size=(600, 3))
    rows = np.random.default_rng(2).normal(size=(4, 200_000, 3))
    limits = ph.Limits(50.0, max_curvature_per_m=1 / 150, max_bank_rate_radps=1.5)
    table = [
        ("ph.hermite", least_of(lambda: [ph.hermite(*ends) for _ in range(200)]) / 200, 20.0),
        ("curve.frame, warm", least_of(lambda: [curve.frame(x) for x in s]) / 600, None),
        ("curve.sample of 600", least_of(lambda: curve.sample(s), 20), 1000.0),
        ("curve.nearest of 600", least_of(lambda: curve.nearest(near), 5), None),
        ("curve.max_curvature, cold", least_of(lambda: ph.hermite(*ends).max_curvature(), 50), None),
        ("ph.flyable", least_of(lambda: ph.flyable((0, 0, 0), (1, 0, 0), (400, 100, 20), (1, 0.3, 0), limits, (0, 0, 0)), 5), None),
        ("ph.hermite_many, a row of 200,000", least_of(lambda: ph.hermite_many(*rows), 5) / 200_000, 1.0),
    ]
    print(f"\n{'path':36s}{'us':>10s}  limit")
    for name, us, limit in table:
        print(f"{name:36s}{us:10.2f}  {'' if limit is None else f'{limit:8.0f} ' + ('kept' if us < limit else 'MISSED')}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=200, help="encounters per scene (a tenth of it with 1000 obstacles)")
    arguments = parser.parse_args()
    print(f"python {platform.python_version()}, numpy {np.__version__}, {platform.machine()}, {os.cpu_count()} cores")
    for name, scene in SCENES.items():
        print(f"  {name}: {scene}")
    methods(arguments.scenes)
    paths()


if __name__ == "__main__":
    main()
