"""The shares and ratios of ``risk.csv``, computed again: who was in which volume by the raw columns, paired as docs/daa.md says.

Judged are the obstacle's sphere and every volume without a time (cylinders, spheres). A volume that reaches ahead (``tau_s``) and the
intervals, which are drawn at random, are taken as they are. A flight that kept no raw columns enters with what ``results.csv`` says.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from .approach import TOUCH_M
from .compare import Difference, apart, said_of, shown
from .daa_volumes import volumes_of
from .run import BadInputError, Run, figure_of, read_csv

SPHERE, NOBODY = "sphere", "none"
AGREE = 1e-9  # of shares and ratios, which are sums of a few weights
Flags = dict[str, bool | None]
Labels = frozenset[tuple[str, str]]


def flags_of(run: Run, own: Mapping[str, Mapping[str, Any]], volumes: Iterable[str]) -> dict[str, Flags]:
    """Of every flight with a row whether it was in each volume: computed where it was computed (``own``), else as the table says."""
    found = {}
    for name, row in run.rows.items():
        mine = own.get(name, {})
        clearance = figure_of(row["least_clearance_m"]) if "least_clearance_m" not in mine else float(mine["least_clearance_m"])
        flags: Flags = {SPHERE: None if math.isnan(clearance) else clearance < -TOUCH_M}
        for volume in volumes:
            said = str(mine.get(f"entered_{volume}", row[f"entered_{volume}"]))
            flags[volume] = None if said == "" else said == "true"
        found[name] = flags
    return found


def compare_risk(run: Run, own: Mapping[str, Mapping[str, Any]]) -> tuple[int, int, list[Difference]]:
    """Lines of ``risk.csv`` that agree, those not judged here, and what does not agree: entries flight by flight, shares and ratios."""
    path = run.path / "risk.csv"
    lines = read_csv(path)
    try:
        volumes = volumes_of(run.campaign)
        differences = list(_entries(run, own, volumes))
        found = ratios_of(run, flags_of(run, own, volumes))
        agreed, skipped = 0, 0
        for line in lines:
            where = " ".join(filter(None, (line["circumstances"], line["method"], line["volume"])))
            figures = found.pop((_key(line["circumstances"]), _key(line["method"]), line["volume"]), None)
            if figures is None:
                skipped += line["volume"] not in (SPHERE, *volumes)
                if line["volume"] in (SPHERE, *volumes):
                    differences.append(Difference(where, "line", "there", "nothing", math.inf))
                continue
            said = {name: said_of(path, where, name, line[name]) for name in figures}
            unlike = [
                Difference(where, name, shown(said[name]), shown(value), apart(said[name], value))
                for name, value in figures.items()
                if apart(said[name], value) > AGREE * max(1.0, abs(value))
            ]
            agreed += not unlike
            differences += unlike
    except (KeyError, ValueError, TypeError, AttributeError) as problem:
        raise BadInputError(f"{path}: cannot be judged ({type(problem).__name__}: {problem})") from None
    differences += [Difference(f"{key[2]}", "line", "nothing", "there", math.inf) for key in found]
    return agreed, skipped, differences


def _entries(run: Run, own: Mapping[str, Mapping[str, Any]], volumes: Iterable[str]) -> Iterator[Difference]:
    for name, mine in own.items():
        for volume in volumes:
            column = f"entered_{volume}"
            said, found = run.rows[name][column], str(mine[column])
            if said != found:
                yield Difference(name, column, said or "nothing", found or "nothing", math.inf)


def ratios_of(run: Run, flags: Mapping[str, Flags]) -> dict[tuple[Labels, Labels, str], dict[str, float]]:
    """Every line of ``risk.csv`` by circumstances, method and volume: counts, shares and the ratio with its two parts."""
    idle = {name for name, row in run.rows.items() if row["method"] == NOBODY}
    axes = {axis for name in run.rows for axis in run.flights[name]["labels"]}
    seen = {
        axis: [{run.flights[n]["labels"].get(axis) for n in those} - {None} for those in (idle, run.rows.keys() - idle)] for axis in axes
    }
    who = {axis for axis, (without, with_) in seen.items() if with_ and not without & with_}
    partner: dict[tuple[Labels, int], str] = {}
    groups: dict[tuple[Labels, Labels], list[tuple[int, str]]] = {}
    for name, row in run.rows.items():
        said, replicate = run.flights[name]["labels"], run.flights[name]["replicate"]
        place = frozenset((axis, label) for axis, label in said.items() if axis not in who)
        if name in idle:
            partner.setdefault((place, replicate), name)
        else:
            method = frozenset((axis, label) for axis, label in said.items() if axis in who) or frozenset({("method", row["method"])})
            groups.setdefault((place, method), []).append((replicate, name))
    if not idle:
        return {}
    found = {}
    for (place, method), members in groups.items():
        met = [(name, partner[place, replicate]) for replicate, name in members if (place, replicate) in partner]
        for volume in next(iter(flags.values())):
            both = [(flags[other][volume], flags[name][volume], weight_of(run, other)) for name, other in met]
            found[place, method, volume] = figures_of([pair for pair in both if None not in pair])
    return found


def weight_of(run: Run, name: str) -> float | None:
    """What an encounter counts: by the column that the campaign names, else by ``weight`` where there is one, else 1."""
    column = run.campaign["daa"]["weight"] or "weight"
    axis = column.removeprefix("label.") if column.startswith("label.") else ""
    text = run.flights[name]["labels"].get(axis, "") if axis else run.rows[name].get(column, "1" if column == "weight" else "")
    try:
        weight = float(text)
    except ValueError:
        return None
    return weight if math.isfinite(weight) and weight >= 0.0 else None


def figures_of(pairs: list[tuple[Any, Any, Any]]) -> dict[str, float]:
    """Of encounters, (in without, in with, weight)."""

    def total(without: bool | None, with_: bool | None) -> float:
        return math.fsum(w for a, b, w in pairs if without in (None, a) and with_ in (None, b))

    below, every = total(True, None), total(None, None)
    counts = {"resolved": (True, False), "unresolved": (True, True), "induced": (False, True)}
    told: dict[str, float] = {name: sum((a, b) == kind for a, b, _ in pairs) for name, kind in counts.items()}
    told |= {"encounters": len(pairs), "share_without": _over(below, every), "share_with": _over(total(None, True), every)}
    told |= {"ratio": _over(total(None, True), below), "unresolved_ratio": _over(total(True, True), below)}
    return told | {"induced_ratio": _over(total(False, True), below)}


def _over(a: float, b: float) -> float:
    return a / b if b else math.nan


def _key(text: str) -> Labels:
    return frozenset((axis, label) for axis, _, label in (part.partition("=") for part in text.split(", ")) if axis)
