"""The paper's single-obstacle encounter, typed in from its Table 1, and the named readings of it."""

import math

import pytest

from vosc import Obstacle, Own

READINGS = {"as_printed": (135.0, 12.4), "azimuth_106": (106.0, 12.4), "direction_106_10": (106.1, 10.4)}


def polar(size, azimuth_deg, elevation_deg):
    a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return (size * math.cos(e) * math.cos(a), size * math.cos(e) * math.sin(a), size * math.sin(e))


@pytest.fixture(scope="session")
def table_1():
    """A function: name of a reading -> (own, obstacle)."""

    def encounter(reading):
        return Own((162, 101, 64.3), polar(50, 24.7, 12.0)), Obstacle((254, 63.6, 60.7), polar(40, *READINGS[reading]), 25)

    return encounter
