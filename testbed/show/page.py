"""The page of a campaign: one HTML file that needs no network, the same bytes for the same rows."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from markupsafe import Markup

from testbed.campaign.words.settings import Campaign
from testbed.flight.record import Outcome
from testbed.results.checks import CheckResult
from testbed.results.columns import METRICS
from testbed.results.daa.columns import daa_columns
from testbed.results.daa.risk import Risk
from testbed.results.flight_row import collided, keeps, value
from testbed.show import campaign_summary
from testbed.show.assets import PageHead, asset, environment, packed_json, plotly
from testbed.show.figures import figure_data
from testbed.show.gathered import Gathered, Row, flyer, gather, method
from testbed.show.hero import campaign_hero, check_answer, unfinished
from testbed.show.histogram import histograms
from testbed.show.over_axis import OverAxes
from testbed.show.over_axis_svg import pictures
from testbed.show.pairs import Alike, Pair, pairs
from testbed.show.player import player, scenes
from testbed.show.risk import risk_part
from testbed.show.shown_columns import DECISION_TERMS, PAIRED, text
from testbed.show.tables import cells_table, decisions_table, flights_table, with_replicate
from testbed.show.words import counted, number

MOST_TRACEBACK = 4_000  # characters, its end
SCRIPTS = ("plot.js", "player_views.js", "player.js", "page.js", "explorer.js", "reading.js")
STYLES = ("page.css", "explorer.css", "player.css", "over_axis.css")
MOST_PAIR_ROWS = 200
CELLS_FROM = 25  # so many flights are better read by cell


SECTIONS: Final = {
    "words": "Words",
    "checks": "Check",
    "pairs": "Pairs",
    "risk": "Detect and avoid",
    "over-axis": "Axes",
    "pictures": "Pictures",
    "cells": "Cells",
    "flights": "Flights",
    "decisions": "Re-plans",
    "glossary": "Glossary",
    "provenance": "Origin",
}
"""Anchors of the ordinary sections, in the order of the page, and what a link to them says."""


def render_page(
    campaign: Campaign,
    rows: Iterable[Row],
    series: Mapping[str, dict[str, Any] | None],
    provenance: dict[str, Any],
    checks: Sequence[CheckResult] = (),
    head: PageHead | None = None,
    files: Sequence[str] = (),
    risk: Risk | None = None,
) -> str:
    """The whole page. ``rows`` as in rows.jsonl, read once; ``series`` by flight id, ``provenance`` whatever should be said of the run,
    ``files`` what stands beside the page and should be linked, ``risk`` what was found of a campaign that asks for detect and avoid.

    With a ``head`` that comes first, and the ordinary parts are folded up below it.
    """
    names = head.names if head else {}
    over = OverAxes()
    alike = Alike(campaign)
    of = gather(_named(row, names) | alike(row) | _of_series(series.get(row["flight_id"])) for row in over.watch(rows))
    axes, listed_axes = of.telling_axes, of.listed_axes
    matched, unmatched = pairs(of)
    several_airs = len({pair.flown["air"] for pair in matched}) > 1
    figures = figure_data(of.pictured, series, axes)
    cells = campaign_summary.cells(of, axes) if of.n >= CELLS_FROM or of.replicated else []
    moving = head.scenes if head and head.scenes else scenes(of.pictured, series, axes)
    over_axis = pictures(over)
    told = campaign_summary.sentences(of, matched, over.sentences()) if of.n else []
    of_risk = risk_part(risk, campaign.daa, [axis for axis in listed_axes if axis in axes])
    if of_risk and of_risk["axes"] and of_risk["axes"]["answer"]:
        told = [of_risk["axes"]["answer"], *told]
    flights = flights_table(of, axes, listed_axes, series)
    shown = {
        "words": told or checks,
        "checks": checks,
        "pairs": matched or unmatched,
        "risk": risk,
        "over-axis": over_axis,
        "pictures": figures["groups"],
        "cells": cells,
        "decisions": of.decisions,
    }
    return (
        environment()
        .get_template("index.html.j2")
        .render(
            campaign=campaign,
            kicker=campaign.name,
            question=campaign.question,
            hero=unfinished((head.hero if head else None) or campaign_hero(campaign, of, checks), provenance),
            files=[*files, *(["recordings/"] if flights.links else [])],
            links=[*(head.nav if head else ()), *_links(shown)],
            page_head=head,
            sentences=([check_answer(checks)] if checks else []) + told,
            cards=campaign_summary.cards(of) if of.n else [],
            checks=[_check(line) for line in checks],
            pairs=[_pair(pair, axes, several_airs) for pair in _listed_pairs(matched)],
            pairs_told=_pairs_told(of, matched, unmatched),
            pairs_met=any(pair.met for pair in matched),
            cells=cells_table(cells, [axis for axis in listed_axes if axis in axes]) if cells else None,
            cells_left_out=of.cells_in_all - len(of.cells),
            histograms=histograms(cells),
            paired=PAIRED,
            glossary=(*METRICS, *(daa_columns(campaign.daa) if risk else ())),
            flights=flights,
            flights_left_out=of.n - len(flights.rows),
            decisions=decisions_table(of, axes) if of.decisions else None,
            decisions_left_out=of.decisions_in_all - len(of.decisions),
            terms=DECISION_TERMS,
            failures=[row | {"traceback": str(row.get("traceback", ""))[-MOST_TRACEBACK:]} for row in of.failures],
            failures_left_out=of.outcomes[Outcome.CRASHED] - len(of.failures),
            provenance=_flattened(provenance),
            has_pictures=bool(figures["groups"]),
            player=player(moving, series),
            over_axis=over_axis,
            risk=of_risk,
            css=_assets(*STYLES, *(["risk.css"] if risk else [])) + (head.css if head else Markup()),
            script=_assets(*SCRIPTS) + (head.script if head else Markup()) + Markup("Plots.run();"),
            figures=packed_json(figures) if figures["groups"] else "",
            plotly=plotly(),
        )
    )


def _links(shown: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Anchors and names of the sections that there are; what is not in ``shown`` is always there."""
    return [(anchor, name) for anchor, name in SECTIONS.items() if shown.get(anchor, True)]


