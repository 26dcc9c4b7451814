"""Which flights are pictured together, and how: the data behind the page's pictures. The drawing itself is templates/page.js."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from testbed.results.flight_row import collided, value
from testbed.show import palette, words
from testbed.show.campaign_summary import circumstances
from testbed.show.gathered import KINEMATIC, Row, flyer
from testbed.show.gathered import method as method_of

CLOSE_UP = "close_up"
"""What only the encounter that moves is drawn from, and these pictures are not."""
MOST_PER_GROUP = 30
MOST_IN_ALL = 150  # keeps the page under 3 MB
DASHES = ("solid", "dash", "dashdot", "longdash")
# On paper and in the dark. "ink" is the colour of the text.
CATEGORIES = (
    (palette.BLUE, palette.SKY),
    (palette.VERMILLION, palette.ORANGE),
    (palette.GREEN, "#2CC79E"),
    (palette.PURPLE, palette.PURPLE),
    ("#A67C00", palette.YELLOW),
)
CIVIDIS = ("#00224E", "#123570", "#3B496C", "#575D6D", "#707173", "#8A8678", "#A59C74", "#C3B369", "#E1CC55", "#FEE838")
SHADES = CIVIDIS[:7], CIVIDIS[3:]  # on paper and in the dark: what stands out from the ground


def figure_data(rows: Sequence[Row], series: Mapping[str, dict[str, Any] | None], axes: Sequence[str]) -> dict[str, Any]:
    """``groups`` of flights that meet the same encounter, and the curves of every flight in them."""
    by_encounter: dict[str, list[Row]] = {}
    curves = {flight_id: one for flight_id, one in series.items() if one and one["time_s"]}
    for row in rows:
        if row["flight_id"] in curves:
            by_encounter.setdefault(str(curves[row["flight_id"]]["encounter"]), []).append(row)
    each = max(1, min(MOST_PER_GROUP, MOST_IN_ALL // max(1, len(by_encounter))))
    named = titles(list(by_encounter.values()), axes)
    groups, flights = [], {}
    for title, members in list(zip(named, by_encounter.values(), strict=True))[:MOST_IN_ALL]:
        shown = selection(members, each)
        own_axes = [axis for axis in axes if len({str(row["labels"].get(axis)) for row in members}) > 1]
        groups.append({"title": title, "flights": [row["flight_id"] for row in shown], "left_out": len(members) - len(shown)})
        for row, style in zip(shown, styles(shown), strict=True):
            name = ", ".join(
                part
                for part in (
                    flyer(row),
                    method_of(row),
                    ", ".join(words.circumstance(axis, str(row["labels"][axis])) for axis in own_axes if axis in row["labels"]),
                )
                if part
            )
            if len({other["replicate"] for other in members}) > 1:
                name += f", no. {row['replicate']}"
            told = {"name": name, "collided": collided(row), "nearest_s": _or_none(value(row, "time_at_least_clearance_s"))}
            curve = {key: one for key, one in curves[row["flight_id"]].items() if key != CLOSE_UP}
            flights[row["flight_id"]] = told | style | curve
    # First the encounter in which most flights re-planned.
    busy = [sum(bool(row["replans"]) for row in members) for members in by_encounter.values()]
    return {"groups": groups, "flights": flights, "first": busy.index(max(busy)) if busy else 0}


def _or_none(number: float) -> float | None:
    return number if math.isfinite(number) else None


def titles(groups: list[list[Row]], axes: Sequence[str]) -> list[str]:
    """What tells the groups apart: the labels that are the same all through a group and differ between groups."""

    def labels(group: list[Row], axis: str) -> set[str]:
        return {str(row["labels"].get(axis)) for row in group}

    naming = [
        axis
        for axis in axes
        if all(len(labels(group, axis)) == 1 for group in groups) and len(set().union(*(labels(g, axis) for g in groups))) > 1
    ]
    named = [circumstances(group[0], naming) or f"encounter {count}" for count, group in enumerate(groups, start=1)]
    if len(groups) == 1:
        return ["the encounter"]
    return [title if named.count(title) == 1 else f"{title} ({count})" for count, title in enumerate(named, start=1)]


def selection(rows: Sequence[Row], most: int) -> list[Row]:
    """At most so many flights, in plan order: of every cell in turn the one with the least clearance, then the next."""
    if len(rows) <= most:
        return list(rows)
    cells: dict[str, list[Row]] = {}
    for row in rows:
        cells.setdefault(str(row["cell"]), []).append(row)
    for members in cells.values():
        members.sort(key=lambda row: (math.isnan(value(row, "least_clearance_m")), value(row, "least_clearance_m")))
    ranked = [members[k] for k in range(max(map(len, cells.values()))) for members in cells.values() if k < len(members)]
    shown = {row["flight_id"] for row in ranked[:most]}
    return [row for row in rows if row["flight_id"] in shown]


def styles(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Colour for who flies, dash for the method; where that does not tell the cells apart, one shade for each cell."""
    others = sorted({flyer(row) for row in rows if row["plant"] != KINEMATIC})
    methods = sorted({str(row["method"]) for row in rows}, key=lambda name: (name == "none", name))
    cells = list(dict.fromkeys(str(row["cell"]) for row in rows))
    crowded = len({(flyer(row), row["method"]) for row in rows}) < len(cells)
    made = []
    for row in rows:
        method = str(row["method"])
        dash = "dot" if method == "none" else DASHES[methods.index(method) % len(DASHES)]
        if crowded:
            share = cells.index(str(row["cell"])) / max(1, len(cells) - 1)
            light, dark = (shades[round(share * (len(shades) - 1))] for shades in SHADES)
        elif row["plant"] == KINEMATIC:
            light = dark = "ink"
        else:
            light, dark = CATEGORIES[others.index(flyer(row)) % len(CATEGORIES)]
        made.append({"light": light, "dark": dark, "dash": dash})
    return made
