"""The page of a campaign: one HTML file that needs no network, the same bytes for the same rows."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from markupsafe import Markup

from testbed.campaign.words.settings import Campaign
from testbed.core.frames import direction_deg
from testbed.core.units import DEG
from testbed.flight.record import NEW_PATH, Outcome
from testbed.results.checks import CheckResult
from testbed.results.columns import METRICS
from testbed.results.flight_row import collided, keeps, value
from testbed.show import campaign_summary, words
from testbed.show.assets import PageHead, asset, environment, packed_json, plotly
from testbed.show.figures import figure_data
from testbed.show.flight_summary import level_turn, radius_m
from testbed.show.gathered import MOST_FLIGHT_ROWS, Row, flyer, gather, method
from testbed.show.histogram import histograms
from testbed.show.over_axis import OverAxes
from testbed.show.over_axis_svg import pictures
from testbed.show.player import player, scenes
from testbed.show.shown_columns import DECISION_TERMS, PAIRED, SHOWN_COLUMNS, SUMMARISED, text
from testbed.show.words import number

MOST_TRACEBACK = 4_000  # characters, its end
SCRIPTS = ("plot.js", "player_views.js", "player.js", "page.js")
CELLS_FROM = 25  # so many flights are better read by cell


def render_page(
    campaign: Campaign,
    rows: Iterable[Row],
    series: Mapping[str, dict[str, Any] | None],
    provenance: dict[str, Any],
    checks: Sequence[CheckResult] = (),
    head: PageHead | None = None,
) -> str:
    """The whole page. ``rows`` as in rows.jsonl, read once; ``series`` by flight id, ``provenance`` whatever should be said of the run.

    With a ``head`` that comes first, and the ordinary parts are folded up below it.
    """
    over = OverAxes()
    of = gather(row | {key: (series.get(row["flight_id"]) or {}).get(key) for key in ("encounter", "geometry")} for row in over.watch(rows))
    axes, listed_axes = of.telling_axes, of.listed_axes
    matched = campaign_summary.pairs(of.pictured)
    listed = of.nearest if of.n > MOST_FLIGHT_ROWS else of.first
    figures = figure_data(of.pictured, series, axes)
    cells = campaign_summary.cells(of, axes) if of.n >= CELLS_FROM or of.replicated else []
    has_pictures = bool(figures["groups"])
    answer = campaign_summary.sentences(of, matched, over.sentences()) if of.n else ["No flight was flown."]
    moving = head.scenes if head and head.scenes else scenes(of.pictured, series, axes)
    return (
        environment()
        .get_template("index.html.j2")
        .render(
            campaign=campaign,
            page_head=head,
            axes=[words.axis_heading(axis) for axis in listed_axes],
            sentences=campaign_summary.verdict(checks) + answer,
            cards=campaign_summary.cards(of) if of.n else [],
            checks=[_check(line) for line in checks],
            pairs=[_pair(pair, axes) for pair in matched],
            cells=cells,
            cells_left_out=of.cells_in_all - len(of.cells),
            histograms=histograms(cells),
            summarised=SUMMARISED,
            paired=PAIRED,
            metrics=SHOWN_COLUMNS,
            glossary=METRICS,
            flights=[_flight(row, listed_axes) for row in listed],
            flights_left_out=of.n - len(listed),
            decisions=[_decision(row, event, axes) for row, event in of.decisions],
            decisions_left_out=of.decisions_in_all - len(of.decisions),
            terms=DECISION_TERMS,
            failures=[row | {"traceback": str(row.get("traceback", ""))[-MOST_TRACEBACK:]} for row in of.failures],
            failures_left_out=of.outcomes[Outcome.CRASHED] - len(of.failures),
            provenance=_flattened(provenance),
            has_pictures=has_pictures,
            player=player(moving, series),
            over_axis=pictures(over),
            css=_assets("page.css", "player.css", "over_axis.css") + (head.css if head else Markup()),
            script=_assets(*SCRIPTS) + (head.script if head else Markup()) + Markup("Plots.run();"),
            figures=packed_json(figures) if has_pictures else "",
            plotly=plotly(),
        )
    )


def _assets(*names: str) -> Markup:
    return Markup("").join(map(asset, names))


def _sortable(amount: float) -> str:
    return f"{amount:.6g}" if math.isfinite(amount) else ""


def _flight(row: Row, axes: Sequence[str]) -> dict[str, Any]:
    return {
        "id": row["flight_id"],
        "outcome": row["outcome"],
        "outcome_text": words.outcome(str(row["outcome"])),
        "labels": [str(row["labels"].get(axis, "")) for axis in axes],
        "replicate": row["replicate"],
        "flyer": flyer(row),
        "method": words.method(str(row["method"])),
        "cells": [{"text": text(column, row), "sort": _sortable(value(row, column.name))} for column in SHOWN_COLUMNS],
        "collided": collided(row),
        "message": row["message"],
        "recording": row["recording"],
    }


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


def _pair(pair: campaign_summary.Pair, axes: Sequence[str]) -> dict[str, Any]:
    point, flown = (value(row, "least_clearance_m") for row in (pair.kinematic, pair.flown))
    return {
        "circumstances": campaign_summary.circumstances(
            pair.flown, [a for a in axes if pair.flown["labels"].get(a) == pair.kinematic["labels"].get(a)]
        )
        or "the encounter",
        "flyer": flyer(pair.flown),
        "method": method(pair.flown),
        "verdict": pair.verdict,
        "good": keeps(pair.flown),
        "known": pair.known,
        "bad": [collided(pair.kinematic), collided(pair.flown), False],
        "clearances": [number(point, 2), number(flown, 2), number(flown - point, 2)],
        "sort": [_sortable(point), _sortable(flown), _sortable(flown - point)],
        "rest": [{"text": text(column, pair.flown), "sort": _sortable(value(pair.flown, column.name))} for column in PAIRED],
    }


def _vector(event: Row, key: str) -> tuple[float, float, float]:
    """A vector of an event; NaN for what is missing."""
    x, y, z = (math.nan if part is None else float(part) for part in event.get(key) or (None, None, None))
    return x, y, z


def _decision(row: Row, event: Row, axes: Sequence[str]) -> dict[str, Any]:
    """One line of the table of re-plans."""

    def motion(key: str) -> str:
        vector = _vector(event, key)
        return f"{number(math.hypot(*vector), 1)} ({angles(vector)})"

    def angles(vector: tuple[float, float, float]) -> str:
        return ", ".join(number(angle, 1) for angle in direction_deg(vector))

    def deg(key: str, digits: int = 2) -> str:
        return number(value(event, key) / DEG, digits)

    curvature = value(event, "max_curvature_to_insertion_1pm")
    bank_deg, load = level_turn(math.hypot(*_vector(event, "own_vel_enu_mps")), curvature)
    radius = radius_m(curvature)
    name = method(row) if event["method"] == row["method"] else words.method(str(event["method"]))
    return {
        "circumstances": campaign_summary.circumstances(row, axes) or "the encounter",
        "flyer": flyer(row),
        "method": f"{name} against {event['obstacle']}" if event["obstacle"] else name,
        "decision": words.read_aloud(str(event["decision"])),
        "done": event["decision"] in NEW_PATH,
        "cells": [
            number(value(event, "time_s"), 2),
            motion("own_vel_enu_mps"),
            motion("obstacle_vel_enu_mps"),
            deg("alpha_rad"),
            deg("alpha0_rad"),
            number(value(event, "miss_m"), 1),
            number(value(event, "time_to_cpa_s"), 2),
            f"{deg('cap_azimuth_rad', 1)}, {deg('cap_elevation_rad', 1)}",
            deg("cap_half_angle_rad"),
            angles(_vector(event, "command_enu_mps")),
            deg("deflection_rad"),
            deg("margin_rad"),
            ", ".join(number(x, 1) for x in _vector(event, "insertion_enu_m")),
            number(value(event, "insertion_time_s"), 2),
            "straight" if math.isinf(radius) else number(radius, 0),
            number(bank_deg, 0),
            number(load, 2),
        ],
    }


def _flattened(provenance: dict[str, Any], before: str = "") -> list[tuple[str, str]]:
    """Nested facts as pairs of name and text, in the order given."""
    pairs: list[tuple[str, str]] = []
    for name, told in provenance.items():
        pairs += _flattened(told, f"{before}{name} ") if isinstance(told, dict) else [(f"{before}{name}", str(told))]
    return pairs
