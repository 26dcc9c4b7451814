"""The only conversion factors in the project. Everything inside is SI and radians."""

import math

DEG = math.pi / 180.0
"""Radians in a degree."""

FT = 0.3048
"""Metres in an international foot (exact)."""

G0_MPS2 = 9.80665
"""Standard acceleration of free fall, m/s^2 (CGPM 1901, exact)."""

KNOT = 1852.0 / 3600.0
"""Metres per second in a knot (exact)."""
