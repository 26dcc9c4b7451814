"""All rungs of one encounter and method of a run, flown again into one recording."""

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from testbed.campaign.words.grid import PART
from testbed.core.canonical import canonical
from testbed.flight.record import Outcome, inside, kept_and_flew_on
from testbed.run import journal
from testbed.run.directory import BadInputError, RunDirectory, recording_file
from testbed.run.engines import Died, Engine, LocalEngine, limited, usable_cores
from testbed.run.job import Job, JobResult, Row
from testbed.run.planned import Planned
from testbed.run.stored import existing, journal_read, plan_of, rows_of, world_of_run
from testbed.show import words

if TYPE_CHECKING:
    from testbed.show.recording.overlay import Flown

MOST = 10
"""So many flights can be told apart in one picture."""

WHO = ("flight_id", "campaign", "cell", "labels", "study", "limits")
RUNGS = ("plant", "aircraft", "begin", "guidance", "rates", "speed_hold", "traffic", "air", "plugins")
"""In what flights of one encounter and method may differ, apart from who they are: who flies, in which air, from where on."""


class Rung(NamedTuple):
    """How much of flight there is in a flight, and how rough the air is: 0 calm, 1 wind, 2 gusts."""

    plant: str
    ideal: tuple[str, ...]
    answer: str
    rough: int

    @property
    def main(self) -> bool:
        """Of the ladder from the paper's point to an aircraft: no limit switched off, no other answer."""
        return not self.ideal and self.answer != "direct"


@dataclass(frozen=True)
class Overlay:
    """The recording, and what each flight in it is called, the one that was asked for first; those that could not be shown, and why."""

    recording: Path
    names: tuple[str, ...]
    told: tuple[tuple[str, str], ...]
    """Of each whether it kept clear, and by how much."""
    left_out: tuple[str, ...]
    differences: tuple[str, ...]
    """Flights that came out otherwise than their row in the run says: the code, or a package, is not that of the run."""


def overlay(path: Path, cell: str, out: Path | None = None, every: bool = False, engine: Engine | None = None) -> Overlay:
    """Fly the rungs of a flight or cell again, and write them into one recording. ``every``: also those of a limit switched off.

    Raises ``BadInputError`` for a cell that the run does not have, with the nearest ones.
    """
    directory = existing(path)
    campaign, planned = plan_of(directory)
    flights = list(planned.flights)
    asked = asked_for(path, flights, cell)
    if campaign.study.part.flies:
        raise BadInputError(f"{path}: '{cell}' is what the study '{campaign.study.kind}' flies, and is not made of flights")
    chosen = chosen_rungs(directory, planned, flights, asked, every)
    recording = recording_file(out or directory.recordings / f"overlay_{flights[asked]['flight_id']}.rrd")
    world = world_of_run(directory)
    jobs = [Job(plan, world=world) for plan in planned.some(chosen)]
    flies = limited(engine or LocalEngine(min(len(jobs), usable_cores())), campaign.limits.wall_limit_s)
    answers = dict(flies.imap(flown_job, jobs))
    before = _least_of_rows(directory, planned, chosen)
    return _written(recording, [flights[number] for number in chosen], [answers[k] for k in range(len(jobs))], before)


def flown_job(job: Job) -> JobResult:
    """A flight with its record, which a row has not."""
    from testbed.flight.fly import fly
    from testbed.results.metrics import measure

    job.world.enter()
    record = fly(job.plan)
    return JobResult({}, {"record": record, "metrics": measure(record)}, {})


