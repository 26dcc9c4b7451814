"""Random encounters for the contract tests: many of them conflicts, all outside the spheres."""

import numpy as np

from vosc import Obstacle, Own


def sized(rng, size):
    v = rng.normal(size=3)
    return size * v / np.linalg.norm(v)


def awkward(rng, count, kind):
    """``count`` obstacles, most of them far, in a way in which pruning could go wrong; ``kind`` 0 to 7."""
    own, drawn = encounter(rng, count)
    here = np.array(own.pos_m)
    out = []
    for k, o in enumerate(drawn):
        offset, velocity, radius = np.subtract(o.pos_m, here), np.array(o.vel_mps), o.radius_m
        offset = offset * (1.0 if k % 6 == 0 else rng.uniform(2.0, 30.0))
        if kind == 1:  # on a grid: many ties
            offset, velocity, radius = np.round(offset, -1) + np.array((60.0, 0.0, 0.0)), np.round(velocity, -1), 10.0
        elif kind == 2:  # no relative motion
            velocity = np.array(own.vel_mps) if k % 3 == 0 else velocity
        elif kind == 3 and k % 5 == 0:  # spheres that are touched, to rounding
            radius = np.linalg.norm(offset) * (1.0 - 10.0 ** -rng.uniform(3.0, 13.0))
        elif kind == 4:  # cones that graze the velocity
            ahead = np.array(own.vel_mps) - velocity
            side = np.cross(ahead, sized(rng, 1.0))
            offset = 3.0 * ahead + side / np.linalg.norm(side) * radius * (1.0 + rng.choice([0.0, 1e-12, -1e-12, 1e-7, -1e-7, 1e-3]))
        elif kind == 5:  # as fast as the own aircraft
            velocity = velocity / max(np.linalg.norm(velocity), 1e-9) * 50.0
        elif kind == 6:  # sizes of many magnitudes
            offset, radius = offset * 10.0 ** rng.uniform(-3.0, 9.0), radius * 10.0 ** rng.uniform(-3.0, 3.0)
        out += [Obstacle(here + offset, velocity, radius)] * (2 if kind == 7 else 1)
    return own, [o for o in out if np.linalg.norm(np.subtract(o.pos_m, here)) >= o.radius_m]


def encounter(rng, count):
    """``count`` obstacles round an own aircraft at 50 m/s; two of three are aimed to pass within some 20 m in 1 to 4 s."""
    own = Own(rng.normal(size=3) * 100.0, sized(rng, 50.0))
    obstacles = []
    while len(obstacles) < count:
        velocity = sized(rng, rng.uniform(0.0, 80.0)) * (rng.random() > 0.1)
        if rng.random() < 2 / 3:
            offset = (np.array(own.vel_mps) - velocity) * rng.uniform(1.0, 4.0) + 20.0 * rng.normal(size=3)
        else:
            offset = sized(rng, rng.uniform(40.0, 150.0))
        radius = rng.uniform(5.0, 35.0)
        if np.linalg.norm(offset) > radius * 1.02:
            obstacles.append(Obstacle(np.array(own.pos_m) + offset, velocity, radius))
    return own, obstacles
