"""What happened in a flight, in a pilot's words: what came in sight, what was decided, what could not be flown, what came of it."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from testbed.campaign.words.obstacles import ObstacleSpec
from testbed.core.frames import direction_deg
from testbed.flight.guidance.law import BANK_LIMITED, LIFT_LIMITED
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.record import NEW_PATH, Decision, FlightRecord, Outcome, ReplanEvent, inside, reversals
from testbed.results.columns import FlightMetrics
from testbed.show import words
from testbed.show.flight_summary import changes, leg_names, path_told, who
from testbed.show.words import number

Array = np.ndarray
SAME_M = 1.0  # closer than that in height is level


class Line(NamedTuple):
    """One line of the log: when, how serious (of ``INFO``, ``WARN``, ``ERROR``), and the sentence."""

    time_s: float
    level: str
    text: str


def pilot_log(record: FlightRecord, metrics: FlightMetrics) -> list[Line]:
    """The lines of a flight in the order of time."""
    time_s = record.columns["time_s"]
    lines = [Line(float(time_s[0]), "INFO", f"Start: {who(record)}, {words.method(record.plan.avoids_by)}")]
    for spec in record.plan.obstacles:
        lines += _sphere(record, spec)
    for event in record.events:
        lines += decided(event)
    if record.plan.replan.policy != "once":
        lines += [Line(time, "WARN", "Reversal: to the other side than before") for time in reversals(record.events)]
    lines += _limits(record)
    legs = leg_names(record)
    lines += [
        Line(float(time_s[row]), "INFO", f"Insertion point passed: {LEG_NAMES[legs[row]]}")
        for row in changes(legs)[1:]
        if legs[row - 1] == "avoid"
    ]
    if metrics.nearest_obstacle and math.isfinite(metrics.least_clearance_m):
        level = "ERROR" if inside(metrics.least_clearance_m) else "INFO"
        closest = f"Closest approach: {words.clearance(metrics.least_clearance_m, metrics.nearest_obstacle)}"
        lines.append(Line(metrics.time_at_least_clearance_s, level, closest))
    ending = words.capital(record.message or words.outcome_told(record.outcome))
    lines.append(Line(float(time_s[-1]), "INFO" if record.outcome == Outcome.REACHED else "ERROR", f"End: {ending}"))
    return sorted(lines, key=lambda line: line.time_s)


LEG_NAMES = {"route": "on the route", "avoid": "clear of the threat yet to come", "rejoin": "on the way to the goal"}


def decided(event: ReplanEvent) -> list[Line]:
    """What the planner saw, and what it made of it."""
    said, threat = [], event.decision not in (Decision.REJOINED, Decision.CLEAR, Decision.HELD, Decision.KEPT)
    if threat and event.obstacle and math.isfinite(event.miss_m):
        near = f"{number(event.miss_m, 1)} m from its centre (radius {number(event.radius_m, 0)} m) in {number(event.time_to_cpa_s, 1)} s"
        said.append(Line(event.time_s, "WARN", f"{event.obstacle} is a threat: straight on would pass {near}"))
    if event.decision == Decision.REPLANNED:
        fault = path_told(event)
        again = f" ({event.reason})" if event.reason else ""
        said.append(Line(event.time_s, "WARN" if fault else "INFO", _replanned(event) + fault + again))
    elif event.decision == Decision.STEERED:
        said.append(Line(event.time_s, "INFO", f"{words.method(event.method)} steers until clear of {event.obstacle}"))
    elif event.decision == Decision.PLANNED:
        said.append(Line(event.time_s, "INFO", f"{event.method}: another path of {number(event.planned_length_m, 0)} m"))
    elif event.decision == Decision.HELD:
        said.append(Line(event.time_s, "INFO", f"Straight on, until the way back is clear ({event.reason})"))
    elif event.decision == Decision.KEPT:
        said.append(Line(event.time_s, "WARN", f"Path kept: nothing better was found, or needed ({event.reason})"))
    elif event.decision == Decision.REJOINED:
        back = f"{number(event.planned_length_m, 0)} m, {number(event.route_miss_m, 0)} m from the centre at least"
        said.append(Line(event.time_s, "INFO", f"Clear of {event.obstacle}: on the way back, {back}"))
    else:
        level = "INFO" if event.decision in NEW_PATH | {Decision.NONE, Decision.CLEAR} else "ERROR"
        why = words.read_aloud(event.decision)
        status = f" ({event.reason or words.read_aloud(event.status)})" if event.reason or event.status != event.decision else ""
        said.append(Line(event.time_s, level, f"{words.capital(words.method(event.method))}: path kept, {why}{status}"))
    return said


def _replanned(event: ReplanEvent) -> str:
    """The manoeuvre that was chosen."""
    (azimuth, elevation), (before, climb) = direction_deg(event.command_enu_mps), direction_deg(event.own_vel_enu_mps)
    way = words.turn((azimuth - before + 180.0) % 360.0 - 180.0, elevation - climb)
    text = f"{words.method(event.method)} turns {way}"
    if not math.isfinite(event.insertion_time_s) or not all(map(math.isfinite, event.insertion_enu_m)):
        return f"{text}, at once"
    ahead = math.dist(event.insertion_enu_m, event.own_pos_enu_m)
    return f"{text}, to be reached in {number(event.insertion_time_s, 1)} s at the insertion point {number(ahead, 0)} m ahead"


def _sphere(record: FlightRecord, spec: ObstacleSpec) -> list[Line]:
    """When an obstacle came in sight, and when the flight was inside it."""
    columns, name = record.columns, spec.name
    time_s, clearance = columns["time_s"], columns[f"obstacle.{name}.clearance_m"]
    lines = []
    seen = np.flatnonzero(clearance + spec.radius_m <= record.plan.sensor.shown_reach_m(spec.radius_m))
    if len(seen):
        row = int(seen[0])
        lines.append(Line(float(time_s[row]), "INFO", f"{name} in sight: {traffic(columns, name, row)}"))
    hit = inside(clearance)
    for row in changes(list(hit)):
        if hit[row]:
            lines.append(Line(float(time_s[row]), "ERROR", f"Collision: inside {name}"))
        elif row:
            lines.append(Line(float(time_s[row]), "WARN", f"Out of {name} again"))
    return lines


def traffic(columns: Mapping[str, Array], name: str, row: int) -> str:
    """Where an obstacle is, as a pilot is told of traffic: ``1 o'clock, 97 m, 4 m low``."""
    velocity, own = columns["own.vel_enu_mps"][row], columns["own.pos_enu_m"][row]
    there = columns[f"obstacle.{name}.pos_enu_m"][row] - own
    bearing = math.atan2(velocity[1], velocity[0]) - math.atan2(there[1], there[0])
    height = float(there[2])
    level = "level" if abs(height) < SAME_M else f"{number(abs(height), 0)} m {'high' if height > 0.0 else 'low'}"
    return f"{words.clock(bearing)}, {number(float(np.linalg.norm(there)), 0)} m, {level}"


def _limits(record: FlightRecord) -> list[Line]:
    """The first time that each limit cut what guidance asked for."""
    limited = record.columns.get("guidance.limited")
    if limited is None or not np.nansum(limited):
        return []
    limits = load_aircraft(record.plan.aircraft).limits
    lines = []
    for flag, told in (
        ((BANK_LIMITED, BANK_LIMITED + LIFT_LIMITED), f"More bank wanted than the {number(limits.bank_deg, 0)} deg allowed"),
        (
            (LIFT_LIMITED, BANK_LIMITED + LIFT_LIMITED),
            f"More or less lift wanted than allowed: load factor {words.span(limits.load_factor_min, limits.load_factor_max, '', 1)}",
        ),
    ):
        rows = np.flatnonzero(np.isin(limited, flag))
        if len(rows):
            lines.append(Line(float(record.columns["time_s"][rows[0]]), "WARN", told))
    return lines
