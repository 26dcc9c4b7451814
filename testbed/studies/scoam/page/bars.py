"""Pictures of the verdict that are static SVG: waterfalls and rankings, readable without JavaScript, in the dark and on paper."""

import math
from collections.abc import Sequence

from markupsafe import Markup, escape

from testbed.show import words
from testbed.show.bars import ROW, TOP, Interval, Scale, frame, intervals, row_name
from testbed.show.words import named, number
from testbed.studies.scoam.claim import Claim, Rank, Waterfall
from testbed.studies.scoam.page import paper_names
from testbed.studies.scoam.page.paper_names import METHOD_NAMES, STEP_NAMES


def waterfall_svg(fall: Waterfall) -> Markup:
    """One row a rung: a bar from the clearance that the step starts from to its own. Left of zero is inside the obstacle."""
    steps = [step for step in fall.steps if math.isfinite(step.clearance_m)]
    if not steps:
        return Markup("")
    names = [named(STEP_NAMES, step.rung) for step in steps]
    scale = Scale([0.0, *(step.clearance_m for step in steps)], names)
    parts = frame(scale, len(steps), "least clearance, m", 0.0)
    for k, (name, step) in enumerate(zip(names, steps, strict=True)):
        y = TOP + k * ROW
        known = math.isfinite(step.change_m)
        x0, x1 = scale(step.clearance_m - step.change_m if known else 0.0), scale(step.clearance_m)
        css = "start" if not known else "lost" if step.change_m < 0.0 else "won"
        title = f"{name}: {words.amount(step.clearance_m, 'm')}" + (f", change {paper_names.signed(step.change_m)}" if known else "")
        parts.append(row_name(scale, y, name))
        parts.append(
            f'<g class="{css}"><title>{escape(title)}</title><rect x="{min(x0, x1):.1f}" y="{y + 5}" width="{max(abs(x1 - x0), 1.5):.1f}" '
            f'height="{ROW - 10}"/><line x1="{x1:.1f}" x2="{x1:.1f}" y1="{y + 2}" y2="{y + ROW - 2}"/></g>'
        )
        parts.append(
            f'<text class="value" x="{max(x0, x1) + 6:.1f}" y="{y + ROW / 2 + 4:.1f}">{escape(number(step.clearance_m, 1))}</text>'
        )
    return Markup("".join([*parts, "</svg>"]))


def share_svg(ranks: Sequence[Rank]) -> Markup:
    """Share of the population in which each method keeps the radius, with its interval."""
    rows = [
        Interval(named(METHOD_NAMES, rank.method), 100 * rank.safe_low, 100 * rank.safe / rank.n, 100 * rank.safe_high)
        for rank in ranks
        if rank.n
    ]
    return intervals(rows, "encounters that keep the radius, % (95 % interval)", whole=(0.0, 100.0))


def clearance_svg(ranks: Sequence[Rank]) -> Markup:
    """Median of the clearance of each method on the population, from the 5th to the 95th percentile."""
    rows = [
        Interval(named(METHOD_NAMES, rank.method), rank.clearance.p05, rank.clearance.median, rank.clearance.p95)
        for rank in ranks
        if rank.n
    ]
    return intervals(rows, "least clearance, m (5 %, median, 95 %)", shade_below_zero=True)


def claim_svg(claim: Claim) -> Markup:
    """A claim's figures below each other: on each rung in calm air, and where most flights in wind and turbulence lie."""
    air, printed = claim.flown_air, paper_names.number_of(claim.paper)
    rows = [
        Interval(name, x, x, x)
        for name, x in (("on rails", claim.kinematic), ("point mass", claim.point_mass), ("flown, calm", claim.flown_calm))
    ]
    rows.append(Interval("in wind and turbulence", air.p05, air.median, air.p95, note=f", n = {air.n}"))
    if sum(math.isfinite(row.middle) for row in rows) < 2:
        return Markup("")
    level = (printed, f"printed: {claim.paper}") if math.isfinite(printed) else LEVELS.get(claim.unit, (0.0, ""))
    quantity = claim.quantity if len(claim.quantity) <= LONG else ""  # it stands beside the picture
    label = ", ".join(filter(None, (quantity, words.SHOWN_UNITS.get(claim.unit, claim.unit))))
    label += f" (dashed: {level[1]})" if level[1] else ""
    inside = claim.quantity == "least clearance"
    digits = max(paper_names.decimals(claim.paper), words.UNIT_DIGITS.get(claim.unit, 2))
    return intervals(rows, label, (level[0],), shade_below_zero=inside, digits=digits, line=level)


LEVELS = {"times the limit": (1.0, "the limit")}
"""With what the figures of a claim in words are compared, by their unit; zero otherwise."""
LONG = 44  # letters that fit below a picture
