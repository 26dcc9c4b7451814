"""Writes ``paths.md`` and the pictures of the searches in space and time: ``python docs/methods/make_paths.py [--encounters N]``.

Every search flies the same encounters, one after the other in one process, so that their times compare. ``--encounters 0`` leaves the
table as it is and draws the pictures again. The planner rrt needs the extra of that name.
"""

import argparse
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from testbed.campaign.words.population import Encounters
from testbed.campaign.words.settings import FlightPlan
from testbed.flight.fly import fly
from testbed.flight.paths import PATHS
from testbed.flight.planning.decided import Decided
from testbed.flight.record import AVOIDING, FlightRecord, kept_and_flew_on
from testbed.flight.traffic.track import least_clearance
from testbed.results.statistics import share_interval

HERE = Path(__file__).parent
SEED, ENCOUNTERS, SPEED_MPS = 20210, 16, 50.0
CASES = (("on rails", "kinematic", 2.0), ("on rails", "kinematic", 4.0), ("point mass", "point_mass", 4.0))
PLANNERS: dict[str, dict[str, Any]] = {"scoam": {"method": {"kind": "scoam"}}}
PLANNERS |= {kind: {"planner": {"kind": kind}, "method": {"kind": "none"}} for kind in PATHS}
WHO = {"flight_id": "", "campaign": "paths", "cell": "", "labels": {}, "seed": SEED}
ENDS = {"start_enu_m": [0, 0, 300], "goal_enu_m": [1000, 0, 300], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}

LONG, WIDE_M, SCALE, LEFT = 800.0, 110.0, 0.76, 6
COLOURS = ("#c44e52", "#4c72b0", "#8172b2")


def drawn(kind: str, plant: str, lead_s: float, number: int) -> FlightPlan:
    """One encounter, answered ``lead_s`` before the closest approach."""
    population = Encounters(
        own_at_enu_m=(250, 0, 300),
        own_direction_deg=(0, 0),
        trigger={"time_to_cpa_s": lead_s},
        obstacle_speed_mps=(0, 50),
        radius_m=(10, 30),
    )
    scene = {"route": ENDS, "begin": {"at_route_s_m": 245}, "obstacles": [population.drawn(SPEED_MPS, SEED, number)]}
    planner = {"sensor": {"range_m": 1000}, "replan": {"horizon_s": lead_s + 0.5 / 60}, **PLANNERS[kind]}
    return FlightPlan.model_validate(WHO | scene | planner | {"replicate": number, "plant": {"kind": plant}})


@dataclass
class Tally:
    """Of one planner in one case: how many had a path and how many of these kept the radius; how much longer; thread seconds."""

    flown: int = 0
    answered: int = 0
    kept: int = 0
    longer: list[float] = field(default_factory=list)
    times: list[float] = field(default_factory=list)

    def add(self, record: FlightRecord) -> None:
        self.flown += 1
        self.times.append(dict(record.timings)["answer_s"])
        event = next((one for one in record.events if one.decision in AVOIDING), None)
        if event is None:
            return
        self.answered += 1
        (obstacle,), columns = record.plan.obstacles, record.columns
        places = columns["time_s"], columns["own.pos_enu_m"], columns["obstacle.O.pos_enu_m"]
        self.kept += kept_and_flew_on(record.outcome, least_clearance(*places, obstacle.radius_m).clearance_m)
        self.longer.append(event.planned_length_m - math.dist(event.own_pos_enu_m, ENDS["goal_enu_m"]))

    def cells(self) -> list[str]:
        low, high = share_interval(self.kept, self.answered) if self.answered else (0.0, 1.0)
        kept = f"{100 * self.kept / self.answered:.0f} ({100 * low:.0f} to {100 * high:.0f})" if self.answered else "-"
        longer = f"{np.median(self.longer):.1f}" if self.longer else "-"
        return [f"{100 * self.answered / self.flown:.0f}", kept, longer]


def page(number: int) -> str:
    """The table, and what it is of."""
    tallies = {(kind, case): Tally() for case in CASES for kind in PLANNERS}
    for case in CASES:
        for k in range(number):
            for kind in PLANNERS:
                tallies[kind, case].add(fly(drawn(kind, *case[1:], k), until=Decided))
    heads = " | ".join(f"{name}, {lead_s:g} s: path % | kept % of these | m longer" for name, _, lead_s in CASES)
    rows = [
        "# The searches in space and time, flown",
        "",
        f"Written by `make_paths.py --encounters {number}`: {number} encounters a case, seed {SEED}, one obstacle at 0 to 50 m/s in any",
        f"direction, radius 10 to 30 m, aimed to pass within the radius. Own speed {SPEED_MPS:g} m/s, level, 750 m from the goal,",
        "answered 2 or 4 s before the closest approach. Calm air, gtm_t2, default options. Flights end when they are clear.",
        "",
        "Path: share of the encounters in which a path was found. Kept: of these, what kept the radius itself when flown, with its 95 %",
        "interval (Clopper-Pearson); the rest are unsafe answers. Longer: median of what the path is longer than the straight way to the",
        "goal. Time: processor time of an answer, median of all cases, and how many times SCOAM's in the same run on the same encounters.",
        "SCOAM plans with nothing to spare and asks nobody for limits, the searches with 5 m and within 0.9 of the aircraft's.",
        "",
        f"| planner | {heads} | time, ms | times SCOAM's |",
        "|---|" + "---|" * (3 * len(CASES) + 2),
    ]
    spent = {kind: float(np.median([t for case in CASES for t in tallies[kind, case].times])) for kind in PLANNERS}
    for kind in PLANNERS:
        cells = [cell for case in CASES for cell in tallies[kind, case].cells()]
        cells += [f"{1e3 * spent[kind]:.0f}", f"{spent[kind] / spent['scoam']:.0f}"]
        rows.append(f"| {' | '.join([f'[{kind}]({kind}.md)', *cells])} |")
    return "\n".join(rows) + "\n"


