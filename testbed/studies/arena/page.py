"""The page of an arena: one HTML file that needs no network, the same bytes for the same rows."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from testbed.campaign.words.settings import Campaign
from testbed.results.statistics import Spread
from testbed.show.assets import asset, environment
from testbed.show.hero import Hero, Tag, unfinished
from testbed.show.words import counted, interval, number, percent
from testbed.studies.arena.flights import CONTROL, Flight, Place
from testbed.studies.arena.picture import picture, title
from testbed.studies.arena.ranks import Judged, Share, Standing
from testbed.studies.arena.sentences import lost_name, racing, said

KEEPS, FAILS = 0.9, 0.5  # shares that are coloured as good, and as bad
CAPTION = (
    "Flights that keep every radius, %, by how long before the closest approach a threat may be answered. One line a method; "
    "coloured: the best of each shape over all that is flown, side by side where they coincide. Point at a line for its name."
)


def page_text(campaign: Campaign, flights: Sequence[Flight], judged: Judged, provenance: Mapping[str, Any]) -> str:
    """The whole page."""
    hero = Hero(" ".join(said(judged)), rests(flights), _tags(judged), picture(judged), CAPTION)
    order = list(dict.fromkeys(one.method for place in (judged.overall, *judged.places) for one in judged.places.get(place, ())))
    places = [place for place in judged.places if place != judged.overall]
    told: dict[str, Any] = {
        "matrix": {"places": [title(*place, judged) for place in places], "rows": [_matrix_row(m, places, judged) for m in order]},
        "overall": [_row(one) for one in judged.places.get(judged.overall, ())],
        "populations": _populations(judged, order),
        "by_place": [{"name": title(*place, judged), "rows": [_row(one) for one in judged.places[place]]} for place in places],
    }
    return (
        environment(__package__)
        .get_template("arena.html.j2")
        .render(
            question=campaign.question,
            kicker="arena",
            hero=unfinished(hero, provenance),
            files=["arena.csv", "arena_timings.csv"],
            links=[("places", "Places"), ("costs", "What it costs"), ("populations", "Encounters"), ("each", "Place by place"),
                   ("fair", "How it is kept fair"), ("provenance", "Origin")],
            leads=", ".join(f"{lead:g}" for lead in sorted({one.lead_s for one in flights})),
            halved=len({one.encounter.replicate % 2 for one in flights}) > 1,
            provenance=_provenance(campaign, provenance),
            css=asset("page.css") + asset("arena.css", __package__),
            script=asset("reading.js"),
            **told,
        )
        + "\n"
    )  # fmt: skip


def rests(flights: Sequence[Flight]) -> str:
    """How many flights, of whom, where, in how many encounters."""
    methods = counted(len({one.method for one in flights if one.shape != CONTROL}), "method")
    places, leads = counted(len({one.place for one in flights}), "place"), counted(len({one.lead_s for one in flights}), "lead")
    encounters = counted(len({one.encounter for one in flights}), "encounter")
    return f"Rests on {len(flights):,} flights: {methods}, {places}, {leads}, {encounters}."


def _tags(judged: Judged) -> tuple[Tag, ...]:
    return tuple(
        Tag(f"badge badge-{tone(one.share.share)}", f"{one.share.kept} of {one.share.flights} kept", ((one.method, "costs"),))
        for one in racing(judged, judged.overall)[:3]
    )


def tone(share: float) -> str:
    """How a share is coloured."""
    return "good" if share >= KEEPS else "bad" if share < FAILS else "warn"


def _cell(share: Share | None) -> dict[str, str]:
    if share is None:
        return {"text": "", "tone": "", "of": ""}
    bounds = interval(share.low, share.high, "share")
    return {"text": percent(share.share), "tone": tone(share.share), "of": f"{share.kept} of {share.flights}, {bounds}"}


def _matrix_row(method: str, places: Sequence[Place], judged: Judged) -> dict[str, Any]:
    found = {place: {one.method: one for one in judged.places[place]} for place in (judged.overall, *places)}
    standings = [found[place].get(method) for place in (judged.overall, *places)]
    cells = [_cell(one.share if one else None) | {"rank": _rank(one) if one else ""} for one in standings]
    return {"method": method, "shape": judged.shapes[method], "cells": cells}


def _rank(one: Standing) -> str:
    return "" if one.shape == CONTROL else str(one.rank)


def _row(one: Standing) -> dict[str, Any]:
    """A line of a table of costs."""
    cost = one.cost
    leads = dict.fromkeys(f"{lead:g}" for lead in (one.even_s, one.odd_s) if not math.isnan(lead))
    figures = [
        (cost.deflection_deg, 1), (cost.extra_path_m, 1), (cost.load_factor, 2), (cost.bank_deg, 0), (cost.roll_rate_dps, 0),
    ]  # fmt: skip
    return {
        "rank": _rank(one) or "control",
        "method": one.method,
        "shape": one.shape,
        "leads": " / ".join(leads),
        "share": _cell(one.share),
        "clearance": _spread(cost.clearance_m, 1),
        "figures": [number(of.median, digits) for of, digits in figures],
        "pairs": "" if math.isnan(one.p) else f"{one.only_first} : {one.only_this}",
        "p": "" if math.isnan(one.p_holm) else number(one.p_holm, 3),
        "behind": one.behind,
        "lost": ", ".join(f"{lost_name(kind)} {count}" for kind, count in one.lost.items()),
    }


def _spread(of: Spread, digits: int) -> dict[str, str]:
    return {"median": number(of.median, digits), "ends": f"{number(of.p05, digits)} to {number(of.p95, digits)}"}


def _populations(judged: Judged, order: Sequence[str]) -> dict[str, Any]:
    names = list(dict.fromkeys(name for of in judged.populations.values() for name in of))
    rows = [
        {"method": method, "shape": judged.shapes[method], "cells": [_cell(judged.populations[method].get(name)) for name in names]}
        for method in order
        if method in judged.populations
    ]
    return {"names": [name.replace("_", " ") for name in names], "rows": rows}


def _provenance(campaign: Campaign, said_of: Mapping[str, Any]) -> list[tuple[str, str]]:
    flown = f"seed {campaign.seed}, {said_of['flights_flown']} of {said_of['flights_planned']} flights, plan {said_of['plan_hash']}"
    versions = ", ".join(f"{name} {version}" for name, version in said_of["versions"].items())
    hashes = [(f"{name}/aircraft.yaml", kinds["aircraft.yaml"][:16]) for name, kinds in sorted(said_of["aircraft"].items())]
    return [("plan", flown), ("code", str(said_of["code_hash"])), ("versions", versions), *hashes]
