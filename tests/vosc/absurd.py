"""Scenes of finite but absurd numbers: an answer without NaN, or a refusal by name; never another exception, never a warning.

The numbers are those that break formulas (denormals, 1e-160 whose square is lost, 1e30, 1e300, equal vectors, zeros) among ordinary
ones. The tests of ``test_absurd.py`` run some; many more, in the background of a working day:

    python -m tests.vosc.absurd FIRST LAST

prints every kind of failure once, with how often it came and the first scene that had it: ``scene(Log(), n)`` runs it again.
"""

import dataclasses
import itertools
import math
import sys
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

import vosc
from vosc import Obstacle, Own, Refusal, cap, insertion_point, ph, threat, widest_join
from vosc.direction import OBJECTIVES, boundary_curves, cap_gap, choose, corner_points, point_on_cap, points_with_component
from vosc.encounter import closest_point, cone_margin
from vosc.insertion import major_obstacle
from vosc.methods import METHODS, avoid

SIZES = [0.0, 5e-324, 1e-310, 1e-300, 1e-160, 1e-154, 1e-30, 1e-15, 1e-12, 1e-9, 1.0, 1e5, 1e9, 1e15, 1e20, 9.9e29, 1e30]
BEYOND = [1e31, 1e150, 1e160, 1e300, 1.7e308]  # what is refused wherever it is a coordinate: rare, or few scenes would be left
LIBRARY = str(Path(vosc.__file__).parent)


class Draws:
    """Numbers and vectors of one scene; vectors come back, so that points coincide and velocities are equal."""

    def __init__(self, seed):
        self.rng, self.pool = np.random.default_rng(seed), []

    def number(self, size=250.0, share=0.3):
        if self.rng.random() > share:
            return float(self.rng.normal() * size)
        return float(self.rng.choice([-1.0, 1.0]) * self.rng.choice(BEYOND if self.rng.random() < 0.03 else SIZES))

    def size(self, size=30.0, share=0.3):
        return abs(self.number(size, share))

    def vector(self, size=250.0):
        if self.pool and self.rng.random() < 0.15:
            return self.pool[self.rng.integers(len(self.pool))]
        share = float(self.rng.choice([0.0, 0.1, 0.4, 0.9]))
        out = (0.0, 0.0, 0.0) if self.rng.random() < 0.08 else tuple(self.number(size, share) for _ in range(3))
        kind = self.rng.integers(12)
        if kind < 2:  # arrays and single precision are as good
            with np.errstate(all="ignore"):
                out = np.array(out, dtype=np.float32 if kind else np.float64)
        self.pool.append(out)
        return out


def wrong(value, name):
    """What in an answer is NaN, or an array that is not finite; ``None`` if nothing."""
    if isinstance(value, np.ndarray):
        return f"{name} not finite" if value.dtype.kind == "f" and not np.isfinite(value).all() else None
    if isinstance(value, float):
        return f"{name} NaN" if math.isnan(value) else None
    if isinstance(value, tuple | list):
        return next((w for part in value if (w := wrong(part, name))), None)
    if dataclasses.is_dataclass(value):
        return next((w for f in dataclasses.fields(value) if (w := wrong(getattr(value, f.name), f"{name}.{f.name}"))), None)
    return None


class Log:
    """What calls gave: answers and refusals counted, failures by kind with the first call that had it."""

    def __init__(self):
        self.answers, self.refusals, self.failures = Counter(), Counter(), {}
        self.scene = None

    def tried(self, name, call):
        """The answer, or ``None`` for a refusal by name or a failure."""
        try:
            out = call()
        except Refusal as refusal:
            self.refusals[name, type(refusal).__name__] += 1
            if len(str(refusal)) < 16:
                self.failed(f"{name}: a refusal without words")
            return None
        except Exception as error:  # whatever it is, it is a failure
            places = [f for f in traceback.extract_tb(error.__traceback__) if f.filename.startswith(LIBRARY)]
            place = f" at {Path(places[-1].filename).name}:{places[-1].lineno}" if places else ""
            self.failed(f"{name}: {type(error).__name__}: {str(error)[:60]}{place}")
            return None
        self.answers[name] += 1
        if what := wrong(out, name):
            self.failed(what)
        return out

    def claim(self, name, holds):
        if not holds:
            self.failed(name)

    def failed(self, kind):
        count, first = self.failures.get(kind, (0, self.scene))
        self.failures[kind] = count + 1, first

    def __str__(self):
        rows = [f"{count:5d} times, first in scene {first}: {kind}" for kind, (count, first) in self.failures.items()]
        return "\n".join(rows)


