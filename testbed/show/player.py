"""The encounter that moves in the page: which flights are in one scene, and what templates/player.js is given of them.

A scene is one encounter under one method: the worst flown flight of it, the same flight on every other rung of physics (the point on
rails, the point mass), and the one without avoidance, as ghosts that begin at their decisions together.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any, Final

from testbed.core.catalogue import aircraft_folders
from testbed.flight.plants.aircraft import load_aircraft
from testbed.results.flight_row import collided, value
from testbed.show import key_frames, palette, words
from testbed.show.assets import packed_json
from testbed.show.figures import styles, titles
from testbed.show.gathered import KINEMATIC, Row, flyer, method

NO_METHOD: Final = "none"
MOST_GHOSTS = 8  # in a scene: more cannot be told apart
MOST_SCENES = 12
MOST_FLIGHTS = 60  # in all scenes: about 4 kB of the page each
POINT_MASS: Final = "point_mass"
_RUNGS: Final = {KINEMATIC: 0, POINT_MASS: 1}  # the rest of the plants fly

Series = Mapping[str, dict[str, Any] | None]


@dataclass(frozen=True)
class Ghost:
    """A flight of a scene: its row, its name there, its colours by day and by night (``ink``: that of the text), its dash,
    and whether it is shown from the start.
    """

    row: Row
    name: str
    light: str
    dark: str
    dash: str = "solid"
    shown: bool = True


@dataclass(frozen=True)
class Scene:
    """Flights that move together. ``focus``: the one that the scene is about, whose aircraft the limits are of."""

    title: str
    ghosts: tuple[Ghost, ...]
    focus: int = 0


def scenes(rows: Sequence[Row], series: Series, axes: Sequence[str]) -> list[Scene]:
    """Of an ordinary page, the most telling first: every rung there, the aircraft re-planned, the worst flown clearance."""
    encounters: dict[str, list[Row]] = {}
    for row in rows:
        if close_up_of(series, row) is not None:
            encounters.setdefault(str((series[row["flight_id"]] or {})["encounter"]), []).append(row)
    named = titles(list(encounters.values()), axes)
    made = []
    for title, members in zip(named, encounters.values(), strict=True):
        without = [row for row in members if row["method"] == NO_METHOD]
        methods = list(dict.fromkeys(method(row) for row in members if row["method"] != NO_METHOD))
        for name in methods:
            mine = [row for row in members if method(row) == name]
            made.append((_telling(mine), _scene(f"{title}, {name}" if len(encounters) > 1 else name, mine, without, axes)))
        if not methods:
            made.append((_telling(without), _scene(title, without, [], axes)))
    made.sort(key=lambda pair: pair[0])  # stable: equals stay in plan order
    return [scene for _, scene in made]


def close_up_of(series: Series, row: Row) -> dict[str, Any] | None:
    """The dense samples of a flight, if the run stored them."""
    told: dict[str, Any] | None = (series.get(row["flight_id"]) or {}).get("close_up")
    return told


def _rung(row: Row) -> int:
    return _RUNGS.get(str(row["plant"]), 2)


def _clearance(row: Row) -> float:
    found = value(row, "least_clearance_m")
    return found if math.isfinite(found) else math.inf


def _telling(rows: Sequence[Row]) -> tuple[int, bool, float]:
    """To sort scenes by, the most telling first."""
    flown = [row for row in rows if _rung(row) == 2] or list(rows)
    return -len({_rung(row) for row in rows}), not any(row["replans"] for row in flown), min(map(_clearance, flown))


def _alike(one: Row, other: Row) -> tuple[int, bool]:
    """How many circumstances two flights share."""
    return sum(other["labels"].get(axis) == label for axis, label in one["labels"].items()), one["replicate"] == other["replicate"]


def _scene(title: str, rows: Sequence[Row], without: Sequence[Row], axes: Sequence[str]) -> Scene:
    """The worst flight of the highest rung, with its likes; then other circumstances of the highest rung, as many as fit."""
    top = max(map(_rung, rows))
    by_flyer: dict[str, list[Row]] = {}
    for row in rows:
        by_flyer.setdefault(flyer(row), []).append(row)
    first = min((row for row in rows if _rung(row) == top), key=_clearance)
    likes = [max(same, key=lambda row: (*_alike(first, row), -_clearance(row))) for name, same in by_flyer.items() if name != flyer(first)]
    chosen = [first, *likes]
    if without:
        chosen.append(max(without, key=lambda row: (flyer(row) == flyer(first), *_alike(first, row))))
    others: dict[str, list[Row]] = {}
    for row in sorted((row for row in rows if _rung(row) == top and row is not first), key=_clearance):
        others.setdefault(str(row["cell"]), []).append(row)
    in_turn = [row for turn in zip_longest(*others.values()) for row in turn if row is not None]
    chosen = [*chosen, *(row for row in in_turn if row not in chosen)][:MOST_GHOSTS]
    chosen.sort(key=lambda row: (row["method"] == NO_METHOD and row is not first, _rung(row)))
    return Scene(title, _ghosts(chosen, axes), chosen.index(first))


def _ghosts(rows: Sequence[Row], axes: Sequence[str]) -> tuple[Ghost, ...]:
    """With a name that says by what a flight differs from the others of the scene."""
    differ = [axis for axis in axes if len({str(row["labels"].get(axis)) for row in rows}) > 1]
    replicates = len({row["replicate"] for row in rows}) > 1
    methods = len({method(row) for row in rows}) > 1
    made = []
    for row, style in zip(rows, styles(rows), strict=True):
        said = [words.circumstance(axis, str(row["labels"][axis])) for axis in differ if axis in row["labels"]]
        without = words.method(NO_METHOD) if methods and row["method"] == NO_METHOD else ""
        name = ", ".join(filter(None, (flyer(row), *said, without, f"no. {row['replicate']}" if replicates else "")))
        grey = {"light": palette.GREY, "dark": palette.GREY} if without else {}
        made.append(Ghost(row, name, **style | grey))
    return tuple(made)


def limits_of(aircraft: str) -> dict[str, float]:
    """What an aircraft has, under the names of the curves; nothing for one that is not installed here."""
    if aircraft not in aircraft_folders():
        return {}
    limits = load_aircraft(aircraft).limits
    return {"bank_deg": limits.bank_deg, "load_factor": limits.load_factor_max, "roll_rate_dps": limits.roll_rate_dps}


def player(found: Sequence[Scene], series: Series) -> dict[str, Any] | None:
    """What the template needs: the packed data, the titles, and the key frames of the first scene; None if nothing can be moved."""
    shown: list[tuple[Scene, tuple[Ghost, ...]]] = []
    ids: dict[str, None] = {}
    for scene in found[:MOST_SCENES]:
        ghosts = tuple(ghost for ghost in scene.ghosts if close_up_of(series, ghost.row) is not None)
        mine = dict.fromkeys(ghost.row["flight_id"] for ghost in ghosts)
        if ghosts and len(ids | mine) <= MOST_FLIGHTS:
            shown.append((scene, ghosts))
            ids |= mine
    if not shown:
        return None
    told = [_told(scene, ghosts) for scene, ghosts in shown]
    flights = {
        flight_id: {"close_up": (series[flight_id] or {})["close_up"], "paths": (series[flight_id] or {})["paths"]} for flight_id in ids
    }
    first = told[0]
    pairs = [(ghost, flights[ghost["id"]]) for ghost in first["ghosts"]]
    return {
        "data": packed_json({"scenes": told, "flights": flights}),
        "titles": [scene["title"] for scene in told],
        "left_out": len(found) - len(shown),
        "ghosts": first["ghosts"],
        "frames": key_frames.frames(pairs, first["focus"]),
    }


def _told(scene: Scene, ghosts: tuple[Ghost, ...]) -> dict[str, Any]:
    focus = scene.ghosts[scene.focus]
    return {
        "title": scene.title,
        "focus": ghosts.index(focus) if focus in ghosts else 0,
        "ghosts": [
            {
                "id": ghost.row["flight_id"],
                "name": ghost.name,
                "light": ghost.light,
                "dark": ghost.dark,
                "dash": ghost.dash,
                "strokes": key_frames.STROKES.get(ghost.dash, ""),
                "shown": ghost.shown,
                "limits": limits_of(str(ghost.row["aircraft"])),
                "least": words.number(value(ghost.row, "least_clearance_m"), 2),
                "bad": collided(ghost.row),
                "outcome": words.outcome(str(ghost.row["outcome"])),
            }
            for ghost in ghosts
        ],
    }
