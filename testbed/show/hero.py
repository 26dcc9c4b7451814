"""The top of a page: the question's answer in one sentence, what it rests on, its badges, and the picture that leads."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Final

from markupsafe import Markup

from testbed.campaign.reading.blocks import resolved_parts, weighted
from testbed.campaign.words.settings import Campaign
from testbed.results.checks import CheckResult
from testbed.results.columns import BY_NAME
from testbed.show import bars, words
from testbed.show.alike import NO_AVOIDANCE, Cells, Share, Who, listed_parts
from testbed.show.gathered import KINEMATIC, Gathered, LedGroup, method

MOST_ROWS = 12  # of the leading picture
LEADING, ASTRAY = BY_NAME["least_clearance_m"], BY_NAME["cross_track_max_m"]


@dataclass(frozen=True)
class Tag:
    """A badge of the strip: its style, its text, and whatever it is said of, with links to where that is."""

    css: str
    text: str
    items: tuple[tuple[str, str], ...] = ()  # text, id of its place


UNWEIGHED: Final = "Shares count every flight once, encounters that are drawn more often than they occur too; risk.csv of daa weighs them."


@dataclass(frozen=True)
class Hero:
    """What stands on top. ``rests``: seeds, encounters and draws; ``notes``: what must be known before the answer is believed."""

    answer: str
    rests: str = ""
    tags: tuple[Tag, ...] = ()
    picture: Markup = field(default_factory=Markup)
    caption: str = ""
    notes: tuple[Markup, ...] = ()


def campaign_hero(campaign: Campaign, of: Gathered, checks: Sequence[CheckResult]) -> Hero:
    """That of a campaign's own page, from its rows alone."""
    if checks:
        picture, caption = _check_picture(checks)
        return Hero(check_answer(checks), rests(campaign, of), _outcomes(of), picture, caption)
    picture, caption = _picture(of)
    notes = (Markup(UNWEIGHED),) if weighted(campaign) else ()
    return Hero(_answer(of), rests(campaign, of), _outcomes(of), picture, caption, notes)


def unfinished(hero: Hero, provenance: Mapping[str, Any], noun: str = "flights") -> Hero:
    """The same, with a note if the run is not finished."""
    flown, planned = (provenance.get(key) for key in ("flights_flown", "flights_planned"))
    if flown is None or planned is None or flown >= planned:
        return hero
    return replace(hero, notes=(Markup("Not finished: {} of {} {}.").format(flown, planned, noun), *hero.notes))


def rests(campaign: Campaign, of: Gathered) -> str:
    """Flights and cells, and how often anything was drawn: seeds of the air, encounters of a population, draws of what is open."""
    most: dict[str, int] = {}
    for name, part in resolved_parts(campaign).items():
        n = of.replicates.get(name, 0) if campaign.parts else max(of.replicates.values(), default=0)
        kind = "encounter" if part.encounters else "draw" if part.draw else "seed"
        n -= kind == "draw"  # the first replicate is as written
        if n > 0 and (n > 1 or kind != "seed"):
            most[kind] = max(n, most.get(kind, 0))
    drawn = [words.counted(most[kind], kind) for kind in ("seed", "encounter", "draw") if kind in most]
    if not drawn and of.n:
        drawn = ["one seed"]
    return f"Rests on {words.counted(of.n, 'flight')} in {words.counted(of.cells_in_all, 'cell')}: {words.listed(drawn)}." if of.n else ""


def check_answer(checks: Sequence[CheckResult]) -> str:
    """What became of a check campaign, in a sentence."""
    missed = [line for line in checks if not line.passed]
    if missed:
        return f"Check missed: {len(missed)} of {words.counted(len(checks), 'line')} out of tolerance."
    used = [line.off / line.tolerance for line in checks if line.tolerance > 0.0]
    most = f"; the nearest to it uses {words.percent(max(used))}" if used else ""
    return f"Check passed: {words.counted(len(checks), 'line')}, each within its tolerance{most}."


def _outcomes(of: Gathered) -> tuple[Tag, ...]:
    """How the flights ended."""
    return tuple(
        Tag(f"badge badge-{words.tone(name)}", f"{of.outcomes[name]} {words.outcome(name)}") for name in words.in_order(of.outcomes)
    )


def _answer(of: Gathered) -> str:
    if not of.n:
        return "No flight was flown."
    if not of.met:
        strayed = [group for by_method in of.astray.values() for group in by_method.values()]
        most = max((x for group in strayed for x in group.leading), default=math.nan)
        far = f"; none was farther from its path than {words.amount(most, 'm', ASTRAY.digits)}" if math.isfinite(most) else ""
        return f"Of {words.counted(of.n, 'flight')}, {words.outcomes(of.outcomes)}{far}."
    flyer = _leading_flyer(of.by_flyer)
    the = "The " if next(iter(of.by_flyer[flyer].values())).first["plant"] == KINEMATIC else ""
    point = next((name for name, groups in of.by_flyer.items() if next(iter(groups.values())).first["plant"] == KINEMATIC), flyer)
    return f"{the}{flyer} keeps every radius in {_compared(of.compared, flyer, point)}."


