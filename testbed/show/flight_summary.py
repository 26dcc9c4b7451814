"""What a record says when it is read aloud: legs, decisions, the summary of a flight."""

import math

import numpy as np

from testbed.core.frames import direction_deg
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.record import Decision, FlightRecord, PlannedPath, ReplanEvent, inside
from testbed.results.columns import FlightMetrics
from testbed.show import words
from testbed.show.words import number

Array = np.ndarray
RIGHT_ANGLE = 90.0 * DEG

LEGEND = """### Reading the pictures
Encounter and chase: the aircraft at its true size, the line to the nearest point of the sphere with its length, red inside. Grey the
original path, yellow the avoidance, green the way back, blue the trail flown. Arrows at the aircraft are velocities, all on one scale:
blue over the ground, pale green through the air, and the wind, which blows to the aircraft; streaks move with the air.

Whole route: the aircraft larger than life, as its tab says; arrows reach half a second ahead. The grid (50 m) lies on the ground.

Time: the recording opens on the encounter, from the decision on, four times slower than it is; the whole flight is `sim_time`, in the
time panel's list.

Velocity space, as in the paper: VS the sphere of velocities of the present speed; ACC, the red cone with its apex P_3-DVO at v_o, what will
be a collision; RCC the same cone as seen from the obstacle, for v_uo; SC the cap that ACC cuts out of VS, with its centre M, B and C
its critical velocities, gamma the angle between M and B; S and S\N{PRIME} where two caps meet; purple the velocity that was chosen.
"""


def who(record: FlightRecord) -> str:
    """The point, or the aircraft and the physics it flew in."""
    plan = record.plan
    return words.flyer(plan.plant.kind, plan.aircraft)


def path_points(path: PlannedPath, per_curve: int = 60) -> list[Array]:
    """Evenly spaced points along each piece of a planned path."""
    return [curve.points(np.linspace(0.0, curve.length_m, per_curve)) for curve in path.curves]


def route_ends(record: FlightRecord) -> list[Array]:
    """Both ends of the path that was given to guidance first; empty when there was none."""
    if not record.paths:
        return []
    chain = record.paths[0].chain
    return [np.array(chain.frame(s_m)[0]) for s_m in (0.0, chain.length_m)]


def route_size(record: FlightRecord) -> float:
    """Diagonal of the box around the first path, m."""
    points = np.vstack(path_points(record.paths[0]))
    return float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))


def leg_names(record: FlightRecord) -> list[str]:
    """Per row the name of the piece that was active."""
    index, leg = record.columns["path.index"].astype(int), record.columns["path.leg"].astype(int)
    names = [piece_names(record, count) for count in range(len(record.paths))]
    return [names[i][min(k, len(names[i]) - 1)] for i, k in zip(index, leg, strict=True)]


def piece_names(record: FlightRecord, count: int) -> list[str]:
    """What the pieces of a path are for: ``route``, the original; ``avoid``, to the insertion point or along a direction that is held
    until the flight is clear; ``rejoin``, back.
    """
    path, replan = record.paths[count], record.plan.replan
    if count == 0:
        return ["route"] * len(path.curves)
    if any(event.decision == Decision.REJOINED and event.time_s == path.from_time_s for event in record.events):
        return ["rejoin"] * len(path.curves)
    holds = replan.answer == "direct" or replan.rejoin.when == "clear"
    return ["avoid"] + ["avoid" if holds else "rejoin"] * (len(path.curves) - 1)


def changes(values: list[str]) -> list[int]:
    """Rows at which a value differs from the row before, the first row included."""
    return [k for k, value in enumerate(values) if k == 0 or value != values[k - 1]]


def level_turn(speed_mps: float, curvature_1pm: float) -> tuple[float, float]:
    """Bank (deg) and load factor of a steady level turn of that curvature at that speed."""
    pull = speed_mps**2 * curvature_1pm / G0_MPS2
    return math.atan(pull) / DEG, math.hypot(1.0, pull)


def radius_m(curvature_1pm: float) -> float:
    """Radius of a curvature; infinite for a straight line, NaN for no curve at all."""
    return math.inf if curvature_1pm == 0.0 else 1.0 / curvature_1pm


def path_told(event: ReplanEvent) -> str:
    """What is wrong with the new path, after a comma; empty where nothing is."""
    told = []
    if inside(event.path_clearance_m):
        told.append(f"the path leads {number(-event.path_clearance_m, 1)} m inside a sphere")
    if event.path_turns_rad > RIGHT_ANGLE:
        told.append(f"it turns back by {number(event.path_turns_rad / DEG, 0)} deg")
    return f", but {words.listed(told)}" if told else ""


