"""What a campaign answers: counts, pairs of kinematic and flown flights, and the sentences on top of the page."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from testbed.results.checks import CheckResult
from testbed.results.columns import BY_NAME
from testbed.results.flight_row import collided, keeps, met_obstacle, value
from testbed.results.statistics import share_interval
from testbed.show import words
from testbed.show.shown_columns import SUMMARISED, text
from testbed.show.words import number

Row = dict[str, Any]

KINEMATIC = "kinematic"  # the plant that is a point on its path


def flyer(row: Row) -> str:
    """Who flew."""
    return words.flyer(str(row["plant"]), str(row["aircraft"]))


def method(row: Row) -> str:
    """The avoidance method, with those of its options that are swept."""
    return words.method_with(str(row["method"]), row["labels"])


def listed_axes(rows: Sequence[Row]) -> list[str]:
    """Sweep axes that are not just the plant, the aircraft or the method once more, in the flights that have the axis."""
    axes = dict.fromkeys(axis for row in rows for axis in row["labels"])
    return [
        axis
        for axis in axes
        if not any(all(row["labels"].get(axis, str(row[key])) == str(row[key]) for row in rows) for key in ("plant", "aircraft", "method"))
    ]


def telling_axes(rows: Sequence[Row]) -> list[str]:
    """Sweep axes that say more than flyer, method and geometry together do."""
    axes = dict.fromkeys(axis for row in rows for axis in row["labels"])

    def said_already(axis: str) -> bool:
        labels: dict[tuple[str, str, str], set[str]] = {}
        for row in rows:
            if axis in row["labels"]:
                labels.setdefault((flyer(row), method(row), str(row.get("geometry"))), set()).add(str(row["labels"][axis]))
        return all(len(seen) == 1 for seen in labels.values())

    return [axis for axis in axes if not said_already(axis)]


def circumstances(row: Row, axes: Iterable[str]) -> str:
    """The labels of a flight in words, and whether its encounter is turned level."""
    said = [words.circumstance(axis, str(row["labels"][axis])) for axis in axes if axis in row["labels"]]
    return ", ".join(said + (["turned level"] if row.get("geometry") == "level" else []))


def outcomes(rows: Sequence[Row]) -> str:
    """``7 reached the goal, 5 collided``."""
    return words.outcomes(Counter(str(row["outcome"]) for row in rows))


@dataclass(frozen=True)
class Pair:
    """The same encounter and decision rule, as a point and as an aircraft."""

    kinematic: Row
    flown: Row

    @property
    def known(self) -> bool:
        """Did both meet an obstacle?"""
        return met_obstacle(self.kinematic) and met_obstacle(self.flown)

    @property
    def verdict(self) -> str:
        """What became of the clearance: was every radius kept, to the end of the flight?"""
        if not self.known:
            return "not determined"
        if not keeps(self.kinematic):
            return "fails kinematically, kept when flown" if keeps(self.flown) else "fails kinematically"
        return "kept when flown" if keeps(self.flown) else "fails when flown"


def pairs(rows: Sequence[Row]) -> list[Pair]:
    """Each flown flight with the kinematic one that shares encounter, method and replicate, and most of its labels."""
    found = []
    points = [row for row in rows if row["plant"] == KINEMATIC]
    for flown in rows:
        if flown["plant"] == KINEMATIC or flown.get("encounter") is None:
            continue
        key = (flown.get("encounter"), flown["method"], flown["replicate"])
        same = [p for p in points if (p.get("encounter"), p["method"], p["replicate"]) == key]
        if same:
            found.append(Pair(max(same, key=lambda p: sum(p["labels"].get(a) == label for a, label in flown["labels"].items())), flown))
    return found


def sentences(rows: Sequence[Row], matched: Sequence[Pair]) -> list[str]:
    """The answer in words, generated from the rows alone."""
    said = [f"Of {words.counted(len(rows), 'flight')}, {outcomes(rows)}."]
    met = [row for row in rows if met_obstacle(row)]
    for name in dict.fromkeys(flyer(row) for row in met):
        mine = [row for row in met if flyer(row) == name]
        by_method: dict[str, list[Row]] = {}
        for row in mine:
            by_method.setdefault(method(row), []).append(row)
        parts = [f"in {_collided(same)} {_with(same[0])}" for same in by_method.values()]
        said.append(f"{'The ' if mine[0]['plant'] == KINEMATIC else ''}{name} came closer than an obstacle's radius {words.listed(parts)}.")
    return said + _comparison([pair for pair in matched if pair.flown["replans"]])


def verdict(checks: Sequence[CheckResult]) -> list[str]:
    """What became of a check campaign, in a sentence."""
    missed = [line for line in checks if not line.passed]
    if not checks:
        return []
    if not missed:
        return [f"Check passed: {words.counted(len(checks), 'line')}, each within its tolerance."]
    return [f"Check missed: {len(missed)} of {words.counted(len(checks), 'line')} out of tolerance."]


def _with(row: Row) -> str:
    return "without avoidance" if row["method"] == "none" else f"with {method(row)}"


def _collided(rows: Sequence[Row]) -> str:
    hits = sum(collided(row) for row in rows)
    text = f"{hits} of {words.counted(len(rows), 'flight')}"
    if len(rows) >= 10:
        text += f" (95 % interval {words.interval(*share_interval(hits, len(rows)), 'share')})"
    return text


def _comparison(avoiding: Sequence[Pair]) -> list[str]:
    """Safe and flyable: what the aircraft made of the re-planned paths."""
    if not avoiding:
        return []
    points, flown = [pair.kinematic for pair in avoiding], [pair.flown for pair in avoiding]
    kept, still = (sum(map(keeps, side)) for side in (points, flown))
    return [
        f"Safe? Where an aircraft re-planned ({words.counted(len(avoiding), 'flight')}), the point kept its clearance in {kept} of the "
        f"same encounters, the aircraft in {still}. The least clearance of the point was {_span(points, 'least_clearance_m')}, "
        f"of the aircraft {_span(flown, 'least_clearance_m')}.",
        f"Flyable? In these flights the aircraft was at most {_span(flown, 'cross_track_max_m')} from its path "
        f"(rms {_span(flown, 'cross_track_rms_m')}); its largest bank was {_span(flown, 'max_bank_deg')}, "
        f"load factor {_span(flown, 'max_load_factor')}, roll rate {_span(flown, 'max_roll_rate_dps')}.",
    ]


def _span(rows: Sequence[Row], key: str) -> str:
    """The range of a metric over some rows, in words."""
    column, known = BY_NAME[key], [x for x in (value(row, key) for row in rows) if math.isfinite(x)]
    if not known:
        return "unknown"
    return words.span(min(known), max(known), column.unit, column.digits)


def cards(rows: Sequence[Row]) -> list[dict[str, str]]:
    """Headline numbers; the worst ones are of flown flights where there are any."""
    flown = [row for row in rows if row["plant"] != KINEMATIC] or list(rows)
    hits, met = sum(collided(row) for row in rows), sum(met_obstacle(row) for row in rows)
    made = [{"number": str(len(rows)), "name": "flights", "note": outcomes(rows), "tone": ""}]
    if met:
        note = "closer than the radius of an obstacle"
        made.append({"number": f"{hits} / {met}", "name": "collisions", "note": note, "tone": "bad" if hits else "good"})
    for key in ("least_clearance_m", "cross_track_max_m", "max_bank_deg", "max_load_factor"):
        column = BY_NAME[key]
        known = [row for row in flown if math.isfinite(value(row, key))]
        if known:
            worst = (min if column.worse == "low" else max)(known, key=lambda row: value(row, key))
            tone = "bad" if key == "least_clearance_m" and collided(worst) else ""
            name = column.heading if column.worse == "low" else f"largest {column.heading.removesuffix(' max')}"
            made.append(
                {
                    "number": f"{text(column, worst)} {column.unit}".strip(),
                    "name": name,
                    "note": f"{flyer(worst)}, {method(worst)}",
                    "tone": tone,
                }
            )
    return made


def cells(rows: Sequence[Row], axes: Sequence[str]) -> list[dict[str, Any]]:
    """One line per cell: how many, how they ended, median and worst."""
    grouped: dict[str, list[Row]] = {}
    for row in rows:
        grouped.setdefault(str(row["cell"]), []).append(row)
    lines = []
    for members in grouped.values():
        first = members[0]  # the one whose series is stored, which says how the encounter is turned
        summary = {}
        for column in SUMMARISED:
            known = [x for x in (value(row, column.name) for row in members) if math.isfinite(x)]
            worst = (min if column.worse == "low" else max)(known, default=math.nan)
            summary[column.name] = (number(median(known) if known else math.nan, column.digits), number(worst, column.digits), worst)
        lines.append(
            {
                "circumstances": circumstances(first, axes),
                "flyer": flyer(first),
                "method": method(first),
                "n": len(members),
                "rows": members,
                "collided": _collided(members).removesuffix(" flights").removesuffix(" flight"),
                "outcomes": outcomes(members),
                "summary": summary,
            }
        )
    return lines
