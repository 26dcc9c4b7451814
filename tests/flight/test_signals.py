"""Every column of a record is declared, with its unit and shape, and stands in the table of it."""

import numpy as np
import pytest

from testbed import fly
from testbed.flight.record.signals import OBSTACLE_PREFIX, SIGNALS, signal_of
from tests.plans import KINEMATIC, paper_obstacle, plan

UNITS = {"_mps": "m/s", "_radps": "rad/s", "_rad": "rad", "_s": "s", "_m": "m"}


@pytest.fixture(scope="module")
def record():
    return fly(plan(obstacles=[paper_obstacle(name="O-2")], **KINEMATIC))


def test_a_flight_has_the_signals_that_are_declared_and_no_other(record):
    assert [name.replace("obstacle.O-2.", OBSTACLE_PREFIX) for name in record.columns] == [signal.name for signal in SIGNALS]
    n = len(record.columns["time_s"])
    for name, values in record.columns.items():
        parts = len(signal_of(name).parts)
        assert values.shape == ((n, parts) if parts else (n,)), name


def test_names_end_in_their_unit():
    for signal in SIGNALS:
        assert signal.unit == next((unit for ending, unit in UNITS.items() if signal.name.endswith(ending)), ""), signal.name
        assert signal.definition.endswith("."), signal.name


def test_the_frame_is_the_record_with_units(record):
    frame = record.frame()
    assert len(frame) == len(record.columns["time_s"])
    assert np.array_equal(frame["own.vel_enu_mps.y"], record.columns["own.vel_enu_mps"][:, 1])
    assert np.array_equal(frame["obstacle.O-2.clearance_m"], record.columns["obstacle.O-2.clearance_m"])
    assert list(frame.attrs["units"]) == list(frame.columns)
    assert frame.attrs["units"]["obstacle.O-2.pos_enu_m.z"] == "m"
    assert frame.attrs["units"]["own.rates_body_radps.x"] == "rad/s"
    assert frame.attrs["flight_id"] == "test"
