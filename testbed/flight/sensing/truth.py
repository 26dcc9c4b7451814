"""What the planner sees of the traffic: here the truth, within a range of the obstacle's centre."""

import math

from testbed.campaign.words.settings import Sensor
from testbed.core.frames import Vec3
from testbed.flight.traffic.track import Track


def detect(sensor: Sensor, tracks: tuple[Track, ...], time_s: float, own_pos: Vec3) -> list[tuple[Track, Vec3]]:
    """Every obstacle whose centre is within range, with its position now."""
    within = sensor.range_m
    return [(track, centre) for track in tracks if math.dist(centre := track.at(time_s), own_pos) <= within]
