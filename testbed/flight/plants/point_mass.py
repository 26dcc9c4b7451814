"""A point with an aeroplane's limits: bank and load factor with lag and rate, thrust and drag, wind.

It stands between the paper's point on rails and six degrees of freedom. What it takes from the aircraft (``point_mass`` and
``limits`` in aircraft.yaml) can be made ideal one at a time, and the difference says what that limit costs:

    V' = g ((T - D)/W - sin gamma)      gamma' = g/V (n cos phi - cos gamma)      chi' = g n sin phi / (V cos gamma)

with V, gamma, chi of the velocity through the air (chi clockwise from north). D/W = zero (V/Vr)^2 + lift n^2 (Vr/V)^2.
Bank, load factor and thrust follow their commands as first-order lags, solved exactly over a tick (so that a lag of 1e-4 s is
no stiffness), the bank no faster than the roll rate limit. The rest is integrated by the midpoint rule. When the air changes, the
velocity over the ground stays and V, gamma, chi change, and the lift with them, because the nose stays where it is:

    n = c + y      jump of y = a (V/Vr)^2 dalpha + n ((V'/V)^2 - 1)      y' = -2 d w y - w^2 (integral of y)

c is the lagged command, y the gust load; V' the airspeed after the change, dalpha the angle by which the flow turned in the plane of
lift and velocity, + from below: to first order the gust's speed along the lift over V. a (``load_factor_per_rad``) is the slope of
the load factor at Vr with the surfaces held. The last equation is what autopilot and weathercock stability make of it: the closed
short period of frequency w and damping d, y / jump = s^2 / (s^2 + 2 d w s + w^2). It is not the lag of c. The autopilot integrates
the error of the load factor, so that the integral of y over a vertical gust comes to nothing and a step of the air leaves no velocity
over the ground: the load swings back through zero, which a lag does not do. A head-on gust (the second term of the jump) leaves the
nose where it is, and the elevator has to move to the trim of another airspeed: its load has the integral ``gust_surge_s`` times the
jump, y / jump = s (s + surge w^2) / (s^2 + 2 d w s + w^2).

A gust does not ask for the aircraft's limits. With it the load factor ends where the wing's lift does, at (V/V1)^2 either way, V1
the airspeed at which 1 g takes the greatest angle of attack (as if the wing lifted as much downwards); what the command asks for is
not cut by that. An airspeed that is held by force knows no head-on gust.
"""

import math
from collections.abc import Sequence
from typing import Any

from testbed.core.frames import Vec3
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.air import Wind, ground_speed_along
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.base import Command, Followable, PlantSetting, Start, State
from testbed.flight.plants.kinematic import coordinated

NAN = math.nan
SLOWEST_MPS = 1.0  # below this the equations mean nothing; the flight is then long since lost
STEEPEST_COS = 0.05


