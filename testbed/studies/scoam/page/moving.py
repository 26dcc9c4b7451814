"""The paper's own encounter as it moves on top of the verdict's page: one scene an aircraft, every rung of it as a ghost."""

from collections.abc import Mapping, Sequence
from typing import Any

from testbed.show import palette
from testbed.show.gathered import Row
from testbed.show.player import Ghost, Scene, close_up_of
from testbed.show.words import named
from testbed.studies.scoam.labels import Axis, Method, Part, Rung
from testbed.studies.scoam.page.paper_names import AIRCRAFT_NAMES, ENCOUNTER, METHOD, METHOD_NAMES, READING_NAMES
from testbed.studies.scoam.page.picture_data import PICTURED, picture_of

FOCUS = Rung.JSBSIM
AT_FIRST_HIDDEN = (Rung.VO_INSTANT, Rung.DIRECT)  # what has no insertion point is another question; a click shows it
WITHOUT = "flown, calm, no avoidance"


def scenes(rows: Sequence[Row], series: Mapping[str, dict[str, Any] | None]) -> tuple[Scene, ...]:
    """Aircraft in the order of the verdict, the paper's geometry first; ghosts in the order of its pictures."""
    by_aircraft: dict[str, dict[int, Ghost]] = {}
    for row in rows:
        if close_up_of(series, row) is None:
            continue
        ghosts, one = by_aircraft.setdefault(str(row["aircraft"]), {}), picture_of(row["labels"], row["replicate"])
        if one is not None:
            ghosts[PICTURED.index(one)] = Ghost(row, one.name, one.light, one.dark, one.dash, one.key not in AT_FIRST_HIDDEN)
        elif _is_without(row):
            ghosts[len(PICTURED)] = Ghost(row, WITHOUT, palette.GREY, palette.GREY, "longdash")
    made = []
    for aircraft in sorted(by_aircraft, key=lambda name: (name not in AIRCRAFT_NAMES, [*AIRCRAFT_NAMES, name].index(name))):
        ghosts = by_aircraft[aircraft]
        flown = next((k for k, one in enumerate(PICTURED) if one.key == FOCUS), 0)
        if flown in ghosts:
            order = sorted(ghosts)
            title = f"{READING_NAMES[ENCOUNTER]}, {METHOD_NAMES[METHOD]}, {named(AIRCRAFT_NAMES, aircraft)}"
            made.append(Scene(title, tuple(ghosts[k] for k in order), order.index(flown)))
    return tuple(made)


def _is_without(row: Row) -> bool:
    """The flown flight of the encounter in calm air in which nobody avoids."""
    wanted = {Axis.PART: Part.CALM, Axis.ENCOUNTER: ENCOUNTER, Axis.METHOD: Method.NONE, Axis.RUNG: FOCUS}
    return not row["replicate"] and all(row["labels"].get(axis) == label for axis, label in wanted.items())
