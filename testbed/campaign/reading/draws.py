"""Settings that are drawn for each replicate: the range about what a plan says, its ends, and one value out of it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic import BaseModel

from testbed.campaign.words.grid import Draw
from testbed.campaign.words.settings import FlightPlan
from testbed.core.seeds import stream


class DrawError(Exception):
    """A setting that cannot be drawn like that; the message is for users."""

    def __init__(self, path: str, message: str) -> None:
        self.path = path
        super().__init__(message)


def value_at(plan: FlightPlan, path: str) -> Any:
    """What a plan has at a dotted path (obstacles by name); None where it has nothing."""
    node: Any = plan
    for key in path.split("."):
        if isinstance(node, tuple):
            node = next((item for item in node if getattr(item, "name", None) == key), None)
        elif isinstance(node, dict):
            node = node.get(key)
        else:
            node = getattr(node, key, None)
    return node


def extremes(draw: Draw, path: str, plan: FlightPlan) -> Sequence[Any]:
    """The values that a check has to try: both ends of the range, or every choice. Raises ``DrawError``."""
    if draw.among is not None:
        return draw.among
    low, high = _range(draw, path, value_at(plan, path))
    return [_listed(low), _listed(high)]


def drawn(draw: Draw, path: str, plan: FlightPlan, seed: int, replicate: int) -> Any:
    """The value at ``path`` in one replicate. Raises ``DrawError``."""
    rng = stream(seed, replicate, f"draw.{path}")
    if draw.among is not None:
        return draw.among[int(rng.integers(len(draw.among)))]
    low, high = _range(draw, path, value_at(plan, path))
    return _listed(np.clip(rng.uniform(low, high), low, high))  # rounding may lead past an end


def _range(draw: Draw, path: str, nominal: Any) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest value, arrays () or (n,)."""
    if draw.between is not None:
        low, high = (np.array(end) for end in draw.between)
        return low, high
    if nominal is None:
        raise DrawError(path, "has no value about which to draw")
    items = nominal if isinstance(nominal, tuple) else (nominal,)
    if isinstance(nominal, BaseModel | dict) or not items or not all(isinstance(x, int | float) and not isinstance(x, bool) for x in items):
        raise DrawError(path, "is no number, nor a list of numbers: draw it with among")
    middle, half = np.array(nominal, dtype=float), np.array(draw.within)
    if half.ndim and half.shape != middle.shape:
        raise DrawError(path, f"has {len(items) if middle.ndim else 'one'} value{'s' if middle.ndim else ''}, within {len(half)}")
    return middle - half, middle + half


def _listed(array: np.ndarray) -> Any:
    """As YAML would say it."""
    return array.tolist()
