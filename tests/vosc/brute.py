"""Brute force over the velocity sphere, sharing no code with vosc: miss distances of straight lines, polar sampling, local zoom."""

import numpy as np


def forbidden(own, obstacles, velocities):
    """(n,) does the straight line with each velocity (n,3) pass within R of some obstacle, in the future?"""
    hit = np.zeros(len(velocities), bool)
    for o in obstacles:
        p = np.subtract(o.pos_m, own.pos_m)
        w = velocities - np.array(o.vel_mps)
        closing = w @ p
        square = np.einsum("ij,ij->i", w, w)
        miss2 = p @ p - closing**2 / np.where(square > 1e-20, square, np.inf)
        hit |= (closing > 0) & (miss2 < o.radius_m**2)
    return hit


def around(own):
    v = np.array(own.vel_mps)
    speed = np.linalg.norm(v)
    u = v / speed
    a = np.cross(u, np.eye(3)[np.argmin(np.abs(u))])
    a /= np.linalg.norm(a)
    b = np.cross(u, a)

    def velocity(turn, bearing):
        turn, bearing = np.broadcast_arrays(np.asarray(turn)[..., None], np.asarray(bearing)[..., None])
        return speed * (np.cos(turn) * u + np.sin(turn) * (np.cos(bearing) * a + np.sin(bearing) * b))

    return velocity


def least_turn(own, obstacles, rays=360, rings=100, keep=6):
    """Least angle (rad) by which the velocity must turn to be free, or None.

    First free ring on many bearings, then a zoom round the best bearings: narrower in bearing, finer in the turn, all of them at once.
    """
    velocity = around(own)

    def free(turn, bearing):
        v = velocity(turn, bearing)
        return ~forbidden(own, obstacles, v.reshape(-1, 3)).reshape(v.shape[:-1])

    def first_free(turns, bearings):
        grid = free(turns[:, None], bearings[None, :])
        return np.where(grid.any(axis=0), grid.argmax(axis=0), len(turns))

    if free(0.0, 0.0):
        return 0.0
    for steps in (90, 180):  # a coarse look is enough to know how far to look; it does not prove that nothing is free
        turns = np.linspace(0, np.pi, steps + 1)
        first = first_free(turns, np.linspace(0, 2 * np.pi, steps, endpoint=False))
        if first.min() < len(turns):
            break
    else:
        return None
    turns, bearings = np.linspace(0, turns[first.min()], rings + 1), np.linspace(0, 2 * np.pi, rays, endpoint=False)
    first = first_free(turns, bearings)
    seen = first <= rings
    low, high = turns[np.clip(first - 1, 0, rings)], turns[np.minimum(first, rings)]
    for _ in range(14):
        middle = 0.5 * (low + high)
        good = free(middle, bearings)
        low, high = np.where(good, low, middle), np.where(good, middle, high)
    edge = np.where(seen, high, np.inf)
    local = np.nonzero((edge <= np.roll(edge, 1)) & (edge <= np.roll(edge, -1)) & seen)[0]
    chosen = local[np.argsort(edge[local], kind="stable")][:keep]
    centre, value, half, window = bearings[chosen], edge[chosen], 2 * np.pi / rays, 2 * turns[1]
    while half > 1e-10:
        tried = centre[:, None] + half * np.linspace(-1, 1, 9)
        steps = np.maximum(value[:, None] - window * np.linspace(1, 0, 17), 0.0)
        found = free(steps[:, None, :], tried[:, :, None])
        at = found.argmax(axis=2)
        at = np.where(found.any(axis=2), at, 16)
        low, high = (np.take_along_axis(steps, np.maximum(at - k, 0), axis=1) for k in (1, 0))
        ok = found.any(axis=2)
        for _ in range(12):
            middle = 0.5 * (low + high)
            good = free(middle, tried)
            low, high = np.where(good, low, middle), np.where(good, middle, high)
        high = np.where(ok, high, np.inf)
        best = high.argmin(axis=1)
        better = high.min(axis=1) < value
        value = np.where(better, high.min(axis=1), value)
        centre = np.where(better, np.take_along_axis(tried, best[:, None], axis=1)[:, 0], centre)
        half, window = 0.45 * half, 0.6 * window
    return float(value.min())
