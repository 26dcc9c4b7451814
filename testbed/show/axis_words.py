"""How axes of a sweep, places on them and the metrics drawn over them are worded: pictures, table and headline alike."""

from typing import Final

from testbed.results.columns import BY_NAME
from testbed.results.daa.columns import title
from testbed.results.statistics import Effect
from testbed.show import words

KEPT: Final = "kept"
"""The share that keeps every radius; the other metrics are columns of the results, or ratios of risk."""
RATIO: Final = "ratio."
"""What the name of a ratio of risk begins with; the rest is its volume."""
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
    if name.startswith(RATIO):
        return f"ratio of risk, {title(name.removeprefix(RATIO))}"
    column = BY_NAME[name]
    return f"{column.heading} ({column.unit})" if column.unit else column.heading


def metric_text(name: str, amount: float, unit: bool = True) -> str:
    """A value of a metric as it is shown everywhere."""
    if name == KEPT:
        return words.percent(amount)
    if name.startswith(RATIO):
        return words.number(amount, 2)
    column = BY_NAME[name]
    return words.number(amount, column.digits, column.unit if unit else "")


def interval_text(name: str, effect: Effect) -> str:
    """Its interval; a dash where there are too few flights for one."""
    if name == KEPT:
        return words.interval(effect.low, effect.high, "share")
    return words.interval(effect.low, effect.high, "", 2 if name.startswith(RATIO) else BY_NAME[name].digits)


def less_is_better(name: str) -> bool:
    """Of a metric that is no share of successes and no clearance."""
    return name.startswith(RATIO) or (name != KEPT and BY_NAME[name].worse == "high")
