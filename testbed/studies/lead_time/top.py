"""What leads the page of a lead-time study: the answer in one sentence, and one distribution with its medians."""

import math
from collections.abc import Sequence

from markupsafe import Markup

from testbed.show.hero import Hero, Tag
from testbed.show.words import counted, number
from testbed.studies.lead_time.compare import Who, summary
from testbed.studies.lead_time.line import Line
from testbed.studies.lead_time.sentences import answer
from testbed.studies.lead_time.svg_pictures import Curve, Mark, shares, staircase

Groups = dict[Who, list[Line]]
LEGEND = Markup('<li><svg viewBox="0 0 24 8" aria-hidden="true"><line class="line c{}{}" x1="0" y1="4" x2="24" y2="4"/></svg>{}</li>')


def hero(plain: Groups, lines: Sequence[Line]) -> Hero:
    """SCOAM with the largest margin, on the first aircraft: its direction flown at once and through the insertion point."""
    keys = leading(plain)
    if not keys:
        return Hero("No aircraft was searched.", rests(lines))
    longest = plain[keys[0]][0].leads_s[-1]
    curves = [Curve(*staircase([line.found.best_s for line in plain[keys[0]]], longest), "best manoeuvre", 0, dashed=True)]
    curves += [
        Curve(*staircase([line.found.lead_s for line in plain[key]], longest), f"SCOAM, {answer(key.answer)}", k)
        for k, key in enumerate(keys, 1)
    ]
    medians = [(summary(plain[keys[0]]).best.value, 0), *((summary(plain[key]).lead.value, k) for k, key in enumerate(keys, 1))]
    marks = [Mark(value, colour) for value, colour in medians if math.isfinite(value) and value <= longest]
    sizes = [len(plain[key]) for key in keys]
    fewest = f" (of the fewest {min(sizes)})" if len(set(sizes)) > 1 else ""
    title = f"Share of {counted(max(sizes), 'encounter')}{fewest} for which a lead suffices"
    legend = Markup().join(LEGEND.format(curve.colour, " dashed" if curve.dashed else "", curve.name) for curve in curves)
    picture = Markup('<ul class="legend">{}</ul>{}').format(legend, shares(curves, longest, title, "lead, s", marks))
    caption = f"{title}, %: {keys[0].aircraft}, margin {keys[0].swell_m:g} m. Dots: medians, over all encounters."
    tags = tuple(_tag(key, plain[key]) for key in keys)
    return Hero(said(plain, keys), rests(lines), tags, picture, caption)


def _tag(key: Who, lines: list[Line]) -> Tag:
    of = summary(lines)
    tone = "bad" if of.never > of.n / 2 else "warn" if of.never else "good"
    return Tag(f"badge badge-{tone}", f"some lead suffices in {of.n - of.never} of {of.n}", ((answer(key.answer), "leads"),))


def leading(plain: Groups) -> list[Who]:
    """The searches of the picture; the direction at once comes first."""
    most = max((key.swell_m for key in plain if key.aircraft), default=0.0)
    keys = [key for key in plain if key.aircraft and key.swell_m == most and key.method == "scoam"]
    return [key for key in keys if key.aircraft == keys[0].aircraft]


def said(plain: Groups, keys: Sequence[Who]) -> str:
    """One sentence, with how many encounters it is of."""
    of = summary(plain[keys[0]])
    needs = f"a lead of {number(of.lead.value, 2)} s in the median" if math.isfinite(of.lead.value) else "more than any lead that was tried"
    text = f"Flown by {keys[0].aircraft}, {answer(keys[0].answer)}, SCOAM needs {needs} of {of.n} encounters"
    text += f" where the best manoeuvre needs {number(of.best.value, 2)} s" if math.isfinite(of.best.value) else ""
    others = [(answer(key.answer), summary(plain[key])) for key in keys[1:]]
    return text + "".join(f"; {how}, no lead suffices in {one.never} of {one.n}" for how, one in others) + "."


def rests(lines: Sequence[Line]) -> str:
    """How many searches, and of how many encounters."""
    flights = sum(line.found.flights for line in lines)
    encounters = counted(len({line.encounter for line in lines}), "encounter")
    return f"Rests on {len(lines):,} searches of {flights:,} flights, over {encounters}."