def _assets(*names: str) -> Markup:
    return Markup("").join(map(asset, names))


def _of_series(curves: Mapping[str, Any] | None) -> Row:
    """What the page needs of a flight's curves beside its row."""
    return {key: (curves or {}).get(key) for key in ("encounter", "geometry")}


def _named(row: Row, names: Mapping[str, Mapping[str, str]]) -> Row:
    """The row with the names that people have for its labels."""
    if not names:
        return row
    return row | {"labels": {axis: names.get(axis, {}).get(str(label), label) for axis, label in row["labels"].items()}}


def _sortable(amount: float) -> str:
    return f"{amount:.6g}" if math.isfinite(amount) else ""


def _check(line: CheckResult) -> dict[str, Any]:
    """One line of the table of checks, with the decimals that show a hundredth of the tolerance."""
    digits = max(0, 2 - math.floor(math.log10(line.tolerance))) if line.tolerance > 0.0 else 0
    values = (line.truth, line.measured, line.off, line.tolerance)
    return {
        "quantity": line.quantity,
        "unit": line.unit,
        "passed": line.passed,
        "word": line.word,
        "cells": [{"text": number(amount, digits), "sort": _sortable(amount)} for amount in values],
    }


def _listed_pairs(matched: Sequence[Pair]) -> list[Pair]:
    """Those of the table; of too many the first replicates."""
    if len(matched) <= MOST_PAIR_ROWS:
        return list(matched)
    return sorted(matched, key=lambda pair: int(pair.flown["replicate"]))[:MOST_PAIR_ROWS]


def _pairs_told(of: Gathered, matched: Sequence[Pair], unmatched: int) -> list[str]:
    """What the table of pairs leaves out."""
    told = []
    if unmatched:
        told.append(f"{counted(unmatched, 'flight')} {'has' if unmatched == 1 else 'have'} no point to compare with.")
    if len(matched) > MOST_PAIR_ROWS:
        told.append(f"{len(matched) - MOST_PAIR_ROWS} more pairs are not listed.")
    if of.n > len(of.first):
        told.append(f"Only the first {len(of.first)} flights are paired.")
    return told


def _pair(pair: Pair, axes: Sequence[str], several_airs: bool) -> dict[str, Any]:
    point, flown = (value(row, "least_clearance_m") for row in (pair.kinematic, pair.flown))
    air = pair.flown["air"] if several_airs else ""  # which says of an axis of the air more than its label
    shared = [axis for axis in axes if pair.flown["labels"].get(axis) == pair.kinematic["labels"].get(axis)]
    told = with_replicate(pair.flown, [axis for axis in shared if not (air and axis.startswith("air."))])
    return {
        "circumstances": ", ".join(filter(None, (told, air))) or "the encounter",
        "flyer": flyer(pair.flown),
        "method": method(pair.flown),
        "verdict": pair.verdict,
        "tone": ("good" if keeps(pair.flown) else "bad") if pair.known else "warn",
        "bad": [collided(pair.kinematic), collided(pair.flown), False],
        "clearances": [number(point, 2), number(flown, 2), number(flown - point, 2)],
        "sort": [_sortable(point), _sortable(flown), _sortable(flown - point)],
        "rest": [{"text": text(column, pair.flown), "sort": _sortable(value(pair.flown, column.name))} for column in PAIRED],
    }


def _flattened(provenance: dict[str, Any], before: str = "") -> list[tuple[str, str]]:
    """Nested facts as pairs of name and text, in the order given."""
    pairs: list[tuple[str, str]] = []
    for name, told in provenance.items():
        pairs += _flattened(told, f"{before}{name} ") if isinstance(told, dict) else [(f"{before}{name}", str(told))]
    return pairs