def summary_markdown(record: FlightRecord, metrics: FlightMetrics) -> str:
    """The flight on one card: who flew what, how it ended, the numbers, every decision with its inputs."""
    plan = record.plan
    said = {who(record), words.method(plan.avoids_by), plan.plant.kind, plan.aircraft}
    labels = ", ".join(told for axis, label in plan.labels.items() if (told := words.circumstance(axis, label)) not in said)
    lines = [
        f"## {words.capital(words.outcome_told(metrics.outcome))}",
        f"**{who(record)}**, **{words.method(plan.avoids_by)}**, {number(plan.speed_mps, 0)} m/s" + (f"  \n{labels}" if labels else ""),
        *(["", record.message] if record.message else []),
        "",
        "| | |\n|---|---:|",
        f"| least clearance | **{number(metrics.least_clearance_m, 2)} m** at {number(metrics.time_at_least_clearance_s, 2)} s |",
        f"| clearance of the plan | {number(metrics.planned_clearance_m, 2)} m |",
        f"| cross-track rms / max | {number(metrics.cross_track_rms_m, 2)} / {number(metrics.cross_track_max_m, 2)} m |",
        f"| bank, largest | {number(metrics.max_bank_deg, 1)} deg |",
        f"| load factor | {number(metrics.min_load_factor, 2)} to {number(metrics.max_load_factor, 2)} |",
        f"| airspeed | {number(metrics.min_airspeed_mps, 1)} to {number(metrics.max_airspeed_mps, 1)} m/s |",
        f"| path flown / planned | {number(metrics.path_length_m, 1)} / {number(metrics.planned_length_m, 1)} m |",
        f"| flight time | {number(metrics.flight_time_s, 2)} s |",
    ]
    for count, event in enumerate(record.events, start=1):
        lines += ["", f"### Decision {count} at {number(event.time_s, 2)} s: {words.read_aloud(event.decision)}", *_decision(event)]
    lines += ["", f"Flight `{plan.flight_id}`, campaign `{plan.campaign}`, replicate {plan.replicate}, seed {plan.seed}.", ""]
    lines += [LEGEND]
    return "\n".join(lines)


def _decision(event: ReplanEvent) -> list[str]:
    """The rows of one decision's table."""
    speed = math.hypot(*event.own_vel_enu_mps)
    bank_deg, load = level_turn(speed, event.max_curvature_to_insertion_1pm)

    def direction(vector: tuple[float, float, float]) -> str:
        azimuth, elevation = direction_deg(vector)
        return f"{number(math.hypot(*vector), 1)} m/s ({number(azimuth, 1)}, {number(elevation, 1)})"

    def angle(value_rad: float) -> str:
        return number(value_rad / DEG, 2)

    centre = f"({angle(event.cap_azimuth_rad)}, {angle(event.cap_elevation_rad)})"
    cap = f"r {number(event.cap_radius_mps, 1)} m/s, {centre}, gamma {angle(event.cap_half_angle_rad)}"
    point = ", ".join(number(x, 1) for x in event.insertion_enu_m)
    return [
        "| angles in deg | |\n|---|---:|",
        f"| obstacle, radius | {event.obstacle}, {number(event.radius_m, 1)} m |",
        f"| own velocity | {direction(event.own_vel_enu_mps)} |",
        f"| obstacle velocity | {direction(event.obstacle_vel_enu_mps)} |",
        f"| alpha / alpha_0 | {angle(event.alpha_rad)} / {angle(event.alpha0_rad)} |",
        f"| straight lines pass at | {number(event.miss_m, 1)} m in {number(event.time_to_cpa_s, 2)} s |",
        f"| cap G | {cap} |",
        f"| method, status | {words.method(event.method)}, {words.read_aloud(event.status)} |",
        f"| command | {direction(event.command_enu_mps)} |",
        f"| deflection | {angle(event.deflection_rad)} |",
        f"| insertion point | ({point}) after {number(event.insertion_time_s, 2)} s |",
        f"| the path keeps, turns by | {number(event.path_clearance_m, 1)} m, {number(event.path_turns_rad / DEG, 0)} deg |",
        f"| least radius to it | {number(radius_m(event.max_curvature_to_insertion_1pm), 0)} m |",
        f"| a level turn of it needs | {number(bank_deg, 0)} deg of bank, load factor {number(load, 2)} |",
    ]
