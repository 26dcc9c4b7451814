"""The paper's single-obstacle encounter, typed in from its Table 1, and the named readings of it."""

import importlib.util
import math
from pathlib import Path

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


def _load(name):
    spec = importlib.util.spec_from_file_location(f"vosc_tests_{name}", Path(__file__).with_name(f"{name}.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def brute():
    """The module of brute-force answers."""
    return _load("brute")


@pytest.fixture(scope="session")
def scenes():
    """The module of random encounters."""
    return _load("scenes")
