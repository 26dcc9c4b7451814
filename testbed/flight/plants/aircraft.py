"""The aircraft as the flight sees it: what its file says, with limits of its point mass off where a plan asks for that."""

from testbed.campaign.reading.aircraft import read_aircraft
from testbed.campaign.words.aircraft import Aircraft, AutopilotGains, GuidanceGains, Limits, Model, PointMass
from testbed.core.catalogue import aircraft_folders

__all__ = ["Aircraft", "AutopilotGains", "GuidanceGains", "Limits", "Model", "PointMass", "idealised", "load_aircraft"]

IDEAL_LAG_S = 1e-4
UNLIMITED = 1e3


def idealised(aircraft: Aircraft, ideal: tuple[str, ...]) -> Aircraft:
    """The aircraft with some limits of its point mass off: ``roll``, ``load_factor``, ``gust`` (``speed`` is the plant's own switch).

    Guidance then neither clips what the limit clipped nor looks ahead for a lag that is gone. A lift that follows its command at
    once has no gust load either.
    """
    limits: dict[str, float] = {}
    gains: dict[str, float] = {}
    point: dict[str, float] = {}
    if "roll" in ideal:
        limits |= {"bank_deg": 179.0, "roll_rate_dps": 1e6}
        gains |= {"bank_lead_s": 0.0}
        point |= {"bank_lag_s": IDEAL_LAG_S}
    if "load_factor" in ideal:
        slowest = {"alpha_max_1g_mps": 1.0 / UNLIMITED, "speed_min_mps": 1.0 / UNLIMITED}
        limits |= {"load_factor_min": -UNLIMITED, "load_factor_max": UNLIMITED} | slowest
        gains |= {"load_factor_lead_s": 0.0}
        point |= {"load_factor_lag_s": IDEAL_LAG_S}
    if "load_factor" in ideal or "gust" in ideal:
        point |= {"load_factor_per_rad": 0.0}
    return aircraft.model_copy(
        update={
            "limits": aircraft.limits.model_copy(update=limits),
            "guidance": aircraft.guidance.model_copy(update=gains),
            "point_mass": aircraft.point_mass.model_copy(update=point),
        }
    )


def load_aircraft(name: str) -> Aircraft:
    """The aircraft of that folder name. Raises ``KeyError`` for an unknown one, ``SpecError`` for a bad file."""
    return read_aircraft(aircraft_folders()[name])
