"""What is measured of one flight for detect and avoid, each thing once and only when a column asks for it."""

import math
from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from testbed.campaign.words.daa import SPHERE, Daa, Volume
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.air import make_wind
from testbed.flight.record import AVOIDING, FlightRecord, ReplanEvent, inside
from testbed.flight.traffic.schedule import arc_lengths, planned_time
from testbed.results.avoidance import LOOK_EVERY_S, clearance_of
from testbed.results.daa import volumes
from testbed.results.measured import Measured

Array = np.ndarray
NAN = math.nan
SENSE_RAD = 1.0 * DEG
"""A command that turns by less to a side has no sense: it is neither left nor right, or neither up nor down."""


class Pieces(NamedTuple):
    """The motion relative to one obstacle from tick to tick, each piece straight: where it begins (n,3), velocity, when, how long."""

    p: Array
    v: Array
    at_s: Array
    lasts_s: Array


class Miss(NamedTuple):
    """The least distance between the two centres, and its parts then."""

    slant_m: float = NAN
    horizontal_m: float = NAN
    vertical_m: float = NAN
    time_s: float = NAN


class InVolume(NamedTuple):
    """Of a flight and a volume. ``entered`` is None where nothing was met."""

    entered: bool | None = None
    time_s: float = NAN
    severity: float = NAN


def pieces(time_s: Array, own: Array, other: Array) -> Pieces:
    """Of places (n,3) of two at the same times (n,); pieces of which an end is missing are left out."""
    relative = own - other
    lasts = np.diff(time_s)
    known = np.isfinite(relative).all(axis=1)
    both = known[:-1] & known[1:] & (lasts > 0.0)
    p, lasts = relative[:-1][both], lasts[both]
    return Pieces(p, (relative[1:][both] - p) / lasts[:, None], time_s[:-1][both], lasts)


def least_distance(piece: Pieces) -> Miss:
    """Between ticks too."""
    if not len(piece.p):
        return Miss()
    speed2, closing = np.einsum("ij,ij->i", piece.v, piece.v), np.einsum("ij,ij->i", piece.p, piece.v)
    with np.errstate(divide="ignore", invalid="ignore"):
        after = np.clip(np.where(speed2 > 0.0, -closing / speed2, 0.0), 0.0, piece.lasts_s)
    there = piece.p + after[:, None] * piece.v
    k = int(np.argmin(np.einsum("ij,ij->i", there, there)))
    x, y, z = there[k].tolist()
    return Miss(math.hypot(x, y, z), math.hypot(x, y), abs(z), float(piece.at_s[k] + after[k]))


def in_volume(every: list[Pieces], volume: Volume) -> InVolume:
    """Of several obstacles: into any of them, the time in all of them together (two at once count once each), the deepest."""
    if not any(len(piece.p) for piece in every):
        return InVolume()
    entered, time_s, severity = False, 0.0, 0.0
    for piece in every:
        found = volumes.inside(piece.p, piece.v, piece.lasts_s, volume)
        if found.ever.any():
            entered = True
            time_s += float(np.sum((found.last_s - found.first_s)[found.ever]))
            severity = max(severity, volumes.deepest(piece.p, piece.v, found, volume))
    return InVolume(entered, time_s, severity)


