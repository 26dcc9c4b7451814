"""Who wins, where, and why: three sentences, made from the figures."""

from collections import Counter
from collections.abc import Sequence
from statistics import fmean
from typing import Final

from testbed.results.statistics import LEVEL
from testbed.show.words import counted, interval, listed, outcome, percent
from testbed.studies.arena.flights import CONTROL, ENDED, Place
from testbed.studies.arena.picture import title
from testbed.studies.arena.ranks import Judged, Standing

LOST_NAMES: Final = {
    "unnoticed": "no threat was seen",
    "answered": "the answer was too late or too little",
    "hit_another": "another obstacle was in the way out",
    "none": "nothing was done",
    "clear": "the method saw nothing to leave",
    "no_free_direction": "no direction was free",
    "no_insertion_point": "there was no insertion point",
    "no_path": "there was no path",
    "inside": "it was too near already",
    "undefined": "the method's construction did not exist",
}
MOST_NAMED: Final = 3


def lost_name(kind: str) -> str:
    """A way to lose a radius, for people."""
    return f"it {outcome(kind)}" if kind in ENDED else LOST_NAMES.get(kind, kind.replace("_", " "))


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
    """Who is first in how many places, the place in which least is kept, and the hardest and easiest population."""
    places = {place: found for place in judged.places if place != judged.overall and (found := racing(judged, place))}
    firsts = Counter(one.method for found in places.values() for one in found if one.rank == 1)
    order = {one.method: k for k, one in enumerate(racing(judged, judged.overall))}
    best = sorted(firsts, key=lambda method: (-firsts[method], order.get(method, len(order))))
    level = [method for method in best if firsts[method] == firsts[best[0]]]
    most = "everywhere" if firsts[best[0]] == len(places) else f"in {firsts[best[0]]} of {len(places)} places"
    means = {place: fmean(one.share.share for one in found) for place, found in places.items()}
    hard = min(means, key=lambda place: means[place])
    least = f"least is kept in {title(*hard, judged)} ({percent(means[hard])} over all methods)" if len(places) > 1 else ""
    told = f"First, or level with the first, {most}: {_among(level)}"
    return f"{'; '.join(filter(None, (told, least, _hardest(judged))))}."


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
    return f"the hardest encounters are those of {hard} ({percent(least)} over all methods), the easiest those of {easy} ({percent(most)})"


def why(judged: Judged, overall: Sequence[Standing]) -> str:
    """The mean share of each shape, the ways in which most flights are lost, and what the lead does."""
    shapes: dict[str, list[float]] = {}
    for one in overall:
        shapes.setdefault(one.shape, []).append(one.share.share)
    told = [f"{_keep(shape, len(of))} {percent(fmean(of))}" for shape, of in sorted(shapes.items(), key=lambda item: -fmean(item[1]))]
    return f"By shape, in the mean and at their own best leads, {listed(told)}; {_lost(overall)}{_by_lead(judged)}."


def _lost(overall: Sequence[Standing]) -> str:
    lost = sum((Counter(one.lost) for one in overall), Counter[str]())
    if not lost:
        return ""
    most = [f"{count} because {lost_name(kind)}" for kind, count in lost.most_common(2)]
    return f"of {counted(lost.total(), 'lost flight')}, {listed(most)}; "


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
