"""Velocity-obstacle avoidance in three dimensions: threat test, spherical caps, avoidance methods, insertion point, spatial PH
quintics, the widest curve between two poses.

What it cannot answer it refuses by name (``vosc.errors``; all are ``ValueError``).

SI units and radians; any right-handed frame with z up. The library needs numpy and nothing else.
"""

from vosc import ph
from vosc.encounter import Obstacle, Own, Threat, threat, threatening
from vosc.errors import Degenerate, NoCurve, NoDirection, NotNumbers, OutOfProportion, Refusal, SamePoint, WrongAnswer, WrongOption
from vosc.insertion import Insertion, insertion_point
from vosc.insertion_reach import Join, widest_join
from vosc.spherical_cap import Cap, cap

__all__ = [
    "Cap",
    "Degenerate",
    "Insertion",
    "Join",
    "NoCurve",
    "NoDirection",
    "NotNumbers",
    "Obstacle",
    "OutOfProportion",
    "Own",
    "Refusal",
    "SamePoint",
    "Threat",
    "WrongAnswer",
    "WrongOption",
    "cap",
    "insertion_point",
    "ph",
    "threat",
    "threatening",
    "widest_join",
]
