"""Every number the paper prints in section 5 and Tables 1-4, with its digits.

The digits are kept as text: half a unit in the last printed place is what the authors' rounding hides. Keys: ``own`` the UAV at P_t,
``o`` the obstacle of section 5.1 (cap ``g``, insertion point ``q``, avoidance direction ``dir``), ``o1`` and ``o2`` those of section
5.2 (``g1``, ``g2``, ``q2``, ``k``, ``dir2``, ``turn2``), ``t2`` and ``t4`` the rows of Tables 2 and 4. Metres, m/s, degrees, seconds.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final


@dataclass(frozen=True)
class Number:
    """A printed number. ``exact``: chosen by the authors, not rounded (a speed the text supposes, a radius, a starting point)."""

    text: str
    exact: bool = False

    @property
    def value(self) -> float:
        return float(self.text)

    @property
    def decimals(self) -> int:
        return len(self.text.partition(".")[2])

    @property
    def half_ulp(self) -> float:
        """Half a unit in the last printed place; 0 for an exact number."""
        return 0.0 if self.exact else 0.5 * 10.0**-self.decimals


def _set(**groups: str) -> dict[str, Number]:
    """``own="x 162, y 101"`` as ``{"own.x": Number("162"), ...}``; a trailing ``!`` marks an exact number."""
    out = {}
    for group, text in groups.items():
        for item in text.split(","):
            name, digits = item.split()
            out[f"{group}.{name}"] = Number(digits.rstrip("!"), digits.endswith("!"))
    return out


INITIAL: Final = _set(
    own="x 162, y 101, z 64.3, speed 50!, az 24.7, el 12.0, d0 100!",
    o="x 254, y 63.6, z 60.7, speed 40, az 135, el 12.4, radius 25!",
    o1="x 254, y 63.8, z 59.8, speed 35, az 106, el 11.4, radius 25!",
    o2="x 208, y 186, z 42.5, speed 32, az -50.3, el -15.4, radius 30!",
    route="start_x 0!, start_y 0!, start_z 0!, goal_x 500!, goal_y 200!, goal_z 100!",
)
"""Initial conditions: what a result may be computed from (Tables 1 and 3, and the sentences round them)."""

RESULTS: Final = _set(
    g="r 46.3, az 30.2, el 3.23, gamma 22.2",
    q="x 226.34, y 159.56, z 79.05",
    dir="az 36.6, el 13.2",
    t2="scoam_deflection 11.9, scoam_length 575.6, scoam_time 1.75, hp_deflection 12.8, hp_length 579.8, hp_time 1.81, "
    "vp_deflection 20.4, vp_length 587.1, vp_time 1.96",
    g1="r 38.1, az 15.4, el 3.10, gamma 40.4",
    g2="r 32.2, az 22.8, el 23.5, gamma 49.9",
    q2="x 229, y 148, z 77.6",
    k="x 206.5, y 101.0, z 88.5",
    dir2="az 22.2, el -38.9",
    turn2="az -3.88, el 12.86",
    t4="scoam_deflection 13.4, scoam_length 582.4, scoam_time 1.19, hp_deflection 25.5, hp_length 595.7, hp_time 1.45, "
    "vp_deflection 18.4, vp_length 588.2, vp_time 1.28",
)
"""Results: what the paper says came out."""

PRINTED: Final[Mapping[str, Number]] = MappingProxyType({**INITIAL, **RESULTS})
