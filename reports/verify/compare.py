"""What a run says beside what was computed again: flight by flight, and counted in cells."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from .daa_volumes import entries_of, volumes_of
from .metrics import metrics_of
from .raw import read_raw
from .run import NUMBERS, TAKEN, WORDS, BadInputError, Run, figure_of

AGREE = 1e-6  # in the unit of a figure


@dataclass(frozen=True)
class Difference:
    """Something that the run says and that was computed otherwise. ``size`` orders differences of the same kind."""

    where: str
    quantity: str
    said: str
    found: str
    size: float


@dataclass
class Comparison:
    """Differences of one quantity over many flights: how many were compared, and the worst."""

    compared: int = 0
    worst: float = 0.0
    worst_flight: str = ""

    def take(self, flight_id: str, said: float, found: float) -> float:
        """One flight more; how far apart its figures are."""
        size = apart(said, found)
        self.compared += not (math.isnan(said) and math.isnan(found))
        if size > self.worst:
            self.worst, self.worst_flight = size, flight_id
        return size


def compare_flights(run: Run) -> tuple[dict[str, dict[str, float | str]], dict[str, Comparison], list[Difference]]:
    """The metrics of every flight with raw columns, the worst difference of each quantity, and what does not agree."""
    own: dict[str, dict[str, float | str]] = {}
    worst = {name: Comparison() for name in NUMBERS}
    volumes = volumes_of(run.campaign)
    differences = [Difference("results.csv", "flight", name, "not in the plan", math.inf) for name in run.rows if name not in run.flights]
    for flight_id, file in run.kept():
        row, raw = run.rows[flight_id], read_raw(file)
        where = f"{flight_id} {row['cell']}"
        if raw.about["flight_id"] != flight_id or row["cell"] != run.flights[flight_id]["cell"]:
            raise BadInputError(f"{file}: of flight {raw.about['flight_id']} in another run, or the tables are of another plan")
        try:
            found = metrics_of(raw) | entries_of(raw, volumes)
        except (KeyError, TypeError, ValueError, IndexError) as problem:
            raise BadInputError(f"{file}: cannot be computed from ({type(problem).__name__}: {problem})") from None
        if row["outcome"] in TAKEN:
            found["outcome"] = row["outcome"]
        own[flight_id] = found
        for name in NUMBERS:
            said = said_of(run.path / "results.csv", flight_id, name, row[name])
            size = worst[name].take(flight_id, said, float(found[name]))
            if size > AGREE:
                differences.append(Difference(where, name, shown(said), shown(float(found[name])), size))
        differences += [
            Difference(where, name, row[name] or "nothing", str(found[name]) or "nothing", math.inf)
            for name in WORDS
            if row[name] != found[name]
        ]
    return own, worst, differences


def compare_counts(run: Run, own: Mapping[str, Mapping[str, float | str]]) -> tuple[int, list[Difference]]:
    """Outcomes counted in each cell, of flights with raw columns: how many cells, and what does not agree."""
    said: dict[str, Counter[str]] = {}
    found: dict[str, Counter[str]] = {}
    for flight_id, metrics in own.items():
        cell = str(run.flights[flight_id]["cell"])
        said.setdefault(cell, Counter())[run.rows[flight_id]["outcome"]] += 1
        found.setdefault(cell, Counter())[str(metrics["outcome"])] += 1
    unlike = [cell for cell in said if said[cell] != found[cell]]
    return len(said), [Difference(cell, "outcomes", _counted(said[cell]), _counted(found[cell]), math.inf) for cell in unlike]


def _counted(counts: Counter[str]) -> str:
    return ", ".join(f"{counts[name]} {name}" for name in sorted(counts))


def said_of(path: Path, flight_id: str, name: str, text: str) -> float:
    """What a table says of a flight (or of a claim); a text that is no number cannot be verified."""
    try:
        return figure_of(text)
    except ValueError:
        raise BadInputError(f"{path}: flight {flight_id}: {name} is not a number: '{text}'") from None


def shown(value: float) -> str:
    """A figure with all its digits."""
    return "nothing" if math.isnan(value) else repr(value)


def apart(a: float, b: float) -> float:
    """Difference of two figures; none of two that do not exist, infinite of one that does not."""
    if math.isnan(a) or math.isnan(b):
        return 0.0 if math.isnan(a) and math.isnan(b) else math.inf
    return 0.0 if a == b else abs(a - b)
