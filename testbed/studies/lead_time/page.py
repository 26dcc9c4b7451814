"""The page of a lead-time study: one HTML file that needs no network and no JavaScript, the same bytes for the same searches."""

import math
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from testbed.show.assets import asset, environment
from testbed.show.hero import unfinished
from testbed.show.words import method as named
from testbed.show.words import number, percent
from testbed.studies.lead_time.compare import Priced, Shares, Summary, Who, flyable, groups, insertion, limits, shares, summary, winds
from testbed.studies.lead_time.lead_distributions import Cost, Estimate
from testbed.studies.lead_time.line import Line, Searches
from testbed.studies.lead_time.sentences import answer, rung, sentences
from testbed.studies.lead_time.svg_pictures import Curve, histogram, staircase
from testbed.studies.lead_time.svg_pictures import shares as share_picture
from testbed.studies.lead_time.top import hero

PICTURED_S = 0.05  # spacing of a logistic curve
Groups = dict[Who, list[Line]]
SECTIONS = (
    ("leads", "Leads", "table"),
    ("distributions", "Distributions", "pictures"),
    ("waste", "Waste", "wastes"),
    ("margin", "Margin", "margins"),
    ("crossing", "Crossing angle", "crossings"),
    ("insertion", "Insertion point", "insertions"),
    ("flyable", "Flyable path", "flyables"),
    ("limits", "Limits", "limits"),
    ("wind", "Wind", "winds"),
    ("turbulence", "Turbulence", "turbulence"),
)
"""Of the page: where it is, its name, and what it has to have."""
WITH_ROWS = ("margins", "crossings")
CROSSINGS_DEG = (0.0, 45.0, 90.0, 135.0, 180.0)


def page_text(study: Searches) -> str:
    """The whole page."""
    lines = study.lines
    by_who = dict(sorted(groups(lines).items(), key=lambda item: _order(item[0])))
    calm = {key: found for key, found in by_who.items() if key.wind_mps == 0.0 and key.turbulence == "none"}
    plain = {key: found for key, found in calm.items() if not key.rung.startswith("point_")}
    bumpy = {key: found for key, found in by_who.items() if key.turbulence != "none"}
    turbulent = {key: shares(found, study.seed, _fine(found)) for key, found in bumpy.items()}
    told: dict[str, Any] = {
        "table": [_row(key, summary(found)) for key, found in plain.items()],
        "pictures": _pictures(plain),
        "wastes": _wastes(plain),
        "margins": _margins(plain),
        "crossings": _crossings(plain),
        "insertions": [_priced(cost, f"{_flyer(key)}, {named(key.method)}, margin {key.swell_m:g} m") for key, cost in insertion(plain)],
        "flyables": [_priced(cost, f"{_flyer(key)}, {named(key.method)}, margin {key.swell_m:g} m") for key, cost in flyable(plain)],
        "limits": [_priced(cost, cost.what) for cost in limits(calm)],
        "winds": [_priced(cost, f"from {key.wind_from_deg:g} deg") for key, cost in winds(by_who)],
        "turbulence": [_turbulent(key, found, by_who[key]) for key, found in turbulent.items()],
    }
    sections = ((anchor, name) for anchor, name, part in SECTIONS if (told[part]["rows"] if part in WITH_ROWS else told[part]))
    return (
        environment(__package__)
        .get_template("lead_time.html.j2")
        .render(
            title=study.question,
            question=study.question,
            kicker="lead time",
            hero=unfinished(hero(plain, lines), study.provenance, "searches"),
            files=["lead_time.csv"],
            sentences=sentences(by_who, calm, plain, turbulent),
            cards=_cards(plain),
            parts=list(Counter(line.study for line in lines).items()),
            longest=f"{max((line.leads_s[-1] for line in lines), default=0.0):g}",
            beaten=_beaten(lines),
            tolerance=f"{min((line.tolerance_s for line in lines), default=0.0):g}",
            links=[*sections, ("words", "Words"), ("definitions", "Definitions"), ("provenance", "Origin")],
            provenance=_provenance(study),
            css=asset("page.css") + asset("lead_time.css", __package__),
            script=asset("reading.js"),
            **told,
        )
        + "\n"
    )


def _beaten(lines: Sequence[Line]) -> str:
    """How often a method does with less than the best of the family."""
    better = [-line.waste_s for line in lines if line.waste_s < -line.tolerance_s]
    much = f", by at most {number(max(better), 2)} s" if better else ""
    return f"{len(better)} of {len(lines)} searches beat it by more than the tolerance{much}"