def _written(recording: Path, flights: list[Row], answers: list[Any], before: list[float | None]) -> Overlay:
    from testbed.show.recording.overlay import Flown, can_be_shown, write_overlay

    shown, left_out, differences = list["Flown"](), list[str](), list[str]()
    for name, answer, was in zip(map(_name, flights), answers, before, strict=True):
        if isinstance(answer, Died):
            left_out.append(f"{name}: {answer.reason}")
            continue
        flown = Flown(name, answer.series["record"], answer.series["metrics"])
        now = flown.metrics.least_clearance_m
        if was is not None and not (was == now or (math.isnan(was) and math.isnan(now))):
            differences.append(f"{name}: {words.clearance(now)}, and {words.clearance(was)} by its row")
        if can_be_shown(flown):
            shown.append(flown)
        else:
            left_out.append(f"{name}: {words.outcome_told(flown.record.outcome)}, it came near no obstacle")
    if not shown:
        raise BadInputError(f"none of the flights can be shown: {'; '.join(left_out)}")
    first = flights[0]
    write_overlay(shown, f"{first['campaign']}: {first['cell'] or first['flight_id']} and its other rungs", recording)
    return Overlay(recording, tuple(flown.name for flown in shown), tuple(map(_told, shown)), tuple(left_out), tuple(differences))


def _told(flown: "Flown") -> tuple[str, str]:
    """Whether a flight kept clear to its end, or what became of it; and its least clearance."""
    outcome, least_m = flown.metrics.outcome, flown.metrics.least_clearance_m
    if kept_and_flew_on(outcome, least_m):
        return "kept clear", words.clearance(least_m)
    return words.outcome(Outcome.COLLIDED if inside(least_m) else outcome), words.clearance(least_m)


def asked_for(path: Path, flights: list[Row], cell: str) -> int:
    """The number of the flight that is meant: by its id or the beginning of it, its cell, or the beginning of a cell."""
    ids, cells = [flight["flight_id"] for flight in flights], [flight["cell"] for flight in flights]
    wanted = cell.strip("/")
    for matches in (
        [n for n, name in enumerate(cells) if name == wanted],
        [n for n, name in enumerate(ids) if len(wanted) >= 4 and name.startswith(wanted)],
        [n for n, name in enumerate(cells) if name.startswith(f"{wanted}/")],
    ):
        if matches:
            return max(matches, key=lambda n: (_faithful(rung_of(flights[n])), -n))
    nearest = difflib.get_close_matches(wanted, list(dict.fromkeys([*cells, *ids])), n=3, cutoff=0.0)
    raise BadInputError(f"{path}: no cell or flight '{cell}'; nearest: {', '.join(nearest)}")


def _faithful(rung: Rung) -> tuple[bool, int, int]:
    """The more, the nearer to an aircraft in calm air."""
    return rung.main, list(words.RUNG_NAMES).index(rung.plant) if rung.plant in words.RUNG_NAMES else len(words.RUNG_NAMES), -rung.rough


def rung_of(flight: Row) -> Rung:
    """Of a flight as it stands in the plan."""
    air, plant = flight["air"], flight["plant"]
    windy = air["wind"]["kind"] != "calm" and air["wind"]["speed_mps"] > 0.0
    rough = 2 if air["turbulence"]["kind"] != "none" or air["gust"]["kind"] != "none" else int(windy)
    return Rung(plant["kind"], tuple(plant["ideal"]), flight["replan"]["answer"], rough)


def encounter_of(flight: Row) -> bytes:
    """What flights of one encounter and method have in common."""
    shared: Mapping[str, Any] = {name: value for name, value in flight.items() if name not in (*WHO, *RUNGS)}
    return canonical({**shared, "replan": {name: value for name, value in flight["replan"].items() if name != "answer"}})


def chosen_rungs(directory: RunDirectory, planned: Planned, flights: list[Row], asked: int, every: bool) -> list[int]:
    """Numbers of the flights to show, the one that was asked for first.

    Of one air every rung; of calm air, of wind and of gusts, as far as that is another, the rung nearest to an aircraft, in the worst
    that was flown.
    """
    by_rung: dict[Rung, list[int]] = {}
    for number in _alike(flights, asked):
        by_rung.setdefault(rung_of(flights[number]), []).append(number)
    best = max(_faithful(rung)[1] for rung in by_rung)
    mine, air = rung_of(flights[asked]), _air_of_rungs(flights, by_rung, asked)
    chosen = [asked]
    for rung, numbers in sorted(by_rung.items(), key=lambda item: (item[0].rough, not item[0].main, _faithful(item[0])[1])):
        in_it = [n for n in numbers if _air(flights[n]) == air]
        if rung != mine and (every or (rung.main and (in_it or _faithful(rung)[1] == best))):
            nearest = _nearest(flights, in_it or numbers, asked)
            chosen.append(nearest[0] if in_it else _worst(directory, planned, nearest))
    return chosen[:MOST]


