"""The flights that the claims of the paper are judged from, found by their labels."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ..approach import TOUCH_M
from ..run import TAKEN, figure_of

SINGLE, MULTI = ("single_106", "single_106_10"), ("multi_o2_up",)
SIDES = {"droam_hp": ("droam_hp_left", "droam_hp_right"), "droam_vp": ("droam_vp_up", "droam_vp_down")}
DROAM = ("droam_hp", "droam_vp", *SIDES["droam_hp"], *SIDES["droam_vp"])
AIR = ("design", "wind_mps", "wind_from", "severity")
DRAWN = ("robustness", "robustness_single", "robustness_multi")  # parts with draws
Flight = Mapping[str, Any]
Test = Callable[[Flight], bool]
Figure = Callable[[Flight], float]
Draws = dict[int, dict[str, list[Flight]]]  # replicate -> rung -> flights


def number(row: Flight, name: str) -> float:
    """A metric; NaN where it does not exist."""
    return figure_of(row.get(name))


def label(row: Flight, axis: str) -> str:
    """A label of a flight, empty where it has none."""
    return str(row.get(f"label.{axis}") or "")


def cell_of(row: Flight) -> tuple[str, str]:
    """Encounter and aircraft."""
    return label(row, "encounter"), label(row, "flown_by")


def route_length(row: Flight) -> float:
    """Length of the whole way, m: flights begin late on the route."""
    return number(row, "path_length_m") + number(row, "begin_s_m")


def replanned(row: Flight, value: float) -> float:
    """A figure of an avoidance; a flight that did not re-plan has none."""
    return value if number(row, "replans") > 0.0 else math.nan


def keeps_radius(row: Flight) -> bool:
    """Every radius is kept, a touch included."""
    return number(row, "least_clearance_m") >= -TOUCH_M and row["outcome"] not in ("diverged", "hit_ground")


class Flights:
    """Flights that say something, found by their labels: figures computed again, and those of ``results.csv`` where they were not."""

    def __init__(self, rows: Sequence[Flight]) -> None:
        self.rows = [row for row in rows if row["outcome"] not in TAKEN and not math.isnan(number(row, "least_clearance_m"))]
        self._unplanned = {self.place(row): row for row in self.rows if label(row, "method") == "none"}
        self._rails = {self._partner(row): row for row in self.pick(rung="kinematic", part=("calm", "wind"))}

    @staticmethod
    def place(row: Flight) -> tuple[str, ...]:
        return (*(label(row, name) for name in ("part", "encounter", "class", "flown_by", "rung", *AIR)), str(row["replicate"]))

    @staticmethod
    def _partner(row: Flight) -> tuple[str, ...]:
        who = tuple(label(row, name) for name in ("encounter", "method", "flown_by"))
        if label(row, "part") != "wind":  # in turbulence the calm one
            return ("calm", *who)
        return ("wind", *who, *(label(row, name) for name in AIR), str(row["replicate"]))

    def partner_fails(self, row: Flight) -> bool:
        """Is there a flight on rails of the same in the same wind, and does it fail?"""
        partner = self._rails.get(self._partner(row))
        return partner is not None and not keeps_radius(partner)

    def is_threat(self, row: Flight) -> bool:
        """Without planner a radius is not kept here, or that was not flown."""
        alone = self._unplanned.get(self.place(row))
        return alone is None or not keeps_radius(alone)

    def pick(self, **labels: str | tuple[str, ...]) -> list[Flight]:
        """Those with these labels; of several labels any."""
        wanted = {axis: (among,) if isinstance(among, str) else among for axis, among in labels.items()}
        return [row for row in self.rows if all(label(row, axis) in among for axis, among in wanted.items())]

    def draws(self, encounter: str, method: str | tuple[str, ...] = "scoam") -> Draws:
        """Flights of the robustness part by replicate and rung."""
        found: Draws = {}
        for row in self.pick(
            part=DRAWN,
            encounter=encounter,
            method=method,
            flown_by="gtm_t2",
            rung=("kinematic", "jsbsim"),
        ):
            found.setdefault(int(row["replicate"]), {}).setdefault(label(row, "rung"), []).append(row)
        return found