def drawn_obstacles(log, draws):
    own = log.tried("Own", lambda: Own(draws.vector(), draws.vector(60.0)))
    if own is None:
        return None, []
    obstacles = []
    for _ in range(int(draws.rng.choice([1, 2, 3, 5, 15]))):
        near = np.array(own.pos_m) + draws.rng.normal(size=3) * draws.rng.choice([1e-12, 1.0, 100.0, 1e20])
        place = near if draws.rng.random() < 0.6 else draws.vector()
        one = log.tried("Obstacle", lambda place=place: Obstacle(place, draws.vector(60.0), draws.size(20.0, 0.2)))
        obstacles += [] if one is None else [one]
    return own, obstacles


def method_calls(draws):
    """Every method as it is, and the options that change what is computed."""
    return [(m, {}) for m in METHODS] + [
        ("scoam", {"boundary": "exact", "consider": "all"}),
        ("scoam", {"consider": "all", "objective": "right_of_way"}),
        ("scoam", {"consider": "all", "objective": "least_climb_change"}),
        ("scoam", {"consider": "all", "objective": "goal", "goal": draws.vector()}),
        ("scoam", {"consider": "all", "corners_only": True}),
        ("scoam", {"consider": "all", "root": "nearer", "half_angle": "corrected"}),
        ("scoam", {"bearing_deg": draws.number(90.0)}),
        ("scoam", {"component": "z", "component_mps": draws.number(10.0)}),
        ("scoam", {"objective": "least_roll", "half_angle": "corrected", "bank_rad": draws.number(1.0)}),
        ("orca", {"horizon_s": draws.size(5.0)}),
        ("orca", {"keep_speed": False}),
        ("orca", {"responsibility": 0.5}),
        ("least_deflection", {"speed_range_mps": (draws.size(), draws.size(60.0))}),
        ("potential_field", {"gain": draws.size(1.0), "reach": draws.size(4.0), "goal": draws.vector()}),
        ("one_plane", {"plane": "vertical"}),
        ("one_plane", {"plane": "horizontal"}),
        ("interfered_fluid", {"rho": 0.05, "sigma": 20.0}),
        ("planes", {"n": int(draws.rng.integers(1, 30)), "offset_rad": draws.number(1.0)}),
    ]


def encounter(log, draws):
    """Every method and every function of an encounter, once."""
    own, obstacles = drawn_obstacles(log, draws)
    if not obstacles:
        return
    for method, options in method_calls(draws):
        if options.get("keep_speed", True) or len(obstacles) < 12:
            log.tried(f"avoid {method} {' '.join(options)}", lambda m=method, o=options: avoid(m, own, obstacles, **o))
    log.tried("major_obstacle", lambda: major_obstacle(own, obstacles))
    for objective, boundary in itertools.product(OBJECTIVES, ("exact", "paper")):
        goal = draws.vector() if objective == "goal" else None
        log.tried(f"choose {objective} {boundary}", lambda o=objective, b=boundary, g=goal: choose(own, obstacles, o, b, g))
    for o in obstacles[:2]:
        for call in (threat, cap, closest_point, insertion_point):
            log.tried(call.__name__, lambda call=call, o=o: call(own, o))
        for drawn in (boundary_curves, cap_gap):
            log.tried(drawn.__name__, lambda drawn=drawn, o=o: drawn(own, o, n=12))
        log.tried("insertion_point behind", lambda o=o: insertion_point(own, o, 1.0 + draws.size(1.0), "arrival", "behind", "forward"))
        log.tried("insertion_point as printed", lambda o=o: insertion_point(own, o, 1.0 + draws.size(1.0), "paper_4_3_2"))
        log.tried("cone_margin", lambda o=o: cone_margin(own.pos_m, own.vel_mps, o))
    caps = [c for c in (log.tried("cap", lambda o=o: cap(own, o)) for o in obstacles[:2]) if c is not None]
    for c in caps:
        log.tried("point_on_cap", lambda c=c: point_on_cap(c, draws.number(1.0)))
        log.tried("points_with_component", lambda c=c: points_with_component(c, 0, draws.number()))
    if len(caps) == 2:
        log.tried("corner_points", lambda: corner_points(*caps, math.hypot(*own.vel_mps)))


