"""What a campaign answers: counts, and the sentences on top of the page."""

import math
from collections.abc import Iterable, Sequence
from functools import partial
from statistics import median
from typing import Any

from testbed.results.columns import BY_NAME
from testbed.results.flight_row import collided, keeps, value
from testbed.results.statistics import share_interval
from testbed.show import words
from testbed.show.alike import ENOUGH_FOR_INTERVAL, Who
from testbed.show.gathered import HEADLINES, KINEMATIC, Gathered, Group, Row, flyer, method
from testbed.show.pairs import Pair
from testbed.show.shown_columns import SUMMARISED, text
from testbed.show.words import number


def with_method(row: Row) -> str:
    """``with SCOAM``, ``without avoidance``."""
    return "without avoidance" if row["method"] == "none" else f"with {method(row)}"


def circumstances(row: Row, axes: Iterable[str]) -> str:
    """The labels of a flight in words, and whether its encounter is turned level."""
    said = [words.circumstance(axis, str(row["labels"][axis])) for axis in axes if axis in row["labels"]]
    return ", ".join(said + (["turned level"] if row.get("geometry") == "level" else []))


def sentences(of: Gathered, matched: Sequence[Pair], over_axes: Sequence[str] = ()) -> list[str]:
    """The answer in words, generated from the rows alone. Where an axis of numbers is swept, ``over_axes`` says what it does: shares over
    all its places together would answer nobody's question.
    """
    said = [f"Of {words.counted(of.n, 'flight')}, {words.outcomes(of.outcomes)}."]
    if over_axes:
        return said + list(over_axes)
    for name, by_method in of.by_flyer.items():
        counted = of.compared.counted("method", partial(_is_of, name))
        parts = [f"in {_collided(same, counted[key].drawn)} {with_method(same.first)}" for key, same in by_method.items()]
        plant = next(iter(by_method.values())).first["plant"]
        said.append(f"{'The ' if plant == KINEMATIC else ''}{name} came closer than an obstacle's radius {words.listed(parts)}.")
    return said + _comparison([pair for pair in matched if pair.flown["replans"]])


def _is_of(name: str, who: Who) -> bool:
    return who.flyer == name


def _collided(group: Group, drawn: bool = True) -> str:
    """``drawn``: whether the flights are a sample, so that an interval says something."""
    text = f"{group.hits} of {words.counted(group.n, 'flight')}"
    if group.n >= ENOUGH_FOR_INTERVAL and drawn:
        text += f" (95 % interval {words.interval(*share_interval(group.hits, group.n), 'share')})"
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


def cards(of: Gathered) -> list[dict[str, str]]:
    """Headline numbers. The worst ones are of flights by an aircraft where there are any, and say so where points flew too: a point has no
    limits, and would be worst in all that an aircraft cannot do.
    """
    of_whom = "of flights by an aircraft: " if {flown for flown, _ in of.worst} == {True, False} else ""
    made = [{"number": str(of.n), "name": "flights", "note": words.outcomes(of.outcomes), "tone": ""}]
    if of.met:
        note = f"{'points and aircraft ' if of_whom else ''}closer than the radius of an obstacle"
        made.append({"number": f"{of.hits} / {of.met}", "name": "collisions", "note": note, "tone": "bad" if of.hits else "good"})
    for key in HEADLINES:
        column = BY_NAME[key]
        if worst := of.worst.get((of.flown, key)):
            tone = "bad" if key == "least_clearance_m" and collided(worst) else ""
            name = column.heading if column.worse == "low" else f"largest {column.heading.removesuffix(' max')}"
            made.append(
                {
                    "number": f"{text(column, worst)} {column.unit}".strip(),
                    "name": name,
                    "note": f"{of_whom}{flyer(worst)}, {method(worst)}",
                    "tone": tone,
                }
            )
    return made


def cells(of: Gathered, axes: Sequence[str]) -> list[dict[str, Any]]:
    """One line per cell that is listed: how many, how they ended, median and worst."""
    lines = []
    for cell in of.cells.values():
        first = cell.first  # the one whose series is stored, which says how the encounter is turned
        summary = {}
        for column in SUMMARISED:
            known = cell.values[column.name]
            worst = (min if column.worse == "low" else max)(known, default=math.nan)
            summary[column.name] = (number(median(known) if known else math.nan, column.digits), number(worst, column.digits), worst)
        lines.append(
            {
                "circumstances": circumstances(first, axes),
                "labels": first["labels"],
                "flyer": flyer(first),
                "method": method(first),
                "n": cell.n,
                "values": cell.values,
                "collided": _collided(cell).removesuffix(" flights").removesuffix(" flight"),
                "outcomes": words.outcomes(cell.outcomes),
                "summary": summary,
            }
        )
    return lines
