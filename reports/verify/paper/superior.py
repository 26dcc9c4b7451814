"""The claim that SCOAM is superior: four criteria and the share that stays safe, against both planes of DROAM."""

from collections.abc import Sequence

from scipy import special

from .comparisons import drawn_pairs, gains
from .flights import SIDES, Figure, Flights, keeps_radius, label, number, route_length
from .intervals import median_bounds
from .words import FLOWN, HOLDS, ON_RAILS, ONLY_IF, OPEN, Judged, settled

LESS_CLEAR: Figure = lambda row: -number(row, "least_clearance_m")  # noqa: E731
CRITERIA: tuple[tuple[Figure, Figure, float], ...] = (  # on rails, flown: larger is worse; margin
    (LESS_CLEAR, LESS_CLEAR, 0.15),
    (lambda row: number(row, "deflection_deg"), lambda row: number(row, "flown_deflection_deg"), 0.05),
    (route_length, route_length, 0.05),
    (lambda row: number(row, "max_load_factor"), lambda row: number(row, "max_load_factor"), 0.05),
)


def judge_superior(flights: Flights) -> Judged:
    """SCOAM against both planes of DROAM on the population, then the draws: its clearance against the better plane."""
    margin = CRITERIA[0][2]
    draws = drawn_pairs(flights, LESS_CLEAR, LESS_CLEAR, "multi_o2_up")
    said = {n: ON_RAILS if rails < -margin else HOLDS if air >= -margin else FLOWN for n, (rails, air) in draws.items()}
    return settled(_superior_word(flights), said)


def _superior_word(flights: Flights) -> str:
    rails, air = (_standing(flights, rung) for rung in ("kinematic", "jsbsim"))
    if not flights.pick(part="population", method="scoam"):
        return OPEN
    better = [k for k, one in enumerate(rails) if one == "better"]
    if not better:
        return ON_RAILS if "worse" in rails else OPEN
    if not any(air[k] == "better" for k in better):
        return FLOWN
    return ONLY_IF if {"worse", "open"} & {*rails, *air} else HOLDS


def _standing(flights: Flights, rung: str) -> list[str]:
    """Of each criterion on a rung: better, equal, worse or open against both planes together."""
    each = [[_safer(flights, rung, plane), *(_median_stand(flights, rung, plane, *one) for one in CRITERIA)] for plane in SIDES]
    return [_of_both(pair) for pair in zip(*each, strict=True)]


def _of_both(pair: Sequence[str]) -> str:
    if "worse" in pair:
        return "worse"
    if all(one == "better" for one in pair):
        return "better"
    return "equal" if all(one in ("better", "equal") for one in pair) else "open"


def _safer(flights: Flights, rung: str, plane: str) -> str:
    ours: dict[tuple[str, ...], dict[str, bool]] = {}
    for row in flights.pick(part="population", rung=rung, method=("scoam", plane)):
        if flights.is_threat(row):
            ours.setdefault(Flights.place(row), {})[label(row, "method")] = keeps_radius(row)
    pairs = [(one["scoam"], one[plane]) for one in ours.values() if len(one) == 2]
    only_us, only_them = sum(a and not b for a, b in pairs), sum(b and not a for a, b in pairs)
    n = only_us + only_them
    if not n:
        return "equal"
    p = min(1.0, 2.0 * float(special.bdtr(min(only_us, only_them), n, 0.5)))
    return "open" if p >= 0.05 else "better" if only_us > only_them else "worse"


def _median_stand(flights: Flights, rung: str, plane: str, on_rails: Figure, flown: Figure, margin: float) -> str:
    figure = on_rails if rung == "kinematic" else flown
    _, low, high = median_bounds(gains(flights, (plane,), figure, part="population", rung=rung))
    if low > margin:
        return "better"
    if high < -margin:
        return "worse"
    return "equal" if -margin <= low and high <= margin else "open"
