"""Writes ``aircraft.md``: ``python docs/make_aircraft.py``, or ``make aircraft-table``; with names, only prints their rows.

Each model of JSBSim's wheel goes through ``aircraft new`` and ``tune``, with no number set by hand, and then flies a racetrack in calm
air and in moderate turbulence, in a folder that is thrown away: neither model files nor gains are kept.
"""

import argparse
import math
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

from testbed import expand, fly, load_campaign, measure
from testbed.airframe.new import NewAircraftError, add_aircraft
from testbed.airframe.proof_courses import turn_radius
from testbed.airframe.tune import TuneFailedError, tune
from testbed.campaign.reading.aircraft import read_aircraft
from testbed.core.catalogue import add_aircraft_path
from testbed.core.units import DEG

HERE = Path(__file__).parent
MODELS = (
    "J3Cub T38 A4 737 OV10 f16 t6texan2 B747 pa28 c310 p51d c182 DHC6 C130 X15 c172x Camel f15 pc7 T37 c172p".split()
)  # the fixed-wing aircraft of the wheel that JSBSim itself trims, and some whose engines stop in its trim
STRAIGHT_S, RADII, LAPS = 20.0, 2.0, 2
WORKERS = 2

CAMPAIGN = """\
name: racetrack
question: Does it hold a racetrack?
seed: 20210
speed_mps: {speed:g}
terrain_z_m: -300
route:
  start_enu_m: [0, 0, 0]
  start_direction_deg: [0, 0]
  shape: {{kind: racetrack, straight_m: {straight:.0f}, radius_m: {radius:.0f}, laps: {laps}}}
method: {{kind: none}}
plant: {{kind: jsbsim}}
aircraft: '{name}'
sweep:
  air.turbulence:
    - {{kind: none}}
    - {{kind: dryden, severity: moderate}}
"""

HEAD = """\
# Aircraft of JSBSim's wheel, taken as they are

Written by `make aircraft-table` (`docs/make_aircraft.py`): `testbed aircraft new NAME --wheel MODEL`, `testbed tune NAME --accept`, then
{laps} laps of a racetrack in JSBSim at the reference airspeed that the first of them picks: straights of {straight:g} s, turns of
{radii:g} times the radius of the level turn at the aircraft's own bank limit, 300 m above the ground, in calm air and in moderate
Dryden turbulence. No number was set by hand. {flown} of {all} fly it: they reach the end in both.

*verified*: every line of `tune`'s verification passed; otherwise how many were missed (the file has them under `missed`).

| model | level trims, m/s | reference, m/s | turn radius, m | calm RMS, m | moderate RMS, m | verified |
| --- | --- | ---: | ---: | ---: | ---: | --- |
"""


NOTES = """
Why those that do not trim do not: the engine of the C130 is a turbine that hands its thrust to a propeller as if that were power, and
pulls with a few hundred newtons at full throttle; the tanks of the X15 are empty, and its rocket gives nothing; the thrust of the p51d
is the same at every throttle, since its file takes the throttle from a property of FlightGear's. The Camel is statically unstable in
pitch where it flies.
"""


class Row(NamedTuple):
    """One model: the cells of the table, whether it flew, or why not."""

    model: str
    flew: bool
    cells: tuple[str, ...]

    @property
    def text(self) -> str:
        return f"| {' | '.join((self.model, *self.cells))} |"


def row(model: str) -> Row:
    """Make an aircraft of a model, tune it, fly it."""
    name = model.lower()
    with tempfile.TemporaryDirectory(prefix="hangar-") as hangar:
        try:
            report = add_aircraft(name, model, None, None, Path(hangar))
        except NewAircraftError as error:
            return Row(model, False, ("none", "", "", "", "", str(error)))
        trims = report.partition(" from ")[2].partition(" m/s")[0]
        add_aircraft_path(Path(hangar))
        try:
            tune(name, write=True, accept=True)
        except TuneFailedError as error:
            return Row(model, False, (trims, "", "", "", "", str(error)))
        aircraft = read_aircraft(Path(hangar) / name)
        speed = aircraft.autopilot.reference_mps
        radius = RADII * turn_radius(speed, aircraft.limits.bank_deg * DEG)
        file = Path(hangar) / "racetrack.yaml"
        file.write_text(CAMPAIGN.format(name=name, speed=speed, straight=STRAIGHT_S * speed, radius=radius, laps=LAPS), encoding="utf-8")
        flights = [measure(fly(plan)) for plan in expand(load_campaign(file))]
    flown = [f"{flight.cross_track_rms_m:.2f}" if flight.outcome == "reached" else str(flight.outcome) for flight in flights]
    count = len(aircraft.missed)
    verified = "yes" if aircraft.verified else f"no: {count} line{'s' * (count > 1)} missed"
    flew = all(flight.outcome == "reached" and math.isfinite(flight.cross_track_rms_m) for flight in flights)
    return Row(model, flew, (trims, f"{speed:g}", f"{radius:.0f}", *flown, verified))


def main() -> None:
    """Every model, in two processes; the table, in the order of ``MODELS``."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="*")
    wanted = parser.parse_args().models
    began = time.monotonic()
    rows = []
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn"), max_tasks_per_child=1) as pool:
        for one in pool.map(row, wanted or MODELS):
            print(one.text, f"after {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
            rows.append(one)
    if wanted:
        return
    flown = sum(one.flew for one in rows)
    head = HEAD.format(laps=LAPS, straight=STRAIGHT_S, radii=RADII, flown=flown, all=len(rows))
    (HERE / "aircraft.md").write_text(head + "\n".join(one.text for one in rows) + "\n" + NOTES, encoding="utf-8")


if __name__ == "__main__":
    main()
