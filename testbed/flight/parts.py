"""What can be plugged into the loop, by name. Adding one: write the file, add the line."""

from collections.abc import Callable

from testbed.campaign.words.settings import FlightPlan
from testbed.flight.aircraft import Aircraft
from testbed.flight.guidance.l1 import L1Law
from testbed.flight.guidance.look_ahead import Law, LookAheadLaw, SpeedHold
from testbed.flight.plants.base import Plant, Start
from testbed.flight.plants.kinematic import KinematicPlant
from testbed.flight.plants.point_mass import PointMassPlant
from testbed.flight.scene import Scene


def _kinematic(plan: FlightPlan, _aircraft: Aircraft, start: Start, scene: Scene) -> Plant:
    return KinematicPlant(start, scene.air, plan.rates.plant_hz, plan.speed_hold == "airspeed")


def _point_mass(plan: FlightPlan, aircraft: Aircraft, start: Start, scene: Scene) -> Plant:
    return PointMassPlant(aircraft, start, scene.air.at, plan.rates.plant_hz, "speed" in plan.plant.ideal)


def _jsbsim(plan: FlightPlan, aircraft: Aircraft, start: Start, scene: Scene) -> Plant:
    from testbed.flight.plants.jsbsim import JsbsimPlant  # JSBSim is loaded only by flights that need it

    return JsbsimPlant(aircraft, start, plan.rates.plant_hz, plan.rates.guidance_hz, plan.terrain_z_m, scene.air)


def _look_ahead(plan: FlightPlan, aircraft: Aircraft) -> Law:
    return LookAheadLaw(aircraft, _speed_hold(plan), 1.0 / plan.rates.guidance_hz)


def _speed_hold(plan: FlightPlan) -> SpeedHold:
    return SpeedHold(plan.speed_mps, plan.speed_hold == "airspeed", plan.guidance.schedule == "keep")


def _l1(plan: FlightPlan, aircraft: Aircraft) -> Law:
    return L1Law(aircraft, _speed_hold(plan), 1.0 / plan.rates.guidance_hz)


PLANTS: dict[str, Callable[[FlightPlan, Aircraft, Start, Scene], Plant]] = {
    "kinematic": _kinematic,
    "point_mass": _point_mass,
    "jsbsim": _jsbsim,
}

GUIDANCE: dict[str, Callable[[FlightPlan, Aircraft], Law]] = {
    "look_ahead": _look_ahead,
    "l1": _l1,
}
