"""Random encounters for the contract tests: many of them conflicts, all outside the spheres."""

import numpy as np

from vosc import Obstacle, Own


def sized(rng, size):
    v = rng.normal(size=3)
    return size * v / np.linalg.norm(v)


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
