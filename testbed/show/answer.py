"""What a campaign answers: counts, pairs of kinematic and flown flights, and the sentences on top of the page."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from testbed.results.checks import CheckResult
from testbed.show.columns import BY_KEY, SUMMARISED, collided, value
from testbed.show.story import number

Row = dict[str, Any]

OUTCOME_ORDER = ("reached", "collided", "timed_out", "no_path", "hit_ground", "diverged", "trim_failed", "crashed")
OUTCOME_SHORT = {
    "reached": "reached the goal",
    "trim_failed": "could not be trimmed",
    "no_path": "found no path",
    "crashed": "failed to run",
}


def flyer(row: Row) -> str:
    """Who flew: the point, or the aircraft and the physics it flew in."""
    return str(row["plant"]) if row["plant"] == "kinematic" else f"{row['aircraft']} ({row['plant']})"


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
                labels.setdefault((flyer(row), str(row["method"]), str(row.get("geometry"))), set()).add(str(row["labels"][axis]))
        return all(len(seen) == 1 for seen in labels.values())

    return [axis for axis in axes if not said_already(axis)]


def circumstances(row: Row, axes: Iterable[str]) -> str:
    """The labels of a flight in words, and whether its encounter is turned level."""
    said = [str(row["labels"][axis]) for axis in axes if axis in row["labels"]]
    return ", ".join(said + (["turned level"] if row.get("geometry") == "level" else []))


def counted(number_of: int, noun: str) -> str:
    """``1 flight``, ``2 flights``."""
    return f"{number_of} {noun}" + ("" if number_of == 1 else "s")


def outcomes(rows: Sequence[Row]) -> str:
    """``7 reached the goal, 5 collided``."""
    count = Counter(str(row["outcome"]) for row in rows)
    known = [name for name in OUTCOME_ORDER if name in count] + sorted(set(count) - set(OUTCOME_ORDER))
    return ", ".join(f"{count[name]} {OUTCOME_SHORT.get(name, name.replace('_', ' '))}" for name in known)


def wilson(hits: int, n: int) -> tuple[float, float]:
    """95 % interval of a share (Wilson 1927): sensible also for 0 and n hits."""
    z = 1.959964
    centre, spread = hits / n + z * z / (2 * n), z * math.sqrt(hits * (n - hits) / n + z * z / 4) / n
    scale = 1 + z * z / n
    return max(0.0, (centre - spread) / scale), min(1.0, (centre + spread) / scale)


@dataclass(frozen=True)
class Pair:
    """The same encounter and decision rule, as a point and as an aircraft."""

    kinematic: Row
    flown: Row

    @property
    def verdict(self) -> str:
        """What became of the clearance."""
        point, craft = (value(row, "least_clearance_m") for row in (self.kinematic, self.flown))
        if not (math.isfinite(point) and math.isfinite(craft)):
            return "not determined"
        if point < 0.0:
            return "fails kinematically" if craft < 0.0 else "fails kinematically, kept when flown"
        return "kept when flown" if craft >= 0.0 else "fails when flown"


def pairs(rows: Sequence[Row]) -> list[Pair]:
    """Each flown flight with the kinematic one that shares encounter, method and replicate, and most of its labels."""
    found = []
    points = [row for row in rows if row["plant"] == "kinematic"]
    for flown in rows:
        if flown["plant"] == "kinematic" or flown.get("encounter") is None:
            continue
        key = (flown.get("encounter"), flown["method"], flown["replicate"])
        same = [p for p in points if (p.get("encounter"), p["method"], p["replicate"]) == key]
        if same:
            found.append(Pair(max(same, key=lambda p: sum(p["labels"].get(a) == label for a, label in flown["labels"].items())), flown))
    return found


def sentences(rows: Sequence[Row], matched: Sequence[Pair]) -> list[str]:
    """The answer in words, generated from the rows alone."""
    said = [f"Of {counted(len(rows), 'flight')}, {outcomes(rows)}."]
    met = [row for row in rows if met_obstacle(row)]
    for name in dict.fromkeys(flyer(row) for row in met):
        mine = [row for row in met if flyer(row) == name]
        methods = list(dict.fromkeys(str(row["method"]) for row in mine))
        parts = [f"in {_collided([r for r in mine if r['method'] == method])} {_with(method)}" for method in methods]
        said.append(f"{_title(name)} came closer than an obstacle's radius {' and '.join(parts)}.")
    return said + _comparison([pair for pair in matched if pair.flown["replans"]])


def verdict(checks: Sequence[CheckResult]) -> list[str]:
    """What became of a check campaign, in a sentence."""
    missed = [line for line in checks if not line.passed]
    if not checks:
        return []
    if not missed:
        return [f"Check passed: {counted(len(checks), 'line')}, each within its tolerance."]
    return [f"Check missed: {len(missed)} of {counted(len(checks), 'line')} out of tolerance."]


def met_obstacle(row: Row) -> bool:
    """Was there an obstacle to come close to?"""
    return bool(math.isfinite(value(row, "least_clearance_m")))


def _with(method: str) -> str:
    return "without avoidance" if method == "none" else f"with {method}"


def _title(name: str) -> str:
    return "The kinematic point" if name == "kinematic" else f"The aircraft {name}"


def _collided(rows: Sequence[Row]) -> str:
    hits = sum(collided(row) for row in rows)
    text = f"{hits} of {counted(len(rows), 'flight')}"
    if len(rows) >= 10:
        low, high = wilson(hits, len(rows))
        text += f" (95 % interval {100 * low:.0f} to {100 * high:.0f} %)"
    return text


def _comparison(avoiding: Sequence[Pair]) -> list[str]:
    """Safe and flyable: what the aircraft made of the re-planned paths."""
    if not avoiding:
        return []
    points, flown = [pair.kinematic for pair in avoiding], [pair.flown for pair in avoiding]
    kept, still = (sum(not collided(row) for row in side) for side in (points, flown))
    return [
        f"Safe? Where an aircraft re-planned ({counted(len(avoiding), 'flight')}), the point kept its clearance in {kept} of the same "
        f"encounters, the aircraft in {still}. The least clearance of the point was {_span(points, 'least_clearance_m')}, "
        f"of the aircraft {_span(flown, 'least_clearance_m')}.",
        f"Flyable? In these flights the aircraft was at most {_span(flown, 'cross_track_max_m')} from its path "
        f"(rms {_span(flown, 'cross_track_rms_m')}); its largest bank was {_span(flown, 'max_bank_deg')}, "
        f"load factor {_span(flown, 'max_load_factor')}, roll rate {_span(flown, 'max_roll_rate_dps')}.",
    ]


def _span(rows: Sequence[Row], key: str) -> str:
    """The range of a metric over some rows, in words."""
    column, known = BY_KEY[key], [x for x in (value(row, key) for row in rows) if math.isfinite(x)]
    if not known:
        return "unknown"
    low, high = (number(x, column.digits) for x in (min(known), max(known)))
    return f"{low} {column.unit}".rstrip() if low == high else f"{low} to {high} {column.unit}".rstrip()


def cards(rows: Sequence[Row]) -> list[dict[str, str]]:
    """Headline numbers; the worst ones are of flown flights where there are any."""
    flown = [row for row in rows if row["plant"] != "kinematic"] or list(rows)
    hits, met = sum(collided(row) for row in rows), sum(met_obstacle(row) for row in rows)
    made = [{"number": str(len(rows)), "name": "flights", "note": outcomes(rows), "tone": ""}]
    if met:
        note = "closer than the radius of an obstacle"
        made.append({"number": f"{hits} / {met}", "name": "collisions", "note": note, "tone": "bad" if hits else "good"})
    for key in ("least_clearance_m", "cross_track_max_m", "max_bank_deg", "max_load_factor"):
        column = BY_KEY[key]
        known = [row for row in flown if math.isfinite(value(row, key))]
        if known:
            worst = (min if column.worse == "low" else max)(known, key=lambda row: value(row, key))
            tone = "bad" if key == "least_clearance_m" and collided(worst) else ""
            name = column.heading if column.worse == "low" else f"largest {column.heading.removesuffix(' max')}"
            made.append(
                {
                    "number": f"{column.text(worst)} {column.unit}".strip(),
                    "name": name,
                    "note": f"{flyer(worst)}, {worst['method']}",
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
        first = members[0]  # the one whose series is kept, which says how the encounter is turned
        summary = {}
        for key in SUMMARISED:
            known = [x for x in (value(row, key) for row in members) if math.isfinite(x)]
            worst = (min if BY_KEY[key].worse == "low" else max)(known, default=math.nan)
            summary[key] = (number(median(known) if known else math.nan, BY_KEY[key].digits), number(worst, BY_KEY[key].digits), worst)
        lines.append(
            {
                "place": circumstances(first, axes),
                "flyer": flyer(first),
                "method": str(first["method"]),
                "n": len(members),
                "rows": members,
                "collided": _collided(members).removesuffix(" flights").removesuffix(" flight"),
                "outcomes": outcomes(members),
                "summary": summary,
            }
        )
    return lines