def washout(frequency_rad_s: float, damping: float, dt_s: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """The transition over ``dt_s`` of y and its integral in y' = -2 d w y - w^2 (integral of y), 0 < d < 1."""
    decay = damping * frequency_rad_s
    ringing = frequency_rad_s * math.sqrt(1.0 - damping * damping)
    keep = math.exp(-decay * dt_s)
    cos, sin = keep * math.cos(ringing * dt_s), keep * math.sin(ringing * dt_s) / ringing
    return (cos - decay * sin, -frequency_rad_s * frequency_rad_s * sin), (sin, cos + decay * sin)


class PointMassPlant:
    """One flight of the point. ``hold_speed`` makes thrust ideal: the airspeed is what it is told to be."""

    def __init__(self, aircraft: Aircraft, start: Start, wind: Wind, plant_hz: int, hold_speed: bool) -> None:
        self._model, self._wind, self._hold_speed = aircraft.point_mass, wind, hold_speed
        self._dt = 1.0 / plant_hz
        self._tick = 0
        self._reference = aircraft.autopilot.reference_mps
        self._one_g = aircraft.limits.alpha_max_1g_mps
        self._roll_step = aircraft.limits.roll_rate_dps * DEG * self._dt
        model = self._model
        lags = (model.bank_lag_s, model.load_factor_lag_s, model.thrust_lag_s)
        self._bank_share, self._lift_share, self._thrust_share = (1.0 - math.exp(-self._dt / lag) for lag in lags)
        self._washout = washout(model.gust_frequency_rad_s, model.gust_damping, self._dt)
        ground = ground_speed_along(start.tangent, start.speed, start.wind)
        velocity = tuple(ground * t for t in start.tangent)
        air = tuple(v - w for v, w in zip(velocity, start.wind, strict=True))
        turn = tuple(ground * ground * k for k in start.curvature)
        bank, load_factor = coordinated((velocity[0], velocity[1], velocity[2]), (turn[0], turn[1], turn[2]))
        self._pos = start.pos
        self._air = start.wind  # velocity of the air over the ground where the point is
        self._speed = max(SLOWEST_MPS, math.hypot(*air))
        self._climb = math.asin(max(-1.0, min(1.0, air[2] / self._speed)))
        self._track = math.atan2(air[0], air[1])
        self._bank, self._load_factor = bank, load_factor  # the latter without the gust load
        self._gust_load = self._gust_integral = 0.0
        self._thrust = self._drag(self._speed, load_factor) + math.sin(self._climb)
        self._thrust = max(model.thrust_min, min(model.thrust_max, self._thrust))
        self._wanted = self._thrust  # thrust over weight that is asked for
        self._command = Command(bank, load_factor, start.speed, math.sin(self._climb))
        self._roll_rate = 0.0
        self._meet(wind(0.0, start.pos))

    def follow(self, path: Followable, s_m: float) -> None:
        """The point flies; it is not on rails."""

    def command(self, state: State, command: Command) -> bool:
        """Take a command; true when it asks for more thrust than there is."""
        self._command = command
        error = command.speed - state.airspeed
        drag = self._drag(self._speed, command.load_factor)
        self._wanted = drag + command.sin_climb + self._model.thrust_per_mps * error
        return not self._model.thrust_min <= self._wanted <= self._model.thrust_max

    def step(self) -> None:
        command, model, dt = self._command, self._model, self._dt
        roll = self._bank_share * (command.bank - self._bank)
        roll = max(-self._roll_step, min(self._roll_step, roll))
        lift = self._lift_share * (command.load_factor - self._load_factor)
        thrust_cmd = max(model.thrust_min, min(model.thrust_max, self._wanted))
        bank, n = self._bank + 0.5 * roll, self._load_factor + 0.5 * lift
        self._roll_rate = roll / dt
        self._thrust += self._thrust_share * (thrust_cmd - self._thrust)
        if self._hold_speed:
            self._speed = command.speed
        v, climb, track = self._speed, self._climb, self._track
        if self._gust_load or self._gust_integral:  # never in smooth air
            n = self._carried(n, self._relieve(), v)
        half = 0.5 * dt
        dv, dclimb, dtrack = self._rates(v, climb, bank, n)
        vm, cm, tm = v + half * dv, climb + half * dclimb, track + half * dtrack
        dv, dclimb, dtrack = self._rates(vm, cm, bank, n)
        flat = vm * math.cos(cm)
        (x, y, z), (wx, wy, wz) = self._pos, self._air
        self._pos = (x + dt * (flat * math.sin(tm) + wx), y + dt * (flat * math.cos(tm) + wy), z + dt * (vm * math.sin(cm) + wz))
        self._speed, self._climb, self._track = max(SLOWEST_MPS, v + dt * dv), climb + dt * dclimb, track + dt * dtrack
        self._bank, self._load_factor = self._bank + roll, self._load_factor + lift
        self._tick += 1
        self._meet(self._wind(self._tick * dt, self._pos))

    def _meet(self, air: Vec3) -> None:
        """The air at the new time and place. A change of it changes the velocity through the air, not the one over the ground."""
        if air == self._air:
            return
        flat = self._speed * math.cos(self._climb)
        (wx, wy, wz), (ux, uy, uz) = self._air, air
        vx, vy = flat * math.sin(self._track) + wx - ux, flat * math.cos(self._track) + wy - uy
        vz = self._speed * math.sin(self._climb) + wz - uz
        self._air = air
        speed = max(SLOWEST_MPS, math.sqrt(vx * vx + vy * vy + vz * vz))
        if self._model.load_factor_per_rad > 0.0:
            by_angle, by_speed = self._jumps(vx, vy, vz, speed)
            self._gust_load += by_angle + by_speed
            self._gust_integral -= self._model.gust_surge_s * by_speed
        self._speed = speed
        self._climb, self._track = math.atan2(vz, math.hypot(vx, vy)), math.atan2(vx, vy)

    def _jumps(self, vx: float, vy: float, vz: float, speed: float) -> tuple[float, float]:
        """What the load factor gains when the velocity through the air (ENU m/s) becomes this one: by angle of attack, by airspeed."""
        sin_climb, cos_climb = math.sin(self._climb), math.cos(self._climb)
        sin_track, cos_track = math.sin(self._track), math.cos(self._track)
        north = vx * sin_track + vy * cos_track  # horizontal, along the track
        right = vx * cos_track - vy * sin_track
        along = north * cos_climb + vz * sin_climb
        lift = (vz * cos_climb - north * sin_climb) * math.cos(self._bank) + right * math.sin(self._bank)
        ratio = speed / self._reference
        by_angle = self._model.load_factor_per_rad * ratio * ratio * math.atan2(-lift, along)
        faster = 1.0 if self._hold_speed else speed / self._speed
        return by_angle, (self._load_factor + self._gust_load) * (faster * faster - 1.0)

    def _relieve(self) -> float:
        """Let the gust load decay over a tick; its mean over the tick."""
        load, before = self._gust_load, self._gust_integral
        (ll, li), (il, ii) = self._washout
        self._gust_load, self._gust_integral = ll * load + li * before, il * load + ii * before
        return (self._gust_integral - before) / self._dt

    def _carried(self, n: float, gust: float, v: float) -> float:
        """Load factor and gust load together, as far as the wing carries them; without a gust the load factor itself."""
        most = v / self._one_g
        most *= most
        if gust > 0.0:
            return min(n + gust, max(n, most))
        return max(n + gust, min(n, -most)) if gust < 0.0 else n

    def touches_ground(self) -> bool:
        return False

    def sample(self) -> Sequence[float]:
        v, climb, track = self._speed, self._climb, self._track
        wx, wy, wz = self._air
        flat = v * math.cos(climb)
        velocity = (flat * math.sin(track) + wx, flat * math.cos(track) + wy, v * math.sin(climb) + wz)
        angles = (self._bank, climb, track % math.tau)
        n = self._carried(self._load_factor, self._gust_load, v)
        return (*self._pos, *velocity, *angles, n, v, NAN, NAN, self._roll_rate, NAN, NAN, NAN, NAN, NAN, NAN, wx, wy, wz)

    def state(self, sample: Sequence[Any]) -> State:
        return State._make(sample)

    def air_rotation(self, sample: Sequence[Any]) -> tuple[float, float, float]:  # noqa: ARG002
        """A point has no wing that could feel it."""
        return NAN, NAN, NAN

    def _rates(self, v: float, climb: float, bank: float, n: float) -> tuple[float, float, float]:
        cos = math.cos(climb)
        accel = 0.0 if self._hold_speed else G0_MPS2 * (self._thrust - self._drag(v, n) - math.sin(climb))
        turn = G0_MPS2 / v
        return accel, turn * (n * math.cos(bank) - cos), turn * n * math.sin(bank) / max(cos, STEEPEST_COS)

    def _drag(self, v: float, n: float) -> float:
        """Drag over weight."""
        ratio = v / self._reference
        square = ratio * ratio
        return self._model.drag_zero * square + self._model.drag_lift * n * n / square


def make_plant(setting: PlantSetting) -> PointMassPlant:
    """The point for one flight."""
    return PointMassPlant(setting.aircraft, setting.start, setting.air.at, setting.plant_hz, "speed" in setting.ideal)