def _order(key: Who) -> tuple[bool, str, bool, float, float]:
    """Points before aircraft, directions at once before insertion points, small margins and winds first; else as they came."""
    return bool(key.aircraft), key.aircraft, key.answer != "direct", key.swell_m, key.wind_from_deg or 0.0


def _flyer(key: Who) -> str:
    return key.aircraft if key.rung == "jsbsim" else rung(key)


def _briefly(key: Who) -> str:
    """How the direction is applied, for a cell."""
    return {"insertion_point": "insertion point", "direct": "at once", "flyable": "flyable path"}[key.answer]


def seconds(value: float, digits: int = 2) -> str:
    """For a table: a word for what is infinite."""
    return "never" if value == math.inf else number(value, digits)


def _interval(estimate: Estimate, digits: int = 2) -> dict[str, str]:
    ends = ", ".join("\N{INFINITY}" if math.isinf(end) and end > 0 else number(end, digits) for end in (estimate.low, estimate.high))
    return {"value": seconds(estimate.value, digits), "interval": f"[{ends}]" if not math.isnan(estimate.value) else ""}


def _row(key: Who, of: Summary) -> dict[str, Any]:
    figures = [of.lead, of.lead_95, of.best, of.best_95, of.waste]
    return {
        "flyer": _flyer(key),
        "answer": _briefly(key),
        "method": named(key.method),
        "swell": f"{key.swell_m:g}",
        "n": of.n,
        "never": of.never,
        "again": of.again,
        "figures": [_interval(figure) for figure in figures] + [_interval(figure, 0) for figure in (of.range_m, of.range_95_m)],
    }


def _cards(plain: Groups) -> list[dict[str, str]]:
    """The largest margin, the first method, on each aircraft."""
    most = max((key.swell_m for key in plain if key.aircraft), default=0.0)
    keys = [key for key in plain if key.aircraft and key.swell_m == most and key.method == "scoam"]
    made = []
    for key in keys:
        of = summary(plain[key])
        made.append(
            {
                "name": f"{key.aircraft}, {answer(key.answer)}",
                "number": seconds(of.lead.value) + (" s" if math.isfinite(of.lead.value) else ""),
                "note": f"median lead of scoam with a margin of {most:g} m; best manoeuvre {seconds(of.best.value)} s; "
                f"never enough in {of.never} of {of.n}",
            }
        )
    return made


def _pictures(plain: Groups) -> list[dict[str, Any]]:
    """Distribution functions: one picture a flyer and margin, a curve a method and one for the best manoeuvre."""
    pictures = []
    for base in dict.fromkeys(key._replace(method="") for key in plain):
        members = {key.method: found for key, found in plain.items() if key._replace(method="") == base}
        if len(members) < 2:
            continue
        first = next(iter(members.values()))
        longest = first[0].leads_s[-1]
        curves = [Curve(*staircase([line.found.best_s for line in first], longest), "best manoeuvre", 0, dashed=True)]
        curves += [
            Curve(*staircase([line.found.lead_s for line in found], longest), named(method), k)
            for k, (method, found) in enumerate(members.items(), 1)
        ]
        title = f"{_flyer(base)}, {answer(base.answer)}, margin {base.swell_m:g} m"
        pictures.append(
            {
                "title": title,
                "svg": share_picture(curves, longest, f"Distribution of leads: {title}", "lead, s"),
                "legend": [(curve.name, curve.colour, curve.dashed) for curve in curves],
            }
        )
    return pictures


def _wastes(plain: Groups) -> list[dict[str, Any]]:
    """Histograms of the waste of the method of the margin study, at the largest margin."""
    most = max((key.swell_m for key in plain), default=0.0)
    made = []
    for key, found in plain.items():
        if key.method == "scoam" and key.swell_m == most:
            waste = [max(0.0, line.waste_s) for line in found if not math.isnan(line.waste_s)]
            title = f"{_flyer(key)}, {answer(key.answer)}"
            made.append({"title": title, "svg": histogram(waste, found[0].leads_s[-1], f"Waste: {title}", "waste, s")})
    return made


def _margins(plain: Groups) -> dict[str, Any]:
    """Share of the encounters in which some lead suffices, by margin."""
    keys = [key for key in plain if key.method == "scoam"]
    swells = sorted({key.swell_m for key in keys})
    rows = []
    for base in dict.fromkeys(key._replace(swell_m=0.0) for key in keys):
        cells = []
        for swell in swells:
            found = plain.get(base._replace(swell_m=swell))
            of = summary(found) if found else None
            cells.append(f"{of.n - of.never} of {of.n} ({seconds(of.lead.value)})" if of else "")
        rows.append({"flyer": _flyer(base), "answer": _briefly(base), "cells": cells})
    return {"swells": [f"{swell:g} m" for swell in swells], "rows": rows}


