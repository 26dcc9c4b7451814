"""Whether the aircraft that a plan names can fly it: its files, its gains, its airspeeds."""

from testbed.campaign.reading.aircraft import read_aircraft
from testbed.campaign.reading.document import Fault
from testbed.campaign.reading.possible import start_airspeed
from testbed.campaign.words.settings import FlightPlan
from testbed.core.catalogue import aircraft_folders


def unfit(plan: FlightPlan) -> list[Fault]:
    """What keeps the plan's aircraft from flying it. Raises ``SpecError`` when the aircraft's own files are wrong.

    A point on rails has the aircraft's name and nothing else of it. A point mass without the limit of its lift may be as slow, one
    without that of its thrust as fast as it likes.
    """
    aircraft = read_aircraft(aircraft_folders()[plan.aircraft])
    if plan.plant.kind == "kinematic":
        return []
    if not aircraft.gains_found_by:
        return [Fault(("aircraft",), f"'{plan.aircraft}' has no gains yet", f"testbed tune {plan.aircraft} finds them")]
    limits, ideal = aircraft.limits, plan.plant.ideal
    too_slow = plan.speed_mps < limits.speed_min_mps and "load_factor" not in ideal
    too_fast = plan.speed_mps > limits.speed_max_mps and "speed" not in ideal
    flown = start_airspeed(plan)
    if flown is not None and not (too_slow or too_fast) and not ideal and not limits.speed_min_mps <= flown <= limits.speed_max_mps:
        holds = f"in this wind that is {flown:.1f} m/s through the air at the start"
        return [Fault(("speed_mps",), f"{holds}; {plan.aircraft} holds {limits.speed_min_mps:g} to {limits.speed_max_mps:g} m/s")]
    if too_slow or too_fast:
        holds = f"{plan.aircraft} holds {limits.speed_min_mps:g} to {limits.speed_max_mps:g} m/s"
        return [Fault(("speed_mps",), f"{holds}, not {plan.speed_mps:g} m/s", "limits of its aircraft.yaml; a kinematic plant has none")]
    return []
