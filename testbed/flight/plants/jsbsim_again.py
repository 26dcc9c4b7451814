"""A trim that was found before, put into a fresh executive without the search: where that is the same to the last bit.

JSBSim's trim leaves more behind than its controls: engines and filters are in a state that has a history. Of a turbine that is its two
speeds, which can be set; of a piston engine it is turning speed, heat and more, which cannot. So it is tried, not presumed: when a
start comes for the second time, the trim is searched for once more and put into a twin, both are put on the path and flown for a
second, and only if every property that JSBSim has is the same in both is it put the next time. An aircraft whose trim cannot be put is
trimmed for every flight, as if nothing were known.
"""

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from testbed.core.kept import Kept
from testbed.core.model_files import wheel_root

Fdm = Any
TWIN_STEPS = 120
SURFACES = tuple(f"fcs/{name}-cmd-norm" for name in ("elevator", "aileron", "rudder", "pitch-trim", "roll-trim", "yaw-trim"))
STATE = tuple(f"ic/{name}-rad" for name in ("gamma", "alpha", "theta", "phi", "psi-true"))
OF_ENGINES = ("propulsion/engine[{}]/n1", "propulsion/engine[{}]/n2")
THROTTLE = "fcs/throttle-cmd-norm[{}]"
BESIDE = ("simulation/trim-completed", "side_friction_coeff", "rolling_friction_coeff")
"""Neither the state of the aircraft nor, in the air, a number: a wheel's friction is not set before it touches the ground."""


class Put(NamedTuple):
    """What a trim set, by the names of its properties; what it found (a ``Trim``)."""

    before: tuple[tuple[str, float], ...]
    after: tuple[tuple[str, float], ...]
    trim: Any


@dataclass
class _Known:
    """Of one start: how often it was asked for, and the trim once it was found that it can be put."""

    times: int = 0
    put: Put | None = None


_known: Kept[_Known] = Kept(256)


def trimmed_again(
    key: tuple[object, ...], fresh: Callable[[], Fdm], search: Callable[[], tuple[Fdm, Any]], start: Callable[[Fdm, Any], None]
) -> tuple[Fdm, Any]:
    """An executive in trim, and the trim. ``key``: everything that it depends on.

    ``fresh``: an executive before its trim; ``search``: one after it, and the trim; ``start``: puts one on its path.
    """
    known = _known.get(key, _Known)
    known.times += 1
    if known.times == 2:
        known.put = _found_alike(fresh, search, start)
    if known.put is None:
        return search()
    fdm = fresh()
    _put(fdm, known.put)
    return fdm, known.put.trim


def _found_alike(fresh: Callable[[], Fdm], search: Callable[[], tuple[Fdm, Any]], start: Callable[[Fdm, Any], None]) -> Put | None:
    """What to put, if a twin that it is put into cannot be told from the one that was trimmed."""
    fdm, trim = search()
    engines = range(fdm.get_propulsion().get_num_engines())
    names = [name for k in engines for form in OF_ENGINES if fdm.get_property_manager().get_node(name := form.format(k)) is not None]
    before = (*SURFACES, *(THROTTLE.format(k) for k in engines), *STATE)
    found = Put(tuple((name, fdm[name]) for name in before), tuple((name, fdm[name]) for name in names), trim)
    twin = fresh()
    _put(twin, found)
    for each in (fdm, twin):
        start(each, trim)
    for _ in range(2):
        if not _alike(fdm, twin):
            return None
        for _ in range(TWIN_STEPS):
            fdm.run()
            twin.run()
    return found if _alike(fdm, twin) else None


def _put(fdm: Fdm, found: Put) -> None:
    for name, value in found.before:
        fdm[name] = value
    fdm.set_trim_status(True)
    fdm.run_ic()
    fdm.set_trim_status(False)
    for name, value in found.after:
        fdm[name] = value


def _alike(one: Fdm, other: Fdm) -> bool:
    """Every property the same, bit by bit."""
    for line in one.query_property_catalog("/").splitlines():
        name = line.partition(" (")[0].strip()
        if name and not name.endswith(BESIDE):
            here, there = one.get_property_value(name), other.get_property_value(name)
            if here != there and not (math.isnan(here) and math.isnan(there)):
                return False
    return True


def stamp(model: Path) -> tuple[object, ...]:
    """Of everything that a model may be made of: it is another one when a file was changed. What JSBSim's wheel ships does not change."""
    if wheel_root() in model.parents:
        return (model,)
    root = model.parents[2] if len(model.parents) > 2 else model.parent
    files: list[tuple[str, int, int]] = []
    for folder in (model.parent, *(root / beside for beside in ("engine", "systems"))):
        for here, _, names in os.walk(folder):
            for name in sorted(names):
                state = os.stat(os.path.join(here, name))
                files.append((f"{here}/{name}", state.st_mtime_ns, state.st_size))
    return (model, *files)