def _crossings(plain: Groups) -> dict[str, Any]:
    """Encounters in which some lead suffices, by the angle between the courses."""
    bins = list(pairwise(CROSSINGS_DEG))
    rows = []
    for key, found in plain.items():
        if key.method == "scoam":
            cells = []
            for low, high in bins:
                inside = [line.found.lead_s for line in found if low <= min(line.found.crossing_deg, 179.999) < high]
                cells.append(f"{sum(map(math.isfinite, inside))} of {len(inside)}")
            rows.append({"flyer": _flyer(key), "answer": _briefly(key), "swell": f"{key.swell_m:g}", "cells": cells})
    return {"bins": [f"{low:g} to {high:g} deg" for low, high in bins], "rows": rows}


def _cost(of: Cost) -> dict[str, Any]:
    value = of.difference_s
    text = {math.inf: "all of it", -math.inf: "all gained"}.get(value.value) or number(value.value, 2)
    ends = ", ".join({math.inf: "\N{INFINITY}", -math.inf: "\N{MINUS SIGN}\N{INFINITY}"}.get(end) or number(end, 2) for end in value[1:])
    return {"value": text, "interval": f"[{ends}]" if of.pairs else "", "pairs": of.pairs, "lost": of.lost, "gained": of.gained}


def _priced(of: Priced, what: str) -> dict[str, Any]:
    return {
        "what": what,
        "aircraft": of.aircraft or "point on rails",
        "answer": answer(of.answer),
        "method": _cost(of.method),
        "best": _cost(of.best),
    }


def _fine(lines: Sequence[Line]) -> np.ndarray:
    return np.arange(0.0, lines[0].leads_s[-1] + 0.5 * PICTURED_S, PICTURED_S)


def _turbulent(key: Who, of: Shares, lines: Sequence[Line]) -> dict[str, Any]:
    fine = _fine(lines)
    curves = [
        Curve(of.leads_s, [kept / of.n for kept in of.kept], "flights", 1),
        Curve(fine.tolist(), of.curve, "logistic curve", 2, dashed=True),
        Curve(*staircase([line.found.best_s for line in lines], of.leads_s[-1]), "best manoeuvre in calm air", 0, dashed=True),
    ]
    curves = [curve for curve in curves if all(math.isfinite(y) for y in curve.y)]
    title = f"{_flyer(key)}, {answer(key.answer)}, {key.turbulence} turbulence, margin {key.swell_m:g} m"
    return {
        "title": title,
        "svg": share_picture(curves, of.leads_s[-1], f"Share that keeps the radius: {title}", "lead, s"),
        "legend": [(curve.name, curve.colour, curve.dashed) for curve in curves],
        "rows": [
            (f"{lead:g}", f"{kept} of {of.n}", percent(kept / of.n), percent(bound))
            for lead, kept, bound in zip(of.leads_s, of.kept, of.bounds, strict=True)
        ],
        "reaches": [
            (of_them, _reached(estimate, of.leads_s[-1])) for of_them, estimate in (("50", of.half), ("95", of.most), ("99", of.curve_99))
        ],
        "shown": f"from a lead of {of.shown_from_s:g} s on" if math.isfinite(of.shown_from_s) else "at no lead: not shown",
    }


def _reached(estimate: Estimate, longest: float) -> str:
    """Where a curve reaches a share; beyond the flights it says nothing."""
    if math.isnan(estimate.value):
        return "at no lead"
    if estimate.value > longest:
        return f"not within the {longest:g} s that were flown"
    shown = _interval(estimate)
    return f"at {shown['value']} s {shown['interval']}"


def _provenance(study: Searches) -> list[tuple[str, str]]:
    said = study.provenance
    flown = f"seed {study.seed}, {said['flights_flown']} of {said['flights_planned']} searches, plan {said['plan_hash']}"
    versions = ", ".join(f"{name} {version}" for name, version in said["versions"].items())
    hashes = [(f"{name}/aircraft.yaml", kinds["aircraft.yaml"][:16]) for name, kinds in sorted(said["aircraft"].items())]
    return [("plan", flown), ("code", str(said["code_hash"])), ("versions", versions), *hashes]
