"""Writes the tables of ``docs/survivor.md`` from a run of ``campaigns/survivor.yaml``: ``python docs/make_survivor.py [RUN]``.

The rest of the page is written by hand; the tables stand between two marks in it.
"""

import csv
import sys
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from testbed.airframe.foresight import AIR_WORDS
from testbed.core.catalogue import aircraft_folders
from testbed.flight.planning.prediction import read_prediction
from testbed.results.statistics import Effect, mcnemar, median, share, share_difference

FILE = Path(__file__).with_name("survivor.md")
RUN = Path("reports/runs/survivor")
BEGINS, ENDS = "<!-- {} begins -->", "<!-- {} ends -->"
AGAINST = "least_deflection"
PARTS = {
    "one_calm": "One obstacle, calm air",
    "one_turbulent": "One obstacle, moderate turbulence",
    "three_calm": "Three obstacles, calm air",
}

Row = Mapping[str, str]
Flights = dict[str, dict[str, Row]]  # planner to encounter to row


def flights_of(run: Path) -> dict[str, Flights]:
    """The rows of each part, with the time of the slowest decision."""
    with (run / "timings.csv").open(newline="") as file:
        slowest = {row["flight_id"]: row["fly.answer_s"] for row in csv.DictReader(file)}
    found: dict[str, Flights] = defaultdict(lambda: defaultdict(dict))
    with (run / "results.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            row["answer_s"] = slowest[row["flight_id"]]
            found[row["label.part"]][row["label.planner"]][row["replicate"]] = row
    return found


def kept(row: Row) -> bool:
    """Did it keep every radius and fly on?"""
    return row["kept_clear"].lower() == "true" and row["outcome"] not in ("hit_ground", "diverged")


def number(row: Row, column: str) -> float:
    """NaN for an empty field."""
    return float(row[column] or "nan")


def percent(effect: Effect, digits: int = 0) -> str:
    """A share, or a difference of shares, with its interval."""
    return f"{100 * effect.value:.{digits}f} ({100 * effect.low:.{digits}f} to {100 * effect.high:.{digits}f})"


def of_part(flights: Flights) -> list[str]:
    """A table: what each planner kept, and its difference from the first where both kept."""
    first, n = flights[AGAINST], len(flights[AGAINST])
    rows = [
        "| planner | kept, of all, % | less that of `least_deflection`, points | only it kept / only `least_deflection` (exact p) |"
        " path longer by, median m |"
        " largest deflection, median and 95th percentile, deg | slowest decision, median and 99th percentile, ms |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for name, own in flights.items():
        both = [(first[key], row) for key, row in own.items() if kept(row) and kept(first[key])]
        gained = sum(kept(row) and not kept(first[key]) for key, row in own.items())
        lost = sum(kept(first[key]) and not kept(row) for key, row in own.items())
        difference = share_difference("", lost, gained, n)
        longer = median("", "m", (number(b, "path_length_m") - number(a, "path_length_m") for a, b in both))
        turned = [number(row, "peak_deflection_deg") for key, row in own.items() if kept(row) and kept(first[key])]
        took = [1e3 * number(row, "answer_s") for row in own.values()]
        is_first = name == AGAINST
        cells = [
            f"`{name}`",
            f"{sum(map(kept, own.values()))} of {len(own)}: {percent(share('', sum(map(kept, own.values())), len(own)))}",
            "" if is_first else percent(difference),
            "" if is_first else f"{gained} / {lost} (p {mcnemar(lost, gained):.2g})",
            "" if is_first else f"{longer.value:.1f} ({longer.low:.1f} to {longer.high:.1f}), {longer.n} pairs",
            "{:.0f}, {:.0f}".format(*np.nanpercentile(turned, (50, 95))),
            "{:.1f}, {:.1f}".format(*np.nanpercentile(took, (50, 99))),
        ]
        rows.append(f"| {' | '.join(cells)} |")
    never = sum(not any(kept(own[key]) for own in flights.values()) for key in first)
    return [*rows, "", f"{never} of the {n} encounters none of the four kept.", *depth(flights)]


def depth(flights: Flights) -> list[str]:
    """How deep the collisions were."""
    found = {name: [number(row, "least_clearance_m") for row in own.values() if not kept(row)] for name, own in flights.items()}
    words = [f"`{name}` {np.median(deep):.1f}" for name, deep in found.items() if deep]
    return [f"Median clearance of those lost, m: {', '.join(words)}."] if words else []


def comparison(run: Path) -> str:
    """The tables of the campaign."""
    parts = flights_of(run)
    return "\n\n".join(f"**{PARTS[name]}.**\n\n" + "\n".join(of_part(parts[name])) for name in PARTS if name in parts)


def margins() -> str:
    """What was identified, of every aircraft that was."""
    lines = ["| aircraft | air | flights | margin (99 %), m, by time to go up to {} s |", "| --- | --- | --- | --- |"]
    ends: Sequence[float] = ()
    for name, folder in aircraft_folders().items():
        if found := read_prediction(folder):
            for air, margin in found.margins.items():
                ends = margin.within_s
                lines.append(f"| `{name}` | {AIR_WORDS[air]} | {margin.flights} | {', '.join(f'{m:.2f}' for m in margin.margin_m)} |")
    return "\n".join(lines).format(", ".join(f"{end:g}" for end in ends))


def put(text: str, name: str, between: str) -> str:
    """The text with something else between two marks."""
    begins, ends = BEGINS.format(name), ENDS.format(name)
    before, _, rest = text.partition(begins)
    return f"{before}{begins}\n\n{between}\n\n{ends}{rest.partition(ends)[2]}"


if __name__ == "__main__":
    page = put(FILE.read_text(encoding="utf-8"), "margins", margins())
    FILE.write_text(put(page, "comparison", comparison(Path(sys.argv[1]) if len(sys.argv) > 1 else RUN)), encoding="utf-8")
