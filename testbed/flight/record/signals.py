"""The signals of a flight: every column of ``FlightRecord.columns``, one row per plant tick.

What a plant does not have (control deflections of a point) is NaN. A vector is (n, 3) in the record; in a table each part has a
column of its own, ``own.pos_enu_m.x`` and so on.
"""

from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np

Array = np.ndarray
OBSTACLE_PREFIX: Final = "obstacle.<name>."


class Signal(NamedTuple):
    """A column of a record. ``parts``: the letters of a vector's parts, none for a number."""

    name: str
    unit: str
    parts: str
    definition: str


SIGNALS: Final = (
    Signal("time_s", "s", "", "Time since the start of the flight."),
    Signal("own.pos_enu_m", "m", "xyz", "Place of the centre of gravity: east, north, up."),
    Signal("own.vel_enu_mps", "m/s", "xyz", "Velocity over the ground."),
    Signal("air.wind_enu_mps", "m/s", "xyz", "Velocity of the air over the ground there, gusts included; airspeed is |velocity - wind|."),
    Signal("air.rotation_body_radps", "rad/s", "xyz", "Angular velocity of the air about the wing in body axes, which aerodynamics feel "
           "taken off the aircraft's rates: 0 in calm air, NaN for a point."),
    Signal("own.rates_body_radps", "rad/s", "xyz", "Angular velocity in body axes: roll, pitch, yaw."),
    Signal("own.quat_enu_from_body_xyzw", "", "xyzw", "Attitude as a quaternion that turns body axes (forward, right, down) into ENU."),
    Signal("own.bank_rad", "rad", "", "Bank angle, right wing down is positive."),
    Signal("own.pitch_rad", "rad", "", "Pitch angle, nose up is positive."),
    Signal("own.heading_rad", "rad", "", "Compass heading of the nose, clockwise from north."),
    Signal("own.load_factor", "", "", "Normal load factor, 1 in level flight."),
    Signal("own.airspeed_mps", "m/s", "", "True airspeed."),
    Signal("own.alpha_rad", "rad", "", "Angle of attack."),
    Signal("own.beta_rad", "rad", "", "Angle of sideslip."),
    Signal("own.throttle", "", "", "Throttle command, 0 to 1."),
    Signal("own.elevator", "", "", "Elevator command, -1 to 1."),
    Signal("own.aileron", "", "", "Aileron command, -1 to 1."),
    Signal("own.rudder", "", "", "Rudder command, -1 to 1."),
    Signal("guidance.s_m", "m", "", "Arc length of the active path at which guidance has the aircraft."),
    Signal("guidance.bank_cmd_rad", "rad", "", "Bank that guidance asks for, within the limits."),
    Signal("guidance.load_factor_cmd", "", "", "Load factor that guidance asks for, within the limits."),
    Signal("guidance.saturated", "", "", "1 where a limit cut the command or a surface was at its stop, else 0."),
    Signal("guidance.limited", "", "", "Which limits cut the command: 1 for bank plus 2 for load factor."),
    Signal("own.at_stop", "", "", "1 where a surface was at its stop, else 0."),
    Signal("path.index", "", "", "Number of the path that was active, from 0, the route."),
    Signal("path.leg", "", "", "Number of the piece of that path, from 0."),
    Signal("path.s_m", "m", "", "Arc length of the point of the active path that is nearest, exact."),
    Signal("path.cross_track_m", "m", "", "Distance in space to that point."),
    Signal(f"{OBSTACLE_PREFIX}pos_enu_m", "m", "xyz", "Place of the obstacle's centre, as it truly was; NaN while it is not there."),
    Signal(f"{OBSTACLE_PREFIX}vel_enu_mps", "m/s", "xyz", "Its velocity over the ground."),
    Signal(f"{OBSTACLE_PREFIX}clearance_m", "m", "", "Distance to its surface; negative: inside."),
)  # fmt: skip
_BY_NAME = {signal.name: signal for signal in SIGNALS}


def signal_of(column: str) -> Signal:
    """What a column of a record is. ``KeyError`` for one that is not declared."""
    named = f"{OBSTACLE_PREFIX}{column.rpartition('.')[2]}" if column.startswith("obstacle.") else column
    return _BY_NAME[named]


def flat(columns: Mapping[str, Array]) -> dict[str, Array]:
    """Columns (n,) of the same order, vectors by their parts."""
    told: dict[str, Array] = {}
    for name, values in columns.items():
        parts = signal_of(name).parts
        told |= {f"{name}.{part}": values[:, k] for k, part in enumerate(parts)} if parts else {name: values}
    return told


def units_of(columns: Mapping[str, Array]) -> dict[str, str]:
    """The unit of every column that ``flat`` makes."""
    return {f"{name}.{part}" if part else name: signal_of(name).unit for name in columns for part in signal_of(name).parts or ("",)}
