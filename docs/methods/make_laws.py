"""Writes ``laws.md`` and the pictures of the guidance laws: ``python docs/methods/make_laws.py [--encounters N]``.

Every law flies the same encounters, on rails and as a point mass, from the same lead on, until the flight is clear. ``--encounters 0``
leaves the table as it is and draws the pictures again.
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from testbed.campaign.words.population import Encounters
from testbed.campaign.words.settings import FlightPlan
from testbed.flight.fly import fly
from testbed.flight.laws import LAWS
from testbed.flight.planning.decided import Decided
from testbed.flight.record import FlightRecord, kept_and_flew_on
from testbed.flight.traffic.track import least_clearance
from testbed.results.statistics import share_interval, spread

HERE = Path(__file__).parent
SEED, ENCOUNTERS, SPEED_MPS, LEAD_S = 20210, 1000, 50.0, 1.5
PLANTS = {"kinematic": "on rails", "point_mass": "point mass"}
VARIANTS: dict[str, dict[str, Any]] = {"geometric_guidance": {"form": "differential"}, "proportional_navigation": {"plane": "free"}}
CASES = [("scoam", {}), *((law, options) for law in LAWS for options in ({}, VARIANTS.get(law)) if options is not None)]
POPULATION = Encounters(
    own_at_enu_m=(150, 0, 300),
    own_direction_deg=(0, 0),
    trigger={"time_to_cpa_s": LEAD_S},
    obstacle_speed_mps=(0, 50),
    radius_m=(10, 30),
)
PICTURED = 2  # the encounter that is drawn
STYLES = {"kinematic": 'stroke="#2a6fb0"', "point_mass": 'stroke="#c7621b" stroke-dasharray="5 3"'}


def plan(method: str, options: dict[str, Any], plant: str, number: int) -> FlightPlan:
    """The flight of one encounter: seen from afar, answered ``LEAD_S`` before the closest approach."""
    who = {"flight_id": "", "campaign": "laws", "cell": "", "labels": {}, "replicate": number, "seed": SEED}
    ends = {"start_enu_m": [0, 0, 300], "goal_enu_m": [1000, 0, 300], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
    scene = {"route": ends, "begin": {"at_route_s_m": 145}, "obstacles": POPULATION.drawn(SPEED_MPS, SEED, number)}
    planner = {"sensor": {"range_m": 1000}, "replan": {"horizon_s": LEAD_S + 0.5 / 60}, "method": {"kind": method, "options": options}}
    return FlightPlan.model_validate(who | scene | planner | {"plant": {"kind": plant}})


def flown(method: str, options: dict[str, Any], plant: str, number: int) -> FlightRecord:
    """Until it is clear."""
    return fly(plan(method, options, plant, number), until=Decided)


def clearance_m(record: FlightRecord) -> float:
    """Least, from the radius itself."""
    columns, (obstacle,) = record.columns, record.plan.obstacles
    places = columns["time_s"], columns["own.pos_enu_m"], columns["obstacle.O.pos_enu_m"]
    return least_clearance(*places, obstacle.radius_m).clearance_m


@dataclass
class Tally:
    """Of one law on one plant: how many kept the radius, clearances (m), greatest load factors."""

    kept: int = 0
    clearances: list[float] = field(default_factory=list)
    loads: list[float] = field(default_factory=list)

    def add(self, record: FlightRecord) -> None:
        self.clearances.append(clearance_m(record))
        self.kept += kept_and_flew_on(record.outcome, self.clearances[-1])
        self.loads.append(float(np.abs(record.columns["own.load_factor"]).max()))

    def cells(self) -> list[str]:
        n = len(self.clearances)
        low, high = share_interval(self.kept, n)
        clear, load = spread(self.clearances), spread(self.loads)
        return [
            f"{100 * self.kept / n:.1f} ({100 * low:.1f} to {100 * high:.1f})",
            f"{clear.median:.1f} ({clear.p05:.1f})",
            f"{load.median:.2f}",
            f"{load.p95:.2f}",
        ]


def page(number: int) -> str:
    """The table, and what it is of."""
    heads = " | ".join(f"{name}: kept % | clearance m | load | 95 %" for name in PLANTS.values())
    rows = [
        "# The guidance laws, flown",
        "",
        f"Written by `make_laws.py --encounters {number}`: {number} encounters, seed {SEED}, each answered {LEAD_S:g} s before the closest",
        f"approach. Own speed {SPEED_MPS:g} m/s, one obstacle at 0 to 50 m/s in any direction, radius 10 to 30 m, aimed to pass within the",
        "radius: every one hits who flies straight on. Calm air, gtm_t2, default options unless named. Flights end when they are clear.",
        "",
        "Kept: share of the flights that kept the radius itself, with its 95 % interval (Clopper-Pearson). Clearance: median and 5th",
        "percentile, from the radius itself; the laws keep 2 m more (`spare_m`), SCOAM, which plans a path through an insertion point,",
        "nothing. Load: the greatest load factor of a flight, its median and 95th percentile. Rails have no limit but the law's own",
        "(`most_mps2`, 25 m/s^2); the point mass has the aircraft's.",
        "",
        f"| law | {heads} |",
        "|---|" + "---|" * (4 * len(PLANTS)),
    ]
    for method, options in CASES:
        tallies = {plant: Tally() for plant in PLANTS}
        for k in range(number):
            for plant, tally in tallies.items():
                tally.add(flown(method, options, plant, k))
        name = f"[{method}]({method}.md)" + "".join(f" {key}={value}" for key, value in options.items())
        rows.append(f"| {' | '.join([name, *(cell for tally in tallies.values() for cell in tally.cells())])} |")
    return "\n".join(rows) + "\n"


def line(x: Sequence[float] | np.ndarray, y: Sequence[float] | np.ndarray, style: str) -> str:
    """Through picture coordinates."""
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return f'<polyline points="{points}" fill="none" stroke-width="1.6" {style}/>'


def text(x: float, y: float, words: str, more: str = "") -> str:
    """Words at a place of the picture."""
    return f'<text x="{x:.0f}" y="{y:.0f}" font-size="11" fill="#333" {more}>{words}</text>'


def picture(law: str) -> str:
    """Left the flight about the sphere: along the first relative velocity, and away from the line through the centre. Right the
    acceleration across the velocity, against time from the decision on.
    """
    width, height, middle = 320, 200, 130
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * width + 20}" height="{height + 44}" font-family="sans-serif">',
        f'<clipPath id="left"><rect x="4" y="22" width="{width}" height="{height}"/></clipPath>',
        f'<rect x="4" y="22" width="{width}" height="{height}" fill="#f7f7f5"/>',
        f'<rect x="{width + 16}" y="22" width="{width}" height="{height}" fill="#f7f7f5"/>',
        text(4, 15, "seen from the obstacle, m"),
        text(width + 16, 15, "acceleration across the velocity, m/s², against seconds"),
    ]
    records = {plant: flown(law, {}, plant, PICTURED) for plant in PLANTS}
    accelerations = {plant: across(record) for plant, record in records.items()}
    most = max(sizes[np.isfinite(sizes)].max() for _, sizes in accelerations.values())
    scale, radius = 1.7, records["kinematic"].plan.obstacles[0].radius_m
    sphere = f'cx="{4 + 0.68 * width:.1f}" cy="{22 + middle}" r="{scale * radius:.1f}" clip-path="url(#left)"'
    out += [
        f'<circle {sphere} fill="#c44e52" fill-opacity="0.25" stroke="#c44e52"/>',
        f'<line x1="4" x2="{4 + width}" y1="{22 + middle}" y2="{22 + middle}" stroke="#bbb" stroke-width="0.6"/>',
    ]
    for plant, record in records.items():
        ahead, aside = about(record)
        x, y = 4 + 0.68 * width + scale * ahead, 22 + middle - scale * aside
        inside = x > 0
        out.append(line(x[inside][::3], y[inside][::3], STYLES[plant] + ' clip-path="url(#left)"'))
        times, sizes = accelerations[plant]
        shown = (times >= -0.2) & (times <= 2.0)
        out.append(line(width + 16 + width * (times[shown] + 0.2) / 2.2, 22 + height * (1.0 - sizes[shown] / (1.2 * most)), STYLES[plant]))
    for tick in np.arange(0.0, 2.1, 0.5):
        out.append(text(width + 12 + width * (tick + 0.2) / 2.2, height + 36, f"{tick:g}"))
    step = 10.0 ** math.floor(math.log10(most))
    step = step if most / step > 2.5 else 0.5 * step
    for level in np.arange(step, 1.1 * most, step):
        y = 22 + height * (1.0 - level / (1.2 * most))
        out.append(f'<line x1="{width + 16}" x2="{2 * width + 16}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ccc" stroke-width="0.6"/>')
        out.append(text(width + 19, y - 2, f"{level:g}"))
    out += [text(10, height + 36, "on rails", 'style="fill:#2a6fb0"'), text(70, height + 36, "point mass (dashed)", 'style="fill:#c7621b"')]
    return "\n".join([*out, "</svg>"]) + "\n"


def about(record: FlightRecord) -> tuple[np.ndarray, np.ndarray]:
    """Place along the first relative velocity, and distance from the line through the centre, m: where the sphere is a circle."""
    columns = record.columns
    place = columns["own.pos_enu_m"] - columns["obstacle.O.pos_enu_m"]
    way = (place[1] - place[0]) / np.linalg.norm(place[1] - place[0])
    ahead = place @ way
    return ahead, np.linalg.norm(place - np.outer(ahead, way), axis=1)


def across(record: FlightRecord) -> tuple[np.ndarray, np.ndarray]:
    """Time from the decision on (s) and the acceleration across the velocity (m/s^2), without gravity."""
    velocity, time_s = record.columns["own.vel_enu_mps"], record.columns["time_s"]
    change = np.gradient(velocity, time_s, axis=0)
    ahead = velocity / np.linalg.norm(velocity, axis=1)[:, None]
    return time_s - record.events[0].time_s, np.linalg.norm(change - np.sum(change * ahead, axis=1)[:, None] * ahead, axis=1)


def main() -> None:
    """Write everything."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--encounters", type=int, default=ENCOUNTERS, help="0 leaves the table as it is")
    number = parser.parse_args().encounters
    for law in LAWS:
        (HERE / f"{law}.svg").write_text(picture(law), encoding="utf-8")
    if number:
        (HERE / "laws.md").write_text(page(number), encoding="utf-8")


if __name__ == "__main__":
    main()
