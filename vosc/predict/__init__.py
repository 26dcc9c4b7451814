"""An aircraft as a fast point mass: where many manoeuvres lead, all of them at once, and how near they come to moving spheres."""

from vosc.predict.aeroplane import Aeroplane, Motion, step
from vosc.predict.clearance import Spheres, least_clearance
from vosc.predict.guided import Directions, Flown, Programmes, at_once, fly_on

__all__ = ["Aeroplane", "Directions", "Flown", "Motion", "Programmes", "Spheres", "at_once", "fly_on", "least_clearance", "step"]