def use(log, draws, curve):
    """Everything a curve can be asked."""
    length = curve.length_m
    s = np.array([0.0, 0.2, 0.5, 1.0]) * length
    log.tried("Curve.length_m", lambda: (length, curve.min_radius_m, curve.min_speed, curve.climb_range_rad()))
    bend = log.tried("Curve.max_curvature", curve.max_curvature)
    log.claim("Curve.max_curvature infinite without a cusp", bend is None or bend < math.inf or curve.min_speed < 1e-12)
    for call in (curve.frame, curve.point, curve.tangent, curve.curvature):
        log.tried(f"Curve.{call.__name__}", lambda call=call: [np.array(k) for x in (*s.tolist(), draws.number()) for k in (call(x),)])
    log.tried("Curve.sample", lambda: curve.sample(s))
    log.tried("Curve.points", lambda: curve.points(np.append(s, draws.number())))
    log.tried("Curve.tail", lambda: curve.tail(0.4 * length).climb_range_rad())
    log.tried("Curve.nearest", lambda: curve.nearest(np.array([draws.vector(), draws.vector(), (1.0, 2.0, 3.0)], dtype=float)))


def path(log, draws):
    """Every function of ``ph`` and the widest join, once."""
    ends = tuple(draws.vector() for _ in range(4))
    curve = log.tried("hermite", lambda: ph.hermite(*ends))
    if curve is not None:
        use(log, draws, curve)
    a, unit = [draws.vector() for _ in range(draws.rng.choice([3, 4]))], draws.rng.normal(size=3)
    made = log.tried("Curve", lambda: ph.Curve(tuple(draws.vector()), tuple(unit / np.linalg.norm(unit)), tuple(map(tuple, a))))
    if made is not None:
        use(log, draws, made)
    rows = [np.array([x, (1.0, 2.0, 3.0), draws.vector()], dtype=float) for x in (*ends, draws.vector(0.01))]
    for name, given in (("hermite_many", rows[:4]), ("hermite_many with a bend", rows)):
        made = log.tried(name, lambda given=given: {"rows": ph.hermite_many(*given)})  # a dict is not looked into: lost rows are NaN
        if made is None:
            continue
        many = made["rows"]
        lost = np.isnan(many.length_m())
        log.claim(f"{name}: a row lost by half", (np.isnan([*many.e, *(c for p in many.a for c in p)]).all(axis=0) == lost).all())
        log.tried(f"{name}, evaluated", lambda many=many, lost=lost: tuple(x[~lost] for x in many.evaluate(np.linspace(0.0, 1.0, 5))))
        one = log.tried(f"{name}, one of it", lambda many=many: many.curve(0))
        if one is not None:
            use(log, draws, one)
    if log.scene % 8 == 0:  # the two searches take longer than all the rest
        join = log.tried("widest_join", lambda: widest_join(*ends))
        if join is not None:
            log.tried("Join.frames", lambda: (join.frames(7), join.points(3)))
    if log.scene % 4 == 0:
        fly(log, draws, ends)


def fly(log, draws, ends):
    """The search for a flyable path, once."""
    limits = log.tried(
        "Limits",
        lambda: ph.Limits(draws.size(50.0, 0.1), draws.size(0.01), -draws.size(0.2, 0.2), draws.size(0.2, 0.2), draws.size(0.5)),
    )
    if limits is not None:
        bend = None if draws.rng.random() < 0.5 else draws.vector(0.01)
        log.tried("flyable", lambda: ph.flyable(*ends, limits, bend, grid=3))


def scene(log, number):
    """One encounter and one path."""
    log.scene = number
    encounter(log, Draws([number, 1]))
    path(log, Draws([number, 2]))


def main():
    first, last = (int(x) for x in sys.argv[1:3])
    warnings.simplefilter("error")
    log, start = Log(), time.process_time()
    for number in range(first, last):
        scene(log, number)
    print(log)
    calls = log.answers.total() + log.refusals.total()
    print(f"scenes {first} to {last}: {calls} calls, {log.refusals.total()} refused, {sum(n for n, _ in log.failures.values())} failures")
    print(f"{time.process_time() - start:.0f} s of processor time")
    return 1 if log.failures else 0


if __name__ == "__main__":
    sys.exit(main())
