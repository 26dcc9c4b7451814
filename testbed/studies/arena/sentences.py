"""Who wins, where, and why: three sentences, made from the figures."""

from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import fmean
from typing import Final

from testbed.results.statistics import LEVEL
from testbed.show.words import counted, interval, listed, outcome, percent
from testbed.studies.arena.flights import CONTROL, ENDED, Place
from testbed.studies.arena.ranks import Judged, Standing

LOST_NAMES: Final = {
    "unnoticed": "no threat was seen in time",
    "answered": "answered, and hit all the same",
    "hit_another": "hit another obstacle on the way out",
    "none": "the method had nothing to do",
    "clear": "the method saw nothing to leave",
    "no_free_direction": "no direction was free",
    "no_insertion_point": "no insertion point",
    "no_path": "no path",
    "inside": "too near already",
    "undefined": "the construction does not exist",
}
MOST_NAMED: Final = 3


def lost_name(kind: str) -> str:
    """A way to lose a radius, for people."""
    return outcome(kind) if kind in ENDED else LOST_NAMES.get(kind, kind.replace("_", " "))


def racing(judged: Judged, place: Place) -> list[Standing]:
    """Who competes in a place, in order of rank."""
    return [one for one in judged.places.get(place, ()) if one.shape != CONTROL]


def said(judged: Judged) -> tuple[str, ...]:
    """The three sentences; fewer where there is nothing to say."""
    overall = racing(judged, judged.overall)
    return tuple(filter(None, (who(overall), where(judged), why(judged, overall)))) if overall else ("Nothing has been flown yet.",)


def who(overall: Sequence[Standing]) -> str:
    """The first over all places with most of flight, and whom the test of pairs tells from it."""
    first, share = overall[0], overall[0].share
    level = [one.method for one in overall[1:] if one.share.share == share.share]
    told = f"{_among([first.method, *level])} {'share the first place' if level else 'comes first'}"
    behind = sum(one.behind for one in overall)
    others = (
        f"of the {len(overall) - 1} others {behind or 'none'} {'are' if behind > 1 else 'is'} shown to be behind" if overall[1:] else ""
    )
    return (
        f"Over all that is flown, {told}: every radius is kept in {share.kept} of {counted(share.flights, 'flight')} "
        f"({percent(share.share)}, {100 * LEVEL:.0f} % interval {interval(share.low, share.high, 'share')}, "
        f"{counted(share.encounters, 'encounter')}){f'; {others}' if others else ''}."
    )


def where(judged: Judged) -> str:
    """Who is first in which places, and the hardest and easiest population."""
    order = [one.method for one in racing(judged, judged.overall)]
    firsts: dict[tuple[str, ...], dict[Place, float]] = {}
    for place in judged.places:
        found = racing(judged, place)
        if place != judged.overall and found:
            level = [one.method for one in found if one.rank == 1]
            level.sort(key=lambda method: order.index(method) if method in order else len(order))
            firsts.setdefault(tuple(level), {})[place] = found[0].share.share
    told = [f"{_among(level)} {_in_places(places, judged)}" for level, places in sorted(firsts.items(), key=lambda item: -len(item[1]))]
    return f"First by place: {'; '.join(told)}{_hardest(judged)}."


def _in_places(shares: Mapping[Place, float], judged: Judged) -> str:
    """``in calm (gtm_t2 92 %, c172p 83 %) and rails (100 %)``; of all of them ``everywhere``."""
    if len(shares) > 1 and len(shares) == len([place for place in judged.places if place != judged.overall]):
        return f"everywhere ({interval(min(shares.values()), max(shares.values()), 'share')})"
    several = {place.rung for place in judged.leads if len({other.flown_by for other in judged.leads if other.rung == place.rung}) > 1}
    by_rung: dict[str, list[str]] = {}
    for place, share in shares.items():
        by_rung.setdefault(place.rung, []).append(f"{place.flown_by} {percent(share)}" if place.rung in several else percent(share))
    told = [f"{rung.replace('_', ' ')} ({', '.join(who)})" for rung, who in by_rung.items()]
    return f"in {listed(told)}"


def _hardest(judged: Judged) -> str:
    shares: dict[str, list[float]] = {}
    for method, by_population in judged.populations.items():
        if judged.shapes[method] != CONTROL:
            for name, share in by_population.items():
                shares.setdefault(name, []).append(share.share)
    means = sorted((fmean(of), name.replace("_", " ")) for name, of in shares.items())
    if len(means) < 2:
        return ""
    (least, hard), (most, easy) = means[0], means[-1]
    return f"; of the encounters {hard} are the hardest ({percent(least)} over all methods) and {easy} the easiest ({percent(most)})"


def why(judged: Judged, overall: Sequence[Standing]) -> str:
    """By shape, with the way in which most of its flights are lost, and by lead."""
    shapes: dict[str, list[Standing]] = {}
    for one in overall:
        shapes.setdefault(one.shape, []).append(one)
    told = []
    for shape, of in sorted(shapes.items(), key=lambda item: -fmean(one.share.share for one in item[1])):
        lost = sum((Counter(one.lost) for one in of), Counter[str]())
        told.append(f"{_keep(shape, len(of))} {percent(fmean(one.share.share for one in of))}{_mostly(lost)}")
    return f"By shape, at their own best leads, {'; '.join(told)}; {_by_lead(judged)}."


def _mostly(lost: Counter[str]) -> str:
    if not lost:
        return ""
    ((kind, count),) = lost.most_common(1)
    return f" (of {counted(lost.total(), 'lost flight')}, {count}: {lost_name(kind)})"


def _keep(shape: str, n: int) -> str:
    return f"the {shape} keeps" if n == 1 else f"the {n} {shape}s keep"


def _by_lead(judged: Judged) -> str:
    """The mean share over methods and places at the shortest and at the longest lead."""
    by_lead: dict[float, list[float]] = {}
    for by_method in judged.leads.values():
        for method, of in by_method.items():
            if judged.shapes[method] != CONTROL:
                for lead, share in of.items():
                    by_lead.setdefault(lead, []).append(share.share)
    ends = sorted(by_lead)
    told = [f"{percent(fmean(by_lead[lead]))} at a lead of {lead:g} s" for lead in dict.fromkeys((ends[0], ends[-1]))]
    return f"over all methods and places {listed(told)}"


def _among(methods: Sequence[str]) -> str:
    """``a``, ``a and b``; of many the first and how many more."""
    if len(methods) <= MOST_NAMED:
        return listed(methods)
    return f"{', '.join(methods[: MOST_NAMED - 1])} and {len(methods) - MOST_NAMED + 1} more"
