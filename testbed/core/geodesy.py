"""Latitude and longitude to the local frame and back: the only file that imports ``pymap3d``. WGS84, degrees and metres."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from testbed.core.frames import Array

Origin = tuple[float, float, float]
"""Latitude (deg), longitude (deg) and height (m) of the place that is [0, 0, 0]."""


def enu_from_geodetic(places: "Array", origin: Origin) -> "Array":
    """Latitudes (deg), longitudes (deg) and heights (m), (n,3), as places (n,3) in the frame that is level at the origin, m.

    10 km away the ground lies 8 m below that frame's plane, 50 km away 196 m.
    """
    from pymap3d import geodetic2enu

    return np.column_stack(geodetic2enu(*np.asarray(places, dtype=float).T, *origin))


def geodetic_from_enu(pos_enu_m: "Array", origin: Origin) -> "Array":
    """Latitude (deg), longitude (deg) and height (m), (n,3), of places (n,3)."""
    from pymap3d import enu2geodetic

    return np.column_stack(enu2geodetic(*np.asarray(pos_enu_m, dtype=float).T, *origin))
