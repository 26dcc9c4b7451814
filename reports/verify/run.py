"""A run directory: its plan, its rows, and which of its flights kept their raw columns."""

import csv
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

TAKEN = ("crashed", "trim_failed")  # outcomes without a flight: there is nothing to compute them from
NUMBERS = (
    "least_clearance_m time_at_least_clearance_s replans trigger_time_s path_length_m flight_time_s deflection_deg deflection_ground_deg "
    "flown_deflection_deg flown_deflection_air_deg peak_deflection_deg peak_deflection_air_deg avoidance_time_s insertion_miss_m "
    "clear_time_s wind_along_std_mps route_miss_m"
).split()
WORDS = ("outcome", "nearest_obstacle")


class BadInputError(Exception):
    """The directory cannot be verified; str() says why."""


def read_json(path: Path) -> Any:
    """A JSON file of the run."""
    try:
        return json.loads(path.read_bytes())
    except OSError:
        raise BadInputError(f"{path.parent}: no {path.name} here; is it a run directory?") from None
    except ValueError as problem:
        raise BadInputError(f"{path}: damaged ({problem})") from None


def read_csv(path: Path) -> list[dict[str, str]]:
    """The rows of a table, every field as its text."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError:
        raise BadInputError(f"{path.parent}: no {path.name} here; is it a run directory?") from None
    except (csv.Error, UnicodeDecodeError) as problem:
        raise BadInputError(f"{path}: damaged ({problem})") from None
    if any(None in row or None in row.values() for row in rows):
        raise BadInputError(f"{path}: damaged (a row has more or fewer fields than the heading)")
    return rows


def figure_of(text: str | float | None) -> float:
    """A field of a table as a number; NaN where it is empty."""
    return math.nan if text is None or text == "" else float(text)


def keeps(campaign: Mapping[str, Any], flight: Mapping[str, Any]) -> bool:
    """Should this flight of the plan have left its raw columns?"""
    part = (campaign.get("parts") or {}).get(flight["labels"].get("part")) or {}
    kept = part.get("columns") or campaign.get("columns") or "none"
    return bool(kept == "all" or (kept == "selected" and flight["replicate"] == 0))


@dataclass(frozen=True)
class Run:
    """A run directory: its plan, its rows by flight, and the raw columns of those that kept them."""

    path: Path
    campaign: Mapping[str, Any]
    flights: Mapping[str, Mapping[str, Any]]
    rows: Mapping[str, Mapping[str, str]]

    def kept(self) -> Iterator[tuple[str, Path]]:
        """Flights that have a row and should have raw columns, in plan order."""
        for flight_id, flight in self.flights.items():
            row = self.rows.get(flight_id)
            if row is not None and row["outcome"] not in TAKEN[:1] and keeps(self.campaign, flight):
                yield flight_id, self.path / "columns" / f"{flight_id}.parquet"


def open_run(path: Path) -> Run:
    """A run that has rows and raw columns, all of them."""
    if not path.is_dir():
        raise BadInputError(f"{path}: no such directory")
    plan, rows = read_json(path / "plan.json"), read_csv(path / "results.csv")
    try:
        flights = {flight["flight_id"]: flight for flight in plan["flights"]}
        _ = [(flight["labels"], flight["replicate"], flight["cell"]) for flight in flights.values()]
        run = Run(path, plan["campaign"], flights, {row["flight_id"]: row for row in rows})
        lacking = [name for name in (*NUMBERS, *WORDS, "cell") if rows and name not in rows[0]]
        kept = list(run.kept())
    except (KeyError, TypeError, AttributeError) as problem:
        raise BadInputError(f"{path}: not a run of this version of testbed ({type(problem).__name__}: {problem})") from None
    if lacking:
        raise BadInputError(f"{path / 'results.csv'}: has no column {', '.join(lacking)}")
    if not kept:
        raise BadInputError(f"{path}: no flight of this run kept its raw columns; fly it with --set columns=all")
    missing = [file for _, file in kept if not file.is_file()]
    if missing:
        more = f" and {len(missing) - 3} more" if len(missing) > 3 else ""
        names = ", ".join(f"columns/{file.name}" for file in missing[:3])
        raise BadInputError(f"{path}: raw columns are missing: {names}{more} (of {len(kept)} flights that kept them)")
    return run
