"""Which column of a track file is what, and in which unit: as a campaign says, or as the headings of well-known exports do."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from testbed.core.units import FT

NAUTICAL_MILE_M = 1852.0
METRES = {"m": 1.0, "km": 1000.0, "ft": FT, "nmi": NAUTICAL_MILE_M}
LENGTHS = [f"{axis}_{unit}" for axis in ("east", "north", "up") for unit in METRES]
LEVEL, GEODETIC = ("east", "north", "up"), ("latitude", "longitude", "altitude")
WORDS = ("time_s", "time_ms", "time_iso", *LENGTHS, "latitude_deg", "longitude_deg", "altitude_m", "altitude_ft", "track")
"""What a campaign may name columns of; ``track`` is the column that tells the tracks of a file apart."""

EXPORTS: dict[str, tuple[dict[str, str], tuple[str, ...]]] = {
    "the `traffic` library": (
        {"time_iso": "timestamp", "latitude_deg": "latitude", "longitude_deg": "longitude", "altitude_ft": "altitude"},
        ("flight_id", "icao24", "callsign"),
    ),
    "OpenSky state vectors": (
        {"time_s": "time", "latitude_deg": "lat", "longitude_deg": "lon", "altitude_m": "geoaltitude"},
        ("icao24", "callsign"),
    ),
    "OpenSky state vectors without geometric altitude": (
        {"time_s": "time", "latitude_deg": "lat", "longitude_deg": "lon", "altitude_m": "baroaltitude"},
        ("icao24", "callsign"),
    ),
}
"""Of each its columns, and the first of these that is there tells the tracks apart."""


class Column(NamedTuple):
    """A column of a file by its heading; ``scale`` brings it into s, m or deg, 0 for a time that is a date."""

    heading: str
    scale: float


class Layout(NamedTuple):
    """The columns of time, of the three coordinates, and of the tracks' names."""

    time: Column
    place: tuple[Column, Column, Column]
    geodetic: bool
    track: str | None


def layout(headings: Sequence[str], said: Mapping[str, str]) -> Layout:
    """The layout of a file with these headings. Raises ``ValueError``."""
    if said:
        if missing := [f"'{heading}'" for heading in said.values() if heading not in headings]:
            raise ValueError(f"has no column {', '.join(missing)}; it has: {listed(headings)}")
        return _laid(said)
    own = {word: word for word in WORDS if word in headings}
    for needed, tracks in [(own, ()), *EXPORTS.values()]:
        if own is needed and not _is_whole(own):
            continue
        if all(heading in headings for heading in needed.values()):
            track = next((name for name in tracks if name in headings), None)
            return _laid(needed | ({"track": track} if track else {}))
    if why := _unclear([word for word in own if word != "track"]):
        raise ValueError(why)
    raise ValueError(f"has the columns {listed(headings)}, of which none are known to be time and place; name them under 'columns'")


def _unclear(own: Sequence[str]) -> str:
    """Why columns that are known by their headings are no layout; empty where none of them is a place."""
    found = {name: [word for word in own if word.startswith(f"{name}_")] for name in ("time", *LEVEL, *GEODETIC)}
    for name, words in found.items():
        if len(words) > 1:
            return f"has the columns {' and '.join(words)}, each of which is the {name}; name the columns that are meant under 'columns'"
    level, geodetic = (sum(map(len, (found[name] for name in axes))) for axes in (LEVEL, GEODETIC))
    if level == geodetic == 3 and found["time"]:
        return "has places in metres and in latitudes; name the columns of one of them under 'columns'"
    axes = ("time", *(LEVEL if level >= geodetic else GEODETIC))
    missing = [f"{name} ({next(word for word in WORDS if word.startswith(name))})" for name in axes if not found[name]]
    return f"has no column of {' and '.join(missing)}; if it is called otherwise name all under 'columns'" if level or geodetic else ""


def plain(text: str) -> str:
    """A text of a file as it can be shown."""
    return "".join(sign if sign.isprintable() else "?" for sign in text)


def fault(said: Mapping[str, str]) -> str:
    """What is wrong with the columns that a campaign names; empty if nothing."""
    if unknown := [word for word in said if word not in WORDS]:
        return f"'{unknown[0]}' is nothing that a track has; known are: {', '.join(WORDS)}"
    return "" if _is_whole(said) else "name one of time, and either those of east, north and up or of latitude, longitude and altitude"


def _is_whole(said: Mapping[str, str]) -> bool:
    counts = [
        sum(word.startswith(f"{name}_") for word in said) for name in ("time", "east", "north", "up", "latitude", "longitude", "altitude")
    ]
    return counts in ([1, 1, 1, 1, 0, 0, 0], [1, 0, 0, 0, 1, 1, 1])


def _laid(said: Mapping[str, str]) -> Layout:
    geodetic = any(word.startswith("latitude") for word in said)
    axes = ("latitude", "longitude", "altitude") if geodetic else ("east", "north", "up")
    time, *place = (_column(said, name) for name in ("time", *axes))
    return Layout(time, (place[0], place[1], place[2]), geodetic, said.get("track"))


def _column(said: Mapping[str, str], name: str) -> Column:
    word = next(word for word in said if word.startswith(f"{name}_"))
    unit = word.rpartition("_")[2]
    return Column(said[word], METRES.get(unit, {"s": 1.0, "ms": 1e-3, "iso": 0.0, "deg": 1.0}.get(unit, 1.0)))


def listed(names: Sequence[str], most: int = 20) -> str:
    """The first of them."""
    return plain(", ".join(names[:most])) + (", ..." if len(names) > most else "") if names else "none"
