"""Every claim of ``verdict.csv`` judged again and compared."""

import math
from collections.abc import Mapping
from pathlib import Path

from ..compare import Difference, apart, said_of, shown
from ..run import BadInputError, Run, read_csv
from .comparisons import COMPARED, judge_comparison
from .flights import Flights
from .printed import READINGS, judge_number
from .promises import PROMISES, judge_promise
from .readings import KEY, compare_readings, judge_reading_of_method
from .superior import judge_superior
from .words import Judged

SIX_DIGITS = 1e-5  # what rounding to six significant digits changes at most, of a figure


def judge(flights: Flights, key: str) -> Judged | None:
    """The word of a claim and what follows with it; None for a claim that is not judged here."""
    if key in PROMISES:
        return judge_promise(flights, key)
    if key in COMPARED:
        return judge_comparison(flights, key)
    if key == "words.superior":
        return judge_superior(flights)
    if key.startswith(KEY):
        return judge_reading_of_method(flights, key)
    if key.startswith(tuple(READINGS)):
        return judge_number(flights, key)
    return None


def compare_claims(run: Run, own: Mapping[str, Mapping[str, float | str]]) -> tuple[int, list[str], list[Difference]]:
    """Claims that agree, those that were not judged, and what does not agree."""
    path = run.path / "verdict.csv"
    claims = read_csv(path)
    flights = flights_of(run, own)
    agreed, skipped, differences = 0, [], []
    for claim in claims:
        try:
            judged = judge(flights, claim["key"])
            found = [] if judged is None else _claim_differences(path, claim, judged)
        except (KeyError, ValueError, TypeError, StopIteration) as problem:
            raise BadInputError(f"{path}: cannot be judged ({type(problem).__name__}: {problem})") from None
        if judged is None:
            skipped.append(claim["key"])
        differences += found
        agreed += judged is not None and not found
    return agreed, skipped, differences


def compare_figures(run: Run, own: Mapping[str, Mapping[str, float | str]]) -> tuple[int, list[Difference]]:
    """Lines of ``readings.csv`` that agree, and what does not agree."""
    path = run.path / "readings.csv"
    try:
        return compare_readings(path, flights_of(run, own))
    except (KeyError, ValueError, TypeError) as problem:
        raise BadInputError(f"{path}: cannot be judged ({type(problem).__name__}: {problem})") from None


def flights_of(run: Run, own: Mapping[str, Mapping[str, float | str]]) -> Flights:
    """The run's rows, with what was computed again in the place of what they say."""
    return Flights([{**run.rows[name], **own.get(name, {})} for name in run.flights if name in run.rows])


def _claim_differences(path: Path, claim: Mapping[str, str], judged: Judged) -> list[Difference]:
    found = [] if claim["word"] == judged.word else [Difference(claim["key"], "word", claim["word"], judged.word, math.inf)]
    for name, value in judged.columns.items():
        said = said_of(path, claim["key"], name, claim[name])
        if apart(said, value) > SIX_DIGITS * max(1.0, abs(value)):
            found.append(Difference(claim["key"], name, shown(said), shown(value), apart(said, value)))
    return found