class DaaMeasured(Measured):
    """A record, what a campaign asks of it, and what follows."""

    def __init__(self, record: FlightRecord, daa: Daa) -> None:
        super().__init__(record)
        self.daa = daa

    def _pieces(self, own: Array) -> list[Pieces]:
        columns = self.record.columns
        if len(columns["time_s"]) < 2:
            return []
        others = (columns[f"obstacle.{spec.name}.pos_enu_m"] for spec in self.record.plan.obstacles)
        return [pieces(columns["time_s"], own, other) for other in others]

    @cached_property
    def met(self) -> list[Pieces]:
        """Of each obstacle."""
        return self._pieces(self.record.columns["own.pos_enu_m"])

    @cached_property
    def miss(self) -> Miss:
        found = [miss for piece in self.met if math.isfinite((miss := least_distance(piece)).slant_m)]
        return min(found, key=lambda miss: miss.slant_m, default=Miss())

    @property
    def least_tau_mod_s(self) -> float:
        least = math.inf
        for piece in self.met:
            for after in (0.0, piece.lasts_s[:, None]):  # both ends: a piece's velocity is that between its ticks
                tau = volumes.tau_mod(piece.p[:, :2] + after * piece.v[:, :2], piece.v[:, :2], self.daa.dmod_m)
                least = min(least, float(np.min(tau, initial=math.inf)))
        return least if math.isfinite(least) else NAN

    def volume(self, name: str) -> InVolume:
        """What became of one volume."""
        if name not in (kept := self._kept):
            kept[name] = in_volume(self.met, self.daa.all_volumes[name])
        return kept[name]

    @cached_property
    def _kept(self) -> dict[str, InVolume]:
        return {}

    # What was decided.

    @cached_property
    def manoeuvre(self) -> ReplanEvent | None:
        return next((event for event in self.record.events if event.decision in AVOIDING), None)

    @property
    def alert_lead_s(self) -> float:
        return self.miss.time_s - self.trigger_s

    @property
    def manoeuvre_time_s(self) -> float:
        return self.manoeuvre.time_s if self.manoeuvre else NAN

    @property
    def manoeuvre_lead_s(self) -> float:
        return self.miss.time_s - self.manoeuvre_time_s

    @property
    def reversals(self) -> int:
        return reversals(event for event in self.record.events if event.decision in AVOIDING)

    @cached_property
    def needed(self) -> bool | None:
        """Would the route, flown as planned and not left, have led into what is to be kept?"""
        if not any(len(piece.p) for piece in self.met) or not self.record.paths:
            return None
        point = self._as_planned()
        if self.daa.needed_by == SPHERE:
            return bool(inside(clearance_of(self.record, point)))
        return in_volume(self._pieces(point), self.daa.all_volumes[self.daa.needed_by]).entered

    @property
    def false_manoeuvre(self) -> bool | None:
        return None if self.needed is None else self.manoeuvre is not None and not self.needed

    @property
    def missed_manoeuvre(self) -> bool | None:
        return None if self.needed is None else self.manoeuvre is None and self.needed

    def _as_planned(self) -> Array:
        """Places (n,3) on the route by its schedule; NaN past its end."""
        record, route = self.record, self.record.paths[0]
        wind = make_wind(record.plan.air, record.plan.terrain_z_m)
        s = arc_lengths(route.chain, self.begin_s_m, record.columns["time_s"], record.plan, wind)
        point = np.full((len(s), 3), NAN)
        on_it = s <= route.length_m
        point[on_it] = route.chain.places(s[on_it])
        return point

    # What it cost.

    @cached_property
    def off_route(self) -> tuple[Array, Array]:
        """Height over the nearest place of the route, and airspeed, from the first manoeuvre on, every 0.1 s. Empty without one."""
        if self.manoeuvre is None:
            return np.zeros(0), np.zeros(0)
        hz = self.record.plan.rates.plant_hz
        rows = np.arange(round(self.manoeuvre.time_s * hz), self.end + 1, max(1, round(LOOK_EVERY_S * hz)))
        chain, pos = self.record.paths[0].chain, self.record.columns["own.pos_enu_m"][rows]
        if not len(rows):
            return np.zeros(0), np.zeros(0)
        nearest = chain.places(chain.nearest(pos, self.record.columns["guidance.s_m"][rows])[0])
        return pos[:, 2] - nearest[:, 2], self.record.columns["own.airspeed_mps"][rows]

    @property
    def height_change_m(self) -> float:
        return greatest(self.off_route[0])

    @property
    def energy_change_m(self) -> float:
        height, airspeed = self.off_route
        return greatest(height + (airspeed**2 - self.record.plan.speed_mps**2) / (2.0 * G0_MPS2))

    @property
    def _arrived(self) -> bool:
        return self.share > 0.0 and bool(self.record.paths)

    @property
    def extra_length_m(self) -> float:
        return self.length_m - (self.record.paths[0].length_m - self.begin_s_m) if self._arrived else NAN

    @property
    def extra_time_s(self) -> float:
        if not self._arrived:
            return NAN
        record, route = self.record, self.record.paths[0]
        wind = make_wind(record.plan.air, record.plan.terrain_z_m)
        return self.time_s - planned_time(route.chain, self.begin_s_m, route.length_m, record.plan, wind)


def greatest(values: Array) -> float:
    """The value farthest from 0, with its sign; NaN for none."""
    known = values[np.isfinite(values)]
    return float(known[np.argmax(np.abs(known))]) if len(known) else NAN


def reversals(commands: Iterator[ReplanEvent]) -> int:
    """How often a command turns to the other side of the present velocity than the last one that turned: left or right, up or down."""
    count = 0
    last = [0, 0]
    for event in commands:
        for k, turn in enumerate(_turns(event)):
            sense = 0 if not abs(turn) > SENSE_RAD else int(math.copysign(1.0, turn))
            count += sense * last[k] < 0
            last[k] = sense or last[k]
    return count


def _turns(event: ReplanEvent) -> tuple[float, float]:
    """Angles from the velocity to the command, leftwards and upwards; NaN where no velocity is commanded."""
    (x, y, z), (u, v, w) = event.own_vel_enu_mps, event.command_enu_mps
    return math.atan2(x * v - y * u, x * u + y * v), math.atan2(w, math.hypot(u, v)) - math.atan2(z, math.hypot(x, y))
