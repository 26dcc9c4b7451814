"""How axes of a sweep, places on them and the metrics drawn over them are worded: pictures, table and headline alike."""

from typing import Final

from testbed.results.columns import BY_NAME
from testbed.results.statistics import Effect
from testbed.show import words

KEPT: Final = "kept"
"""The share that keeps every radius; the other metrics are columns of the results."""
TITLES: Final = {
    "air.wind.speed_mps": "wind speed (m/s)",
    "wind_mps": "wind speed (m/s)",
    "air.wind.from_deg": "where the wind comes from (deg)",
    "wind_from": "where the wind comes from",
}


def place_text(x: float) -> str:
    """A place on an axis."""
    return f"{x:g}".replace("-", words.MINUS)


def axis_title(axis: str) -> str:
    """An axis for people, with its unit in brackets: ``sensor range (m)``."""
    if axis in TITLES:
        return TITLES[axis]
    name, unit = words.setting(axis)
    return f"{name} ({unit})" if unit else name


def metric_title(name: str) -> str:
    """A metric for people, with its unit in brackets."""
    if name == KEPT:
        return "share that keeps every radius"
    column = BY_NAME[name]
    return f"{column.heading} ({column.unit})" if column.unit else column.heading


def metric_text(name: str, amount: float, unit: bool = True) -> str:
    """A value of a metric as it is shown everywhere."""
    if name == KEPT:
        return words.percent(amount)
    column = BY_NAME[name]
    return words.number(amount, column.digits, column.unit if unit else "")


def interval_text(name: str, effect: Effect) -> str:
    """Its interval; a dash where there are too few flights for one."""
    return words.interval(effect.low, effect.high, "share" if name == KEPT else "", None if name == KEPT else BY_NAME[name].digits)
