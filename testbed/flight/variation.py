"""What a plan's ``vary`` makes of its aircraft: factors, drawn evenly from 1 -+ a share and known by the name of what they scale.

The draw knows the seed and the replicate and not the method, the plant or the share: half the share is half the deviation, and a
point has the lags and gains of the aeroplane. Autopilot and guidance keep gains, look-ahead times and limits of the aircraft as published,
apart from what ``gains_share`` changes: whether they hold an aircraft that is not the one they were made for is the question.

    from testbed.flight.variation import variation
    variation(plan)     # {"aero/coefficient/Clp": 1.07, ..., "guidance.damping": 0.91}: of this plan, whenever it is asked
"""

from collections.abc import Sequence

from testbed.campaign.words.settings import FlightPlan
from testbed.core.seeds import stream
from testbed.flight.plants.aircraft import Aircraft, AutopilotGains, GuidanceGains, load_aircraft

# what aircraft.yaml says; a dot leads into a section
DERIVATIVES = ("point_mass.drag_lift", "point_mass.drag_zero")
LAGS = ("command_lag_s", "point_mass.bank_lag_s", "point_mass.load_factor_lag_s", "point_mass.thrust_lag_s")
GAINS = tuple(
    sorted(
        [f"autopilot.{name}" for name in AutopilotGains.model_fields if name != "reference_mps"]
        + [f"guidance.{name}" for name in GuidanceGains.model_fields]
        + ["point_mass.thrust_per_mps"]
    )
)


def variation(plan: FlightPlan) -> dict[str, float]:
    """Name to factor of everything that is varied in this flight; empty for a point on rails, which has none of it.

    Names of aircraft.yaml come first in each draw, then those of the JSBSim file (``plants/jsbsim_model.py``), both sorted.
    """
    vary = plan.vary
    if plan.plant.kind == "kinematic":
        return {}
    derivatives: Sequence[str] = ()
    lags: Sequence[str] = ()
    if plan.plant.kind == "jsbsim" and (vary.derivatives_share or vary.lags_share):
        from testbed.flight.plants.jsbsim_model import read_model
        from testbed.flight.plants.jsbsim_start import model_file  # JSBSim is loaded only by flights that need it

        model = read_model(model_file(load_aircraft(plan.aircraft)))
        derivatives, lags = model.derivatives, model.lags
    return {
        **_draw(plan, "vary.derivatives", vary.derivatives_share, [*DERIVATIVES, *derivatives]),
        **_draw(plan, "vary.lags", vary.lags_share, [*LAGS, *lags]),
        **_draw(plan, "vary.gains", vary.gains_share, GAINS),
    }


def varied(aircraft: Aircraft, plan: FlightPlan) -> Aircraft:
    """The aircraft that the plan flies; the same one when nothing is varied."""
    factors = variation(plan)
    if not factors:
        return aircraft
    sections: dict[str, dict[str, float]] = {"": {}, "autopilot": {}, "guidance": {}, "point_mass": {}}
    for path in {*DERIVATIVES, *LAGS, *GAINS} & factors.keys():
        section, _, name = path.rpartition(".")
        sections[section][name] = getattr(getattr(aircraft, section) if section else aircraft, name) * factors.pop(path)
    changes = {name: getattr(aircraft, name).model_copy(update=values) for name, values in sections.items() if name}
    return aircraft.model_copy(update=sections[""] | changes | {"model": aircraft.model.model_copy(update={"factors": factors})})


def _draw(plan: FlightPlan, purpose: str, share: float, names: Sequence[str]) -> dict[str, float]:
    if share == 0.0:
        return {}
    deviations = stream(plan.seed, plan.replicate, purpose).uniform(-1.0, 1.0, len(names))
    return {name: 1.0 + share * float(deviation) for name, deviation in zip(names, deviations, strict=True)}
