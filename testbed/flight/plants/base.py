"""The plant's side of the loop: what it shows (``State``), what it is told (``Command``), what it must do (``Plant``)."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from testbed.core.frames import Vec3

if TYPE_CHECKING:
    from testbed.flight.air import AirModel
    from testbed.flight.plants.aircraft import Aircraft

make = tuple.__new__  # what a NamedTuple's own constructor ends in, at a quarter of its cost; for the tuples made 60 times a second


class TrimFailedError(RuntimeError):
    """The aircraft does not fly level and straight at the set speed."""


class State(NamedTuple):
    """One sample of the aircraft. ENU metres and m/s over the ground, radians; also one row of the log.

    Controls are the commands that the aircraft received: throttle 0..1, surfaces -1..1 in the sense of the aircraft's
    own file (elevator + nose down, aileron + rolls right, rudder + nose left). NaN where a plant has no such thing.
    """

    x: float
    y: float
    z: float
    vx: float
    vy: float
    vz: float
    bank: float
    pitch: float
    heading: float  # compass: clockwise from north
    load_factor: float  # along the body's -z axis, 1 in level flight
    airspeed: float
    alpha: float
    beta: float
    p: float
    q: float
    r: float
    throttle: float
    elevator: float
    aileron: float
    rudder: float
    wx: float = 0.0  # velocity of the air over the ground at the aircraft, gusts included (ENU m/s): airspeed = |v - w|
    wy: float = 0.0
    wz: float = 0.0


class Command(NamedTuple):
    """What guidance asks of any plant."""

    bank: float
    load_factor: float
    speed: float  # m/s, true airspeed
    sin_climb: float  # of the path as far ahead as the engine lags, for the throttle's feed-forward


class Start(NamedTuple):
    """The state that a flight starts from. ``curvature`` is dT/ds of the path there (1/m)."""

    pos: Vec3
    tangent: Vec3
    curvature: Vec3
    speed: float  # true airspeed, m/s
    wind: Vec3  # mean wind there: velocity of the air over the ground, ENU m/s


class PlantSetting(NamedTuple):
    """What a plant is made with, for one flight."""

    aircraft: "Aircraft"
    start: Start
    air: "AirModel"
    plant_hz: int
    guidance_hz: int
    terrain_z_m: float  # height of the flat ground, ENU
    hold_airspeed: bool  # false: the speed over the ground is held
    ideal: tuple[str, ...]  # limits of a point mass that are off


class Plant(Protocol):
    """One flight of one aircraft. ``follow`` at every change of path, ``command`` at the guidance rate, ``step`` and ``sample`` every tick.

    A sample is what the plant has at hand; ``state`` makes a ``State`` of it. Most ticks are only logged, so turning samples into
    states is left to those who need one: the loop at the guidance rate, the log once for the whole flight (as arrays).
    """

    def sample(self) -> Sequence[float]:
        """One row of the plant's own raw log."""

    def state(self, sample: Sequence[Any]) -> State:
        """The state in a sample. Arithmetic only, so that columns (n,) in give columns out."""

    def air_rotation(self, sample: Sequence[Any]) -> tuple[Any, Any, Any]:
        """Angular velocity of the air in body axes, rad/s, in a sample or in columns; for the log. NaN for a point, which has no wing."""

    def follow(self, path: "Followable", s_m: float) -> None:
        """A new path is active, and the aircraft stands at ``s_m`` of it (only a point on rails needs to know)."""

    def command(self, state: State, command: Command) -> bool:
        """Take a command; true when the aircraft is at one of its stops."""

    def step(self) -> object:
        """One tick."""

    def touches_ground(self) -> bool:
        """Does any part of the aircraft touch the ground? Asked near it only; of a point the height alone tells."""


class Followable(Protocol):
    """A path by arc length."""

    @property
    def length_m(self) -> float: ...

    def frame(self, s_m: float) -> tuple[Vec3, Vec3, Vec3]:
        """Point, unit tangent and curvature vector dT/ds at an arc length; straight beyond either end."""
