"""Ratios of risk: how often a volume was entered with avoidance, over how often without it, in the same encounters.

An encounter is a replicate in some circumstances (the labels of all axes but those that say who avoids). Its flight without avoidance
(method none) is the partner of each of its flights with some. Of both together an event is *unresolved*, of the second alone
*induced*, of the first alone *resolved*; weighted by encounter, ratio = (unresolved + induced) / (unresolved + resolved).
"""

import csv
import io
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from testbed.campaign.words.daa import SPHERE, Daa
from testbed.core.seeds import stream
from testbed.results.columns import AXIS, WEIGHT
from testbed.results.daa.bootstrap import Interval, ratio_interval
from testbed.results.daa.cells import DaaCells
from testbed.results.daa.columns import daa_columns, entered, limits_text
from testbed.results.flight_row import Row, collided, met_obstacle, value

UNMITIGATED: Final = "none"
WIDE: Final = 0.5
"""An interval that is wider than so much of its ratio says little: it is pointed out."""
MOST_POINTS: Final = 1500
"""Flights of a method in the picture of misses: the first of them."""
FLOWN: Final = ("labels", "plant", "aircraft", "method")
NAN = math.nan

Labels = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Ratio:
    """Of one method, in some circumstances, for one volume. ``resolved``, ``unresolved`` and ``induced`` count encounters; what follows
    from them is weighted.
    """

    circumstances: Labels
    method: Labels
    volume: str
    encounters: int
    resolved: int
    unresolved: int
    induced: int
    share_without: float
    share_with: float
    interval: Interval
    unresolved_ratio: float
    induced_ratio: float
    first: Row = field(repr=False)
    """Of the first flight with avoidance: what flew, and all its labels."""

    @property
    def width(self) -> float:
        return self.interval.high - self.interval.low

    @property
    def wide(self) -> bool:
        """Also where there is no interval."""
        return not self.width <= WIDE * self.interval.value


@dataclass
class _Group:
    """Flights of a method in some circumstances."""

    first: Row
    keys: list[int] = field(default_factory=list)
    events: list[bytes] = field(default_factory=list)


@dataclass
class Risk:
    """All ratios of a run, what was left out, and the misses of its first flights."""

    ratios: list[Ratio] = field(default_factory=list)
    unpaired: int = 0
    """Flights with avoidance whose encounter has no flight without."""
    unweighted: int = 0
    """Pairs without a weight, or with one below 0."""
    weight: str = ""
    """The column by which encounters weigh; nothing where all weigh the same."""
    misses: dict[Labels, list[tuple[float, float]]] = field(default_factory=dict)
    """Who avoids (nothing for nobody) to horizontal and vertical miss."""
    left_out: int = 0
    cells: DaaCells = field(default_factory=lambda: DaaCells(()))


def risk_of(rows: Iterable[Row], daa: Daa, seed: int) -> Risk:
    """Of rows in plan order, which are read twice. Without flights of both kinds there are no ratios."""
    who = who_axes(rows)
    names = (SPHERE, *daa.all_volumes)
    circumstances: dict[Labels, int] = {}
    unmitigated: dict[int, tuple[bytes, float]] = {}
    groups: dict[tuple[Labels, Labels], _Group] = {}
    risk = Risk(cells=DaaCells(daa_columns(daa)), weight=daa.weight)
    weight_of = daa.weight or WEIGHT.name
    for row in rows:
        risk.cells.add(row)
        labels = tuple((axis, str(label)) for axis, label in row["labels"].items())
        method = tuple((axis, label) for axis, label in labels if axis in who) or (("method", str(row["method"])),)
        rest = tuple((axis, label) for axis, label in labels if axis not in who)
        avoids = row["method"] != UNMITIGATED
        _see(risk, method if avoids else (), row)
        key = circumstances.setdefault(tuple(sorted(rest)), len(circumstances)) * 1_000_000 + int(row["replicate"])
        if avoids:
            group = groups.setdefault((rest, method), _Group({name: row[name] for name in FLOWN}))
            group.keys.append(key)
            group.events.append(_events(row, names))
        elif key not in unmitigated:
            weight = _weight(row, weight_of)
            unmitigated[key] = (_events(row, names), weight)
            if weight != 1.0:
                risk.weight = weight_of
    if unmitigated:
        for (rest, method), group in groups.items():
            _add_ratios(risk, (rest, method), group, unmitigated, names, seed)
    return risk


def who_axes(rows: Iterable[Row]) -> set[str]:
    """Axes that say who avoids: no label of a flight without avoidance is one of a flight with."""
    without: dict[str, set[str]] = {}
    with_: dict[str, set[str]] = {}
    for row in rows:
        of = without if row["method"] == UNMITIGATED else with_
        for axis, label in row["labels"].items():
            of.setdefault(axis, set()).add(str(label))
    return {axis for axis in with_ if not with_[axis] & without.get(axis, set())} if without else set()


