"""``testbed identify NAME``: how the aircraft answers, and how far flights differ from their predictions, into ``prediction.yaml``.

First the model: the four lags of the answer are those with which the prediction of held directions, flown in calm air, is nearest to the
places that were flown. Then the margin: in each kind of air, by time to go, the 99th percentile of predicted less flown clearance, which
never falls with the time to go. The flights that found the lags are not those that find the margin.
"""

import math
from collections.abc import Callable, Sequence
from io import StringIO
from typing import Any

import numpy as np
from ruamel.yaml import YAML
from scipy.optimize import minimize

from testbed.airframe.foresight_trial import SEVERITY, WIND_MPS, Trial, flown_trial, trial_plan
from testbed.core.frames import Vec3
from testbed.flight.planning.prediction import FILE, AirKind, Lags, Margin, Prediction, aeroplane_of, read_prediction
from testbed.flight.plants.aircraft import Aircraft, load_aircraft
from vosc.predict import Directions, Motion, fly_on
from vosc.predict.aeroplane import drag

Array = np.ndarray
AIRS: tuple[AirKind, ...] = ("calm", "wind", "turbulence")
LAG_FLIGHTS = 60
LAG_NUMBER = 1_000_000  # their numbers begin here: another stream than the margin's
WITHIN_S = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0)
SHARE = 0.99
LOOKED_AT_S = np.array([0.2, 0.4, 0.6, 0.8, 1.0, 1.25, 1.5, 1.75, 2.0])
LEAST_FLIGHTS = 20
FIRST_START_S = 0.05
EVALUATIONS = 240  # of the search for the lags, at most
AIR_WORDS = {"calm": "still air", "wind": f"{WIND_MPS:g} m/s of steady wind, known", "turbulence": f"{SEVERITY} turbulence (Dryden)"}


class IdentifyError(RuntimeError):
    """Nothing can be identified; str() says why."""


def identify(name: str, airs: Sequence[AirKind], encounters: int, seed: int, say: Callable[[str], None]) -> Prediction:
    """Fly, find lags and margins, and write them into the aircraft's folder. Raises ``IdentifyError``.

    The file is written as soon as the lags are known, because the planner that is flown reads it. Margins of other lags are dropped; those
    of these lags, of air that is not asked for, stay.
    """
    aircraft = load_aircraft(name)
    if encounters < LEAST_FLIGHTS:
        raise IdentifyError(f"--encounters {encounters}: give at least {LEAST_FLIGHTS}, a percentile of fewer says nothing")
    before, file = read_prediction(aircraft.folder), aircraft.folder / FILE
    held = _flown(name, aircraft, "calm", seed, range(LAG_NUMBER, LAG_NUMBER + 2 * LAG_FLIGHTS, 2), "first_order")
    lags = fitted(aircraft, held)
    say(f"answer of {name}, from {len(held)} flights: " + ", ".join(f"{key} {value:.3f}" for key, value in lags.model_dump().items()))
    say(
        "  out by after 1 s and 2 s, rms, m: " + "; ".join(out_by(aircraft, held, *each) for each in (("first-order", None), ("now", lags)))
    )
    margins = dict(before.margins) if before and before.lags == lags else {}
    found = Prediction(found_by=f"testbed identify {name} --encounters {encounters} --seed {seed}", lags=lags, margins=margins)
    file.write_text(as_yaml(found), encoding="utf-8")
    for air in airs:
        margin = margin_of(_flown(name, aircraft, air, seed, range(encounters), "identified"))
        found = found.model_copy(update={"margins": {**found.margins, air: margin}})
        file.write_text(as_yaml(found), encoding="utf-8")
        say("\n".join(table(air, margin)))
    return found


def _flown(name: str, aircraft: Aircraft, air: AirKind, seed: int, numbers: range, model: str) -> list[Trial]:
    plans = (trial_plan(name, aircraft, air, seed, number, model) for number in numbers)
    return [trial for plan in plans if (trial := flown_trial(plan)) is not None]


def fitted(aircraft: Aircraft, trials: Sequence[Trial]) -> Lags:
    """The lags with which the predictions of held directions come nearest to the places that were flown. Raises ``IdentifyError``."""
    usable = _usable(trials)
    if len(usable) < LEAST_FLIGHTS:
        raise IdentifyError(
            f"only {len(usable)} of {len(trials)} flights held a direction for long enough; at least {LEAST_FLIGHTS} are needed"
        )
    point = aircraft.point_mass

    def lags_of(logs: Array) -> Lags:
        bank, roll, load, start = (float(np.clip(math.exp(log), 1e-3, 2.0)) for log in logs)
        return Lags(bank_lag_s=bank, roll_start_s=roll, load_lag_s=load, load_start_s=start)

    def cost(logs: Array) -> float:
        return float(np.nanmean(_missed(aircraft, usable, lags_of(logs)) ** 2))

    first = np.log([point.bank_lag_s, FIRST_START_S, point.load_factor_lag_s, FIRST_START_S])
    best = minimize(cost, first, method="Nelder-Mead", options={"maxfev": EVALUATIONS, "xatol": 0.01, "fatol": 1e-5})
    return Lags(**{key: round(value, 3) for key, value in lags_of(best.x).model_dump().items()})


