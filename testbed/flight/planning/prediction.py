"""What the aircraft's folder says of predicting it: how it answers the guidance, and how far flights differ from their predictions.

``prediction.yaml`` beside ``aircraft.yaml`` is written by ``testbed identify``. Without it the lags of the point mass are taken, which
are those of an aircraft that rolls at once, and a margin that nobody has identified.
"""

from functools import lru_cache
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator
from ruamel.yaml import YAML

from testbed.campaign.words.settings import FlightPlan
from testbed.core.section import NonNegative, Number, Positive, Section
from testbed.core.units import DEG
from testbed.flight.guidance.bank_to_turn import LEAST_LIFT_MPS2, UNLOAD
from testbed.flight.plants.aircraft import IDEAL_LAG_S, Aircraft
from vosc.predict import Aeroplane

FILE = "prediction.yaml"
AirKind = Literal["calm", "wind", "turbulence"]
UNIDENTIFIED_M = 3.0  # margin of an aircraft that has no such file


class Lags(Section):
    """Two stages of the answer to a bank and to a load factor, see ``vosc.predict.aeroplane``."""

    bank_lag_s: Positive
    roll_start_s: NonNegative
    load_lag_s: Positive
    load_start_s: NonNegative


class Margin(Section):
    """By time to go: what 99 of 100 predictions were at most too good by."""

    flights: int
    within_s: Annotated[tuple[Positive, ...], Field(min_length=1)]
    """Ends of the ranges of the time to the closest approach, s; the last holds for all beyond it."""
    margin_m: tuple[NonNegative, ...]
    median_m: tuple[Number, ...]
    """Predicted less flown clearance, in the median: what the model itself is out by."""
    predictions: tuple[int, ...]
    """How many predictions each figure comes from."""

    @model_validator(mode="after")
    def _one_for_each(self) -> "Margin":
        if len(self.margin_m) != len(self.within_s):
            raise ValueError("margin_m and within_s are of equal length")
        return self

    def at(self, time_s: np.ndarray) -> np.ndarray:
        """Margins (n,) for times to go (n,)."""
        k = np.searchsorted(np.array(self.within_s), time_s)
        return np.array(self.margin_m)[np.minimum(k, len(self.margin_m) - 1)]


class Prediction(Section):
    """The file."""

    found_by: str
    lags: Lags
    margins: dict[AirKind, Margin]


def read_prediction(folder: Path) -> Prediction | None:
    """What the folder of an aircraft says; None where nobody has identified it. ``ValueError`` for a file that says no such thing."""
    file = folder / FILE
    return _read(file, file.stat().st_mtime_ns) if file.is_file() else None


@lru_cache(maxsize=64)
def _read(file: Path, _changed_ns: int) -> Prediction:
    return Prediction.model_validate(YAML(typ="safe").load(file.read_text(encoding="utf-8")))


def air_kind(plan: FlightPlan) -> AirKind:
    """What a forecast would say of the plan's air."""
    if plan.air.turbulence.kind != "none" or plan.air.gust.kind != "none":
        return "turbulence"
    return "calm" if plan.air.wind.kind == "calm" or plan.air.wind.speed_mps == 0.0 else "wind"


def aeroplane_of(aircraft: Aircraft, lags: Lags | None) -> Aeroplane:
    """The aircraft of a prediction. A limit that is off, so that its lag is none, has no second lag either."""
    point, limits, guidance = aircraft.point_mass, aircraft.limits, aircraft.guidance
    rolls = lags is not None and point.bank_lag_s > IDEAL_LAG_S
    lifts = lags is not None and point.load_factor_lag_s > IDEAL_LAG_S
    return Aeroplane(
        bank_lag_s=lags.bank_lag_s if lags and rolls else point.bank_lag_s,
        roll_start_s=lags.roll_start_s if lags and rolls else 0.0,
        roll_rate_radps=limits.roll_rate_dps * DEG,
        load_lag_s=lags.load_lag_s if lags and lifts else point.load_factor_lag_s,
        load_start_s=lags.load_start_s if lags and lifts else 0.0,
        thrust_lag_s=point.thrust_lag_s,
        thrust_min=point.thrust_min,
        thrust_max=point.thrust_max,
        thrust_per_mps=point.thrust_per_mps,
        drag_zero=point.drag_zero,
        drag_lift=point.drag_lift,
        reference_mps=aircraft.autopilot.reference_mps,
        bank_rad=limits.bank_deg * DEG,
        load_min=limits.load_factor_min,
        load_max=limits.load_factor_max,
        one_g_mps=limits.alpha_max_1g_mps,
        slowest_mps=limits.speed_min_mps,
        unload=UNLOAD,
        least_lift_mps2=LEAST_LIFT_MPS2,
        turn_1ps=2.0 * guidance.damping * guidance.bandwidth_rad_s,
    )
