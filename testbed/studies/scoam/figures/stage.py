"""What the figures are made of: the encounters of section 5 under a reading, and values beside the printed ones."""

import math
from dataclasses import dataclass

import numpy as np

from testbed.core.units import DEG
from testbed.show.drawing import Value
from testbed.studies.scoam.audit.case import Case, numbers
from testbed.studies.scoam.audit.geometry import obstacle, own
from testbed.studies.scoam.audit.printed import PRINTED
from testbed.studies.scoam.audit.readings import AS_PRINTED, READINGS
from testbed.studies.scoam.audit.report import HYPHEN_AS_MINUS
from vosc import Cap, Obstacle, Own, cap, threat
from vosc.vec import azimuth_elevation, three

Array = np.ndarray
SINGLE, MULTI = "azimuth_106", "o2_elevation_plus"
"""Readings in which the obstacles of sections 5.1 and 5.2 are threats."""
HAT, PRIME = "\N{COMBINING CIRCUMFLEX ACCENT}", "\N{PRIME}"
ALPHA, GAMMA, DELTA, PSI, THETA, LAMBDA = (
    "\N{GREEK SMALL LETTER ALPHA}",
    "\N{GREEK SMALL LETTER GAMMA}",
    "\N{GREEK SMALL LETTER DELTA}",
    "\N{GREEK SMALL LETTER PSI}",
    "\N{GREEK SMALL LETTER THETA}",
    "\N{GREEK SMALL LETTER LAMDA}",
)
V_NEW, V_FAR, W_NEW, W_FAR = f"v{HAT}_u", f"v{HAT}{PRIME}_u", f"v{HAT}_uo", f"v{HAT}{PRIME}_uo"


def case_of(reading: str) -> Case:
    """The printed numbers under a reading."""
    one = next(known for known in (AS_PRINTED, *READINGS) if known.name == reading)
    return Case({key: number.value for key, number in numbers(one).items()}, one.switches)


@dataclass(frozen=True)
class Encounter:
    """One obstacle as the UAV meets it at P_t. A velocity is drawn as the way that it leads in a second, as in the paper."""

    me: Own
    body: Obstacle

    @property
    def at(self) -> Array:
        """P_u."""
        return np.array(self.me.pos_m)

    @property
    def there(self) -> Array:
        """P_o."""
        return np.array(self.body.pos_m)

    @property
    def v_u(self) -> Array:
        return np.array(self.me.vel_mps)

    @property
    def v_o(self) -> Array:
        return np.array(self.body.vel_mps)

    @property
    def v_uo(self) -> Array:
        """Eq. 1."""
        return self.v_u - self.v_o

    @property
    def sight(self) -> Array:
        """Unit vector from P_u to P_o."""
        way = self.there - self.at
        return np.asarray(way / np.linalg.norm(way))

    @property
    def cap(self) -> Cap:
        """G."""
        found = cap(self.me, self.body)
        assert found is not None, "the obstacles of the paper are slower than the UAV"
        return found

    @property
    def middle(self) -> Array:
        """P_u M, m/s."""
        return 0.5 * (self.cap.nearest_mps + self.cap.farthest_mps)


def encounter(reading: str, name: str) -> Encounter:
    """With ``o`` of section 5.1, or ``o1`` or ``o2`` of section 5.2."""
    case = case_of(reading)
    return Encounter(own(case), obstacle(case, name))


def printed(*keys: str) -> str:
    """What the paper prints, as it prints it."""
    told = [PRINTED[key].text.replace("-", "\N{MINUS SIGN}") for key in keys]
    return told[0] if len(told) == 1 else f"({', '.join(told)})"


def direction(sign: str, what: str, vector: Array, *keys: str, digits: int = 1) -> Value:
    """A direction as azimuth and elevation, deg."""
    azimuth, elevation = azimuth_elevation(three("direction", vector))
    return Value(sign, what, (azimuth / DEG, elevation / DEG), "deg", digits, printed(*keys) if keys else "")


def judged(meeting: Encounter, index: str = "") -> list[Value]:
    """The threat test of section 2."""
    found = threat(meeting.me, meeting.body)
    return [
        Value(f"d_0{index}", "distance P_u P_o", found.distance_m, "m", 1),
        Value(f"{ALPHA}_0{index}", "half-angle of the collision cone, arcsin R/d_0", found.alpha0_rad / DEG, "deg"),
        Value(f"{ALPHA}{f'_{index}' if index else ''}", "angle of v_uo off the line of sight", found.alpha_rad / DEG, "deg"),
        Value(f"d{f'_{index}' if index else ''}", f"the straight lines pass at (R = {meeting.body.radius_m:g} m)", found.miss_m, "m", 1),
    ]


def threat_words(reading: str, name: str, meeting: Encounter) -> str:
    """What the printed direction gives, and what the reading does."""
    as_printed = threat(*_bodies(encounter("as_printed", name)))
    here = threat(meeting.me, meeting.body)
    what = next(known.what for known in READINGS if known.name == reading)
    told = (
        f"{what} As printed the straight lines pass at {as_printed.miss_m:.1f} m, {ALPHA} {as_printed.alpha_rad / DEG:.2f} deg against "
        f"{ALPHA}_0 {as_printed.alpha0_rad / DEG:.2f}: {_verdict(as_printed.is_threat)}. In this reading {here.alpha_rad / DEG:.2f} deg: "
        f"{_verdict(here.is_threat)}."
    )
    return HYPHEN_AS_MINUS.sub("\N{MINUS SIGN}", told)


def _bodies(meeting: Encounter) -> tuple[Own, Obstacle]:
    return meeting.me, meeting.body


def _verdict(is_threat: bool) -> str:
    return "a threat" if is_threat else "no threat"


def g_values(meeting: Encounter, key: str, index: str = "") -> list[Value]:
    """The four numbers of G."""
    found = meeting.cap
    return [
        Value(f"r{index}", "distance P_u M", found.radius_mps, "m/s", 1, printed(f"{key}.r")),
        Value(f"{PSI}_r{index.strip('_')}", "azimuth of P_u M", found.azimuth_rad / DEG, "deg", 1, printed(f"{key}.az")),
        Value(f"{THETA}_r{index.strip('_')}", "elevation of P_u M", found.elevation_rad / DEG, "deg", 2, printed(f"{key}.el")),
        Value(f"{GAMMA}{index}", "half-angle of SC", found.half_angle_rad / DEG, "deg", 1, printed(f"{key}.gamma")),
    ]


def unit(vector: Array) -> Array:
    """Of length 1."""
    return np.asarray(vector / np.linalg.norm(vector))


def angle_deg(first: Array, last: Array) -> float:
    """Between two vectors."""
    return math.degrees(math.acos(float(np.clip(unit(first) @ unit(last), -1.0, 1.0))))
