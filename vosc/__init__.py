"""Velocity-obstacle avoidance in three dimensions: threat test, spherical caps, avoidance methods, insertion point, spatial PH quintics.

SI units and radians; any right-handed frame with z up. The library needs numpy and nothing else.
"""

from vosc import ph
from vosc.encounter import Obstacle, Own, Threat, threat
from vosc.insertion import Insertion, insertion_point
from vosc.spherical_cap import Cap, cap

__all__ = ["Cap", "Insertion", "Obstacle", "Own", "Threat", "cap", "insertion_point", "ph", "threat"]
