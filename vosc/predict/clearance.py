"""How near a batch of tracks comes to spheres that go straight on."""

from typing import NamedTuple

import numpy as np

from vosc.predict.guided import Flown

Array = np.ndarray
TINY = 1e-12


class Spheres(NamedTuple):
    """Centres (k,3) at the start of the prediction, velocities (k,3) and radii (k,)."""

    pos_m: Array
    vel_mps: Array
    radius_m: Array


def least_clearance(flown: Flown, spheres: Spheres) -> tuple[Array, Array]:
    """Least distance (m) to any surface, negative inside, and when (s) that is, for each of the batch (n,).

    Between two times own track and spheres move straight, and so they do for ever after the last of them.
    """
    count = flown.x.shape[1]
    best, when = np.full(count, np.inf), np.zeros(count)
    steps = np.diff(flown.time_s)[:, None]
    for pos, vel, radius in zip(spheres.pos_m, spheres.vel_mps, spheres.radius_m, strict=True):
        gone = flown.time_s[:, None]
        x, y, z = (own - (pos[k] + vel[k] * gone) for k, own in enumerate((flown.x, flown.y, flown.z)))
        dx, dy, dz = x[1:] - x[:-1], y[1:] - y[:-1], z[1:] - z[:-1]
        share = -(x[:-1] * dx + y[:-1] * dy + z[:-1] * dz) / (dx * dx + dy * dy + dz * dz + TINY)
        share = np.minimum(np.maximum(share, 0.0), 1.0)
        square = (x[:-1] + share * dx) ** 2 + (y[:-1] + share * dy) ** 2 + (z[:-1] + share * dz) ** 2
        k = np.argmin(square, axis=0)
        each = np.arange(count)
        near, at = square[k, each], flown.time_s[k] + (share * steps)[k, each]
        wx, wy, wz = flown.end_vx - vel[0], flown.end_vy - vel[1], flown.end_vz - vel[2]
        later = np.maximum(-(x[-1] * wx + y[-1] * wy + z[-1] * wz) / (wx * wx + wy * wy + wz * wz + TINY), 0.0)
        after = (x[-1] + later * wx) ** 2 + (y[-1] + later * wy) ** 2 + (z[-1] + later * wz) ** 2
        at = np.where(after < near, flown.time_s[-1] + later, at)
        clearance = np.sqrt(np.minimum(near, after)) - radius
        when = np.where(clearance < best, at, when)
        best = np.minimum(best, clearance)
    return best, when