def pictured(kind: str) -> FlightRecord:
    """Past three spheres on rails."""
    spheres = [("A", 25, [300, 20, 305], 30, 150), ("B", 15, [320, -25, 300], 20, 60), ("C", 20, [520, 40, 305], 15, -100)]
    obstacles = [
        {"name": n, "radius_m": r, "position_enu_m": p, "speed_mps": v, "direction_deg": [a, 2], "when": {"time_s": p[0] / SPEED_MPS}}
        for n, r, p, v, a in spheres
    ]
    route = ENDS | {"goal_enu_m": [LONG, 0, 300]}
    scene = {"route": route, "obstacles": obstacles, "sensor": {"range_m": 400}, "plant": {"kind": "kinematic"}, "replicate": 0}
    return fly(FlightPlan.model_validate(WHO | scene | PLANNERS[kind]))


def panel(record: FlightRecord, axis: int, top: int, title: str) -> list[str]:
    """From above (axis 1) or from the side (axis 2): the flight, every sphere where it is each second and when it is nearest."""
    columns, middle = record.columns, 0.0 if axis == 1 else 300.0
    own, hz = columns["own.pos_enu_m"], record.plan.rates.plant_hz

    def pixel(place: np.ndarray) -> tuple[float, float]:
        return LEFT + SCALE * float(place[0]), SCALE * (WIDE_M - float(place[axis]) + middle)

    out = [f'<g transform="translate(0,{top})" clip-path="url(#frame)">']
    out.append(f'<rect x="{LEFT}" width="{SCALE * LONG:.0f}" height="{2 * SCALE * WIDE_M:.0f}" fill="#f7f7f5"/>')
    for colour, spec in zip(COLOURS, record.plan.obstacles, strict=True):
        there, radius = columns[f"obstacle.{spec.name}.pos_enu_m"], SCALE * spec.radius_m
        nearest = int(np.argmin(np.linalg.norm(own - there, axis=1)))
        for tick in range(nearest % hz, len(own), hz):
            if abs(tick - nearest) > 3 * hz:
                continue
            x, y = pixel(there[tick])
            fill = "0.35" if tick == nearest else "0.06"
            style = f'fill="{colour}" fill-opacity="{fill}" stroke="{colour}" stroke-width="0.6"'
            out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" {style}/>')
        x, y = pixel(own[nearest])
        out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{colour}" stroke="#fff"/>')
    line = " ".join("{:.1f},{:.1f}".format(*pixel(place)) for place in own[::12])
    right, level = LEFT + SCALE * LONG, SCALE * WIDE_M
    out.append(f'<line x1="{LEFT}" x2="{right:.0f}" y1="{level:.1f}" y2="{level:.1f}" stroke="#999" stroke-dasharray="4 3"/>')
    out.append(f'<polyline points="{line}" fill="none" stroke="#222" stroke-width="1.6"/></g>')
    out.append(f'<text x="{LEFT + 4}" y="{top + 14}" font-size="12" fill="#222">{title}</text>')
    return out


def picture(kind: str) -> str:
    """The SVG of one search."""
    record = pictured(kind)
    high = round(2 * SCALE * WIDE_M)
    width, height = round(2 * LEFT + SCALE * LONG), 2 * high + 8
    event = record.events[0]
    said = f"{event.planned_length_m:.0f} m planned, {event.path_clearance_m:.1f} m to spare"
    body = panel(record, 1, 0, f"from above: {said}") + panel(record, 2, high + 8, "from the side")
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif">'
    frame = f'<clipPath id="frame"><rect x="{LEFT}" width="{SCALE * LONG:.0f}" height="{high}"/></clipPath>'
    return "\n".join([head, frame, *body, "</svg>"]) + "\n"


def main() -> None:
    """Write everything."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--encounters", type=int, default=ENCOUNTERS, help="0 leaves the table as it is")
    number = parser.parse_args().encounters
    for kind in PATHS:
        (HERE / f"{kind}.svg").write_text(picture(kind), encoding="utf-8")
    if number:
        (HERE / "paths.md").write_text(page(number), encoding="utf-8")


if __name__ == "__main__":
    main()