def _alike(flights: list[Row], asked: int) -> list[int]:
    """The flights of the same encounter and method, and of one aircraft: a point on rails is a rung of each, whatever it is set to."""
    family = encounter_of(flights[asked])
    alike = [n for n, flight in enumerate(flights) if n == asked or encounter_of(flight) == family]
    flown = [n for n in alike if not _on_rails(flights[n])]
    aircraft = flights[asked]["aircraft"]
    if flown and not any(flights[n]["aircraft"] == aircraft for n in flown):
        aircraft = flights[max(flown, key=lambda n: (_faithful(rung_of(flights[n])), -n))]["aircraft"]
    return [n for n in alike if _on_rails(flights[n]) or flights[n]["aircraft"] == aircraft]


def _on_rails(flight: Row) -> bool:
    """Whether it is the point of the paper, which has nothing of an aircraft."""
    return bool(flight["plant"]["kind"] == "kinematic")


def _air(flight: Row) -> bytes:
    """What tells the air of a flight from others; calm is calm, also as a wind of no speed."""
    return canonical(flight["air"]) if rung_of(flight).rough else b""


def _air_of_rungs(flights: list[Row], by_rung: Mapping[Rung, list[int]], asked: int) -> bytes:
    """The air in which the rungs are shown: the asked flight's, if there are several in it, else that of the most; the calmest first."""
    plants: dict[bytes, set[str]] = {_air(flights[asked]): {flights[asked]["plant"]["kind"]}}
    rough = {_air(flights[asked]): rung_of(flights[asked]).rough}
    for rung, numbers in by_rung.items():
        for air in {_air(flights[n]) for n in numbers if rung.main}:
            plants.setdefault(air, set()).add(rung.plant)
            rough[air] = rung.rough
    return max(plants, key=lambda air: (air == _air(flights[asked]) and len(plants[air]) > 1, len(plants[air]), -rough[air]))


def _nearest(flights: list[Row], numbers: list[int], asked: int) -> list[int]:
    """Those that differ least from the asked flight, apart from the rung: another part of the campaign only where its own has none."""

    def apart(number: int) -> tuple[bool, bool, int]:
        one, other = flights[number], flights[asked]
        names = ["guidance", "rates", "speed_hold"]
        names += ["traffic"] if rung_of(one).rough and rung_of(other).rough else []  # in calm air all traffic is the same
        settings = sum(one[name] != other[name] for name in names)
        return one["labels"].get(PART) != other["labels"].get(PART), one["aircraft"] != other["aircraft"], settings

    least = min(map(apart, numbers))
    return [n for n in numbers if apart(n) == least]


def _worst(directory: RunDirectory, planned: Planned, numbers: list[int]) -> int:
    """Of some flights the one that came closest, by their rows; the first while none has a row."""
    least = _least_of_rows(directory, planned, numbers)
    close = [(value, n) for value, n in zip(least, numbers, strict=True) if value is not None and math.isfinite(value)]
    return min(close)[1] if close else numbers[0]


def _least_of_rows(directory: RunDirectory, planned: Planned, numbers: list[int]) -> list[float | None]:
    """The least clearance of each flight by its row; None where it has none."""
    rows = rows_of(directory)
    places = rows.places(planned.ids[numbers])
    with journal_read():
        found = iter(rows.lines(places[places >= 0], journal.row_of))
        return [next(found)["least_clearance_m"] if place >= 0 else None for place in places]


def _name(flight: Row) -> str:
    """What tells a flight from the others: rung and air."""
    rung = rung_of(flight)
    return f"{words.rung(rung.plant, rung.ideal, rung.answer)} {words.air_of(flight['air'])}"