def _see(risk: Risk, who: Labels, row: Row) -> None:
    miss = value(row, "horizontal_miss_m"), value(row, "vertical_miss_m")
    if not all(map(math.isfinite, miss)):
        return
    points = risk.misses.setdefault(who, [])
    if len(points) < MOST_POINTS:
        points.append(miss)
    else:
        risk.left_out += 1


_UNKNOWN: Final = 2


def _events(row: Row, names: Sequence[str]) -> bytes:
    """Of each volume 1 for entered, 0 for not; 2 where that is not known."""
    sphere = int(collided(row)) if met_obstacle(row) else _UNKNOWN
    found = (row.get(entered(name)) for name in names[1:])
    return bytes([sphere, *(_UNKNOWN if flag is None else int(bool(flag)) for flag in found)])


def _weight(row: Row, name: str) -> float:
    """NaN for what is no weight. Rows of encounters that are drawn as often as they occur do not say that they count 1."""
    unsaid = 1.0 if name == WEIGHT.name else None
    said: Any = row["labels"].get(name.removeprefix(AXIS)) if name.startswith(AXIS) else row.get(name, unsaid)
    try:
        weight = float(said)
    except (TypeError, ValueError):
        return NAN
    return weight if math.isfinite(weight) and weight >= 0.0 else NAN


def _add_ratios(
    risk: Risk, who: tuple[Labels, Labels], group: _Group, unmitigated: Mapping[int, tuple[bytes, float]], names: Sequence[str], seed: int
) -> None:
    partners = [(events, *unmitigated[key]) for key, events in zip(group.keys, group.events, strict=True) if key in unmitigated]
    risk.unpaired += len(group.keys) - len(partners)
    weighed = [one for one in partners if not math.isnan(one[2])]
    risk.unweighted += len(partners) - len(weighed)
    shape = (len(weighed), len(names))
    with_, without = (
        np.frombuffer(b"".join(events), dtype=np.uint8).reshape(shape)
        for events in ((one for one, _, _ in weighed), (one for _, one, _ in weighed))
    )
    weights = np.array([weight for _, _, weight in weighed], dtype=float)
    for k, name in enumerate(names):
        known = (with_[:, k] != _UNKNOWN) & (without[:, k] != _UNKNOWN)
        rng = stream(seed, 0, f"risk.{name}")
        risk.ratios.append(_ratio(who, group.first, name, weights[known], without[known, k], with_[known, k], rng))


def _ratio(
    who: tuple[Labels, Labels], first: Row, name: str, weights: np.ndarray, without: np.ndarray, with_: np.ndarray,
    rng: np.random.Generator,
) -> Ratio:  # fmt: skip
    e0, e1 = without.astype(float), with_.astype(float)
    kinds = Counter(zip(without.tolist(), with_.tolist(), strict=True))
    below, both, induced, every = (float(weights @ event) for event in (e0, e0 * e1, (1.0 - e0) * e1, np.ones(len(weights))))
    return Ratio(
        circumstances=who[0],
        method=who[1],
        volume=name,
        encounters=len(weights),
        resolved=kinds[1, 0],
        unresolved=kinds[1, 1],
        induced=kinds[0, 1],
        share_without=below / every if every else NAN,
        share_with=(both + induced) / every if every else NAN,
        interval=ratio_interval(weights, e0, e1, rng),
        unresolved_ratio=both / below if below else NAN,
        induced_ratio=induced / below if below else NAN,
        first=first,
    )


RISK_COLUMNS: Final = (
    "circumstances", "method", "volume", "limits", "encounters", "resolved", "unresolved", "induced", "share_without", "share_with",
    "ratio", "low", "high", "unresolved_ratio", "induced_ratio", "interval",
)  # fmt: skip


def label_text(labels: Labels) -> str:
    """``axis=label, axis=label``."""
    return ", ".join(f"{axis}={label}" for axis, label in labels)


def csv_bytes(risk: Risk, daa: Daa) -> bytes:
    """``risk.csv``: every ratio, with the limits by which its volume was judged."""
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(RISK_COLUMNS)
    volumes = daa.all_volumes
    for one in risk.ratios:
        limits = limits_text(volumes[one.volume]) if one.volume in volumes else "the radius of each"
        told = (one.share_without, one.share_with, *one.interval, one.unresolved_ratio, one.induced_ratio)
        who = (label_text(one.circumstances), label_text(one.method), one.volume, limits)
        counts = (one.encounters, one.resolved, one.unresolved, one.induced)
        said = "wide" if one.wide else "narrow"
        writer.writerow([*who, *counts, *("" if math.isnan(number) else repr(number) for number in told), said])
    return out.getvalue().encode()
