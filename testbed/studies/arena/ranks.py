"""Shares, what they cost, and ranks: by place, by lead, by population, and over all places in which an aircraft flies."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from statistics import fmean

from testbed.results.statistics import NAN, NO_SPREAD, Spread, mcnemar, share_interval, spread
from testbed.studies.arena.best import Best, best
from testbed.studies.arena.flights import CONTROL, Encounter, Flight, Place

OVERALL = "flown"
"""The rung that all places together are in which there is most of flight."""
Scores = dict[Encounter, float]


@dataclass(frozen=True)
class Share:
    """How many flights keep every radius. Flights of one encounter in several places are not independent: its interval counts encounters,
    each with the share of its flights that keep, as Clopper and Pearson do; that is exact in one place and cautious in several.
    """

    encounters: int
    flights: int
    kept: int
    share: float
    low: float
    high: float


@dataclass(frozen=True)
class Cost:
    """What the flights of a share were like: 5th percentile, median and 95th percentile of each quantity."""

    clearance_m: Spread = NO_SPREAD
    deflection_deg: Spread = NO_SPREAD
    extra_path_m: Spread = NO_SPREAD
    load_factor: Spread = NO_SPREAD
    bank_deg: Spread = NO_SPREAD
    roll_rate_dps: Spread = NO_SPREAD


@dataclass(frozen=True)
class Standing:
    """A method in a place at its own best lead. ``only_first``: encounters in which only the first of the place keeps (in which it keeps in
    more places); ``p`` of the exact test of these pairs, ``p_holm`` after Holm for all methods of the place. Rank 0: the control.
    """

    method: str
    shape: str
    place: Place
    even_s: float
    odd_s: float
    share: Share
    cost: Cost
    lost: Mapping[str, int]
    scores: Mapping[Encounter, float] = field(repr=False)
    rank: int = 0
    only_first: int = 0
    only_this: int = 0
    p: float = NAN
    p_holm: float = NAN

    @property
    def behind(self) -> bool:
        """Is it shown to be behind the first?"""
        return self.p_holm < 0.05


@dataclass(frozen=True)
class Judged:
    """An arena: standings by place, each in order of rank; shares at each lead, and by population over the places with aircraft."""

    places: Mapping[Place, Sequence[Standing]]
    overall: Place
    leads: Mapping[Place, Mapping[str, Mapping[float, Share]]]
    populations: Mapping[str, Mapping[str, Share]]
    shapes: Mapping[str, str]


def judge(flights: Sequence[Flight]) -> Judged:
    """All of it. A method keeps the order of the campaign where nothing else decides."""
    cells: dict[Place, dict[str, list[Flight]]] = {}
    for one in flights:
        cells.setdefault(one.place, {}).setdefault(one.method, []).append(one)
    most = max((one.much for one in flights), default=0)
    flown = [place for place, by_method in cells.items() if next(iter(by_method.values()))[0].much == most]
    shapes = {one.method: one.shape for one in flights}
    chosen = {place: {method: best(mine) for method, mine in by_method.items()} for place, by_method in cells.items()}
    idle = _idle(flights)
    places = {place: ranked([_standing(place, method, [of], idle) for method, of in mine.items()]) for place, mine in chosen.items()}
    overall = Place(OVERALL, "")
    in_all = [method for method in shapes if all(method in chosen[place] for place in flown)]
    together = ranked([_standing(overall, method, [chosen[place][method] for place in flown], idle) for method in in_all])
    leads = {place: {method: _by_lead(mine) for method, mine in by_method.items()} for place, by_method in cells.items()}
    populations = {method: _by_population([one for place in flown for one in chosen[place][method].flights]) for method in in_all}
    return Judged({**places, **({overall: together} if together else {})}, overall, leads, populations, shapes)


def _idle(flights: Sequence[Flight]) -> dict[tuple[Place, Encounter], float]:
    """Length (m) of the flight that does nothing, in each place and encounter."""
    return {(one.place, one.encounter): one.length_m for one in flights if one.shape == CONTROL}


def _standing(place: Place, method: str, chosen: Sequence[Best], idle: Mapping[tuple[Place, Encounter], float]) -> Standing:
    flights = [one for of in chosen for one in of.flights]
    extra = [one.length_m - idle.get((one.place, one.encounter), NAN) for one in flights if one.arrived]
    cost = Cost(
        spread(one.clearance_m for one in flights),
        spread(one.deflection_deg for one in flights),
        spread(extra),
        spread(one.load_factor for one in flights),
        spread(one.bank_deg for one in flights),
        spread(one.roll_rate_dps for one in flights),
    )
    even_s, odd_s = (chosen[0].even_s, chosen[0].odd_s) if len(chosen) == 1 else (NAN, NAN)
    lost = Counter(one.lost_by for one in flights if not one.kept)
    return Standing(method, flights[0].shape, place, even_s, odd_s, share_of(flights), cost, dict(lost.most_common()), scores(flights))


def scores(flights: Sequence[Flight]) -> Scores:
    """Share of the flights of each encounter that kept every radius."""
    found: dict[Encounter, list[bool]] = {}
    for one in flights:
        found.setdefault(one.encounter, []).append(one.kept)
    return {encounter: fmean(kept) for encounter, kept in found.items()}


def share_of(flights: Sequence[Flight]) -> Share:
    """How many of them keep."""
    of = scores(flights)
    kept, n = sum(one.kept for one in flights), len(flights)
    return Share(len(of), n, kept, kept / n if n else NAN, *share_interval(sum(of.values()), len(of)))


def ranked(standings: Sequence[Standing]) -> list[Standing]:
    """In order of their shares; of equal ones, which have the same rank, the one with the shorter way first. The control comes last.

    Each is tested against the first, encounter by encounter: the exact test of signs, which in one place is McNemar's.
    """
    control = [one for one in standings if one.shape == CONTROL]
    racing = [one for one in standings if one.shape != CONTROL]
    racing.sort(key=lambda one: (-one.share.share, math.inf if math.isnan(way := one.cost.extra_path_m.median) else way))
    if not racing:
        return control
    first, found = racing[0], []
    for one in racing:
        pairs = [(first.scores[encounter], score) for encounter, score in one.scores.items() if encounter in first.scores]
        only_first, only_this = sum(a > b for a, b in pairs), sum(b > a for a, b in pairs)
        rank = 1 + sum(other.share.share > one.share.share for other in racing)
        tested = NAN if one is first else mcnemar(only_first, only_this)
        found.append(replace(one, rank=rank, only_first=only_first, only_this=only_this, p=tested))
    adjusted = holm([one.p for one in found[1:]])
    return [found[0], *(replace(one, p_holm=p) for one, p in zip(found[1:], adjusted, strict=True)), *control]


def holm(p: Sequence[float]) -> list[float]:
    """p-values of several tests after Holm (Scandinavian Journal of Statistics 6, 1979): below a level, all of them hold at that level."""
    order = sorted(range(len(p)), key=lambda k: p[k])
    found, most = [NAN] * len(p), 0.0
    for place, k in enumerate(order):
        most = max(most, min(1.0, (len(p) - place) * p[k]))
        found[k] = most
    return found


def _by_lead(flights: Sequence[Flight]) -> dict[float, Share]:
    return {lead: share_of([one for one in flights if one.lead_s == lead]) for lead in sorted({one.lead_s for one in flights})}


def _by_population(flights: Sequence[Flight]) -> dict[str, Share]:
    names = dict.fromkeys(one.encounter.population for one in flights)
    return {name: share_of([one for one in flights if one.encounter.population == name]) for name in names}