def _usable(trials: Sequence[Trial]) -> list[Trial]:
    return [trial for trial in trials if trial.direction is not None and trial.until_s - trial.from_s > LOOKED_AT_S[3]]


def _missed(aircraft: Aircraft, trials: Sequence[Trial], lags: Lags | None) -> Array:
    """Distance (m) between predicted and flown places, (flights, ``LOOKED_AT_S``); NaN once a manoeuvre is over."""
    aeroplane = aeroplane_of(aircraft, lags)
    rows = [_row(trial) for trial in trials]
    columns = np.array(rows).T
    speed, climb = columns[3], columns[4]
    thrust = np.clip(drag(aeroplane, speed, 1.0) + np.sin(climb), aeroplane.thrust_min, aeroplane.thrust_max)
    zero = np.zeros(len(trials))
    start = Motion(*[*columns, zero, thrust])
    times = np.concatenate([np.arange(0.0, 0.975, 0.05), np.arange(1.0, 2.05, 0.1)])
    directions = Directions(*np.array([trial.direction for trial in trials]).T)
    flown = fly_on(aeroplane, start, directions, times, (0.0, 0.0, 0.0), trials[0].record.plan.speed_mps)
    missed = np.zeros((len(trials), len(LOOKED_AT_S)))
    for k, trial in enumerate(trials):
        time_s, pos = trial.record.columns["time_s"] - trial.from_s, trial.record.columns["own.pos_enu_m"]
        off = [np.interp(LOOKED_AT_S, times, each[:, k]) - np.interp(LOOKED_AT_S, time_s, pos[:, i]) for i, each in enumerate(flown[1:4])]
        missed[k] = np.where(trial.until_s - trial.from_s >= LOOKED_AT_S, np.linalg.norm(off, axis=0), np.nan)
    return missed


def _row(trial: Trial) -> tuple[float, ...]:
    """Where the aircraft is and how it moves when the manoeuvre begins: place, velocity by size, climb and track; bank, roll rate, load."""
    columns = trial.record.columns
    k = int(np.searchsorted(columns["time_s"], trial.from_s - 1e-9))
    velocity: Vec3 = tuple(columns["own.vel_enu_mps"][k])
    flat = math.hypot(velocity[0], velocity[1])
    angles = math.hypot(flat, velocity[2]), math.atan2(velocity[2], flat), math.atan2(velocity[0], velocity[1])
    roll_rate = columns["own.rates_body_radps"][k][0]
    return (*columns["own.pos_enu_m"][k], *angles, columns["own.bank_rad"][k], roll_rate, columns["own.load_factor"][k])


def out_by(aircraft: Aircraft, trials: Sequence[Trial], words: str, lags: Lags | None) -> str:
    """How far predicted places are from flown ones after 1 s and after 2 s, root mean square, in words."""
    missed = _missed(aircraft, _usable(trials), lags)
    rms = [math.sqrt(float(np.nanmean(column**2))) for column in (missed[:, 4], missed[:, -1])]
    return f"{words} {rms[0]:.2f} and {rms[1]:.2f}"


def margin_of(trials: Sequence[Trial]) -> Margin:
    """The margin by time to go. Raises ``IdentifyError`` where no flight tells anything of a range of it."""
    told = np.array([(to_go, clearance - trial.flown_m) for trial in trials for _, to_go, clearance in trial.predictions])
    margins, medians, counts, most = [], [], [], 0.0
    for least, until in zip((0.0, *WITHIN_S), WITHIN_S, strict=False):
        over = told[(told[:, 0] > least) & (told[:, 0] <= until), 1] if len(told) else told
        if len(over) < LEAST_FLIGHTS:
            raise IdentifyError(f"only {len(over)} predictions with {least:g} to {until:g} s to go: give more --encounters")
        most = max(most, float(np.quantile(over, SHARE, method="higher")))
        margins.append(math.ceil(100.0 * most) / 100.0)
        medians.append(round(float(np.median(over)), 2) + 0.0)  # no -0.0
        counts.append(len(over))
    return Margin(flights=len(trials), within_s=WITHIN_S, margin_m=tuple(margins), median_m=tuple(medians), predictions=tuple(counts))


def table(air: AirKind, margin: Margin) -> list[str]:
    """What was found in one kind of air, for people."""
    rows = [f"{AIR_WORDS[air]}: {margin.flights} flights", "  to go up to s   predictions   out by, median m   margin (99 %) m"]
    for until, count, median, most in zip(margin.within_s, margin.predictions, margin.median_m, margin.margin_m, strict=True):
        rows.append(f"  {until:13.1f}   {count:11d}   {median:16.2f}   {most:15.2f}")
    return rows


def as_yaml(found: Prediction) -> str:
    """The file's text."""
    head = (
        "# How this aircraft differs from its prediction, for the planner `survivor` (docs/survivor.md); written by the command below.\n"
        "# margin_m: 99 of 100 predictions were at most so much too good, by time to go up to within_s; median_m: half of them were.\n"
    )
    data: dict[str, Any] = found.model_dump(mode="json")
    yaml, text = YAML(), StringIO()
    yaml.default_flow_style = None
    yaml.width = 130
    yaml.dump(data, text)
    return head + text.getvalue()