def _is_of(flyers: Sequence[str], methods: Sequence[str], who: Who) -> bool:
    return who.flyer in flyers and who.method in methods


def _compared(cells: Cells, flyer: str, point: str) -> str:
    """The methods of the flyer, and of the point, counted where each of them was flown. Part for part where there is no such place."""
    methods = cells.names("method", lambda who: who.flyer == flyer)
    if point != flyer:
        of_both = partial(_is_of, (flyer, point), methods)
        both = cells.alike("flyer", "method", which=of_both)
        by_flyer = [{method: share for (who, method), share in both.items() if who == name} for name in (flyer, point)]
        if all(by_flyer):
            return (
                f"{_by_method(by_flyer[0])}; a point that flies its path exactly, in {_by_method(by_flyer[1])}{cells.note(both, of_both)}"
            )
    alone = cells.by_method(lambda who: who.flyer == flyer)
    return listed_parts([f"{_by_method(one.shares)}{f' of part {one.part}' if one.part else ''}{one.note}" for one in alone])


def _leading_flyer(by_flyer: Mapping[str, Mapping[str, LedGroup]]) -> str:
    """Who has most of flight: an aircraft in JSBSim before a point mass, that before the point; of these the one with most flights."""

    def rank(name: str) -> tuple[int, int]:
        groups = by_flyer[name].values()
        plant = str(next(iter(groups)).first["plant"])
        return {KINEMATIC: 0, "point_mass": 1}.get(plant, 2), sum(group.n for group in groups)

    return max(by_flyer, key=rank)


def _by_method(shares: Mapping[str, Share]) -> str:
    """``12 of 40 flights with SCOAM and 0 of 40 without avoidance``; of more than three methods the best and the worst."""
    avoiding = [name for name in shares if name != NO_AVOIDANCE] or list(shares)
    shown = avoiding
    if len(avoiding) > 2:
        ranked = sorted(avoiding, key=lambda name: -shares[name].kept / shares[name].n)
        shown = [ranked[0], ranked[-1]]
    shown = [*shown, *(name for name in shares if name not in avoiding)]
    return words.listed([_kept(name, shares[name]) for name in shown])


def _kept(method: str, share: Share) -> str:
    return f"{share.told('flight')} {'without avoidance' if method == NO_AVOIDANCE else f'with {method}'}"


def _picture(of: Gathered) -> tuple[Markup, str]:
    """Least clearance by who flew and method, or how far flights strayed where there was nothing to avoid."""
    by_flyer, column = (of.by_flyer, LEADING) if of.met else (of.astray, ASTRAY)
    every = [(name, group) for name, by_method in by_flyer.items() for group in by_method.values() if len(group.leading)]
    several = len(by_flyer) > 1
    rows = [
        bars.of_flights(f"{method(group.first)}, {_short(name)}" if several else method(group.first), group.leading)
        for name, group in every
    ]
    picture = bars.intervals(rows[:MOST_ROWS], f"{column.heading}, {column.unit}", shade_below_zero=column is LEADING, digits=column.digits)
    left = f" {len(rows) - MOST_ROWS} more rows are in the table of cells." if len(rows) > MOST_ROWS else ""
    inside = " Shaded: inside the obstacle." if column is LEADING else ""
    spread = " Dot: median; line: 5th to 95th percentile." if any(row.low != row.high for row in rows) else ""
    return picture, f"{words.capital(column.heading)} by method and who flew.{inside}{spread}{left}"


def _short(flyer: str) -> str:
    return flyer.replace(" flown in JSBSim", " in JSBSim").replace("kinematic point", "point")


def _check_picture(checks: Sequence[CheckResult]) -> tuple[Markup, str]:
    """Each line's distance from its truth as a share of what it may be off by."""
    rows = [
        bars.Interval(line.quantity, 0.0, share, share)
        for line in checks
        if line.tolerance > 0.0 and math.isfinite(share := 100.0 * line.off / line.tolerance)
    ]
    rows.sort(key=lambda row: -row.middle)
    picture = bars.intervals(rows[:MOST_ROWS], "off the truth, % of the tolerance", whole=(0.0, 100.0), digits=0)
    if len(rows) > MOST_ROWS:
        return picture, f"How far off the truth, as a share of the tolerance: of {len(rows)} quantities the {MOST_ROWS} that are farthest."
    return picture, "How far each quantity is off the truth, as a share of its tolerance."
