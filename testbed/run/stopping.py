"""When a campaign has flown enough (``stop``): after which batch of replicates every interval that it asks for is narrow enough.

Batches are of whole replicates, all cells alike: of ``every``, and when there are ten of those, of a tenth of what there is, because all
rows so far are read to decide. It is decided by all rows of the batches so far in the order of the plan, and by
nothing else: with any number of workers, in one go or after interruptions, a campaign stops at the same flight.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from testbed.campaign.reading.blocks import weighted
from testbed.campaign.words.daa import SPHERE
from testbed.campaign.words.settings import Campaign
from testbed.results import statistics
from testbed.results.columns import METRICS, WEIGHT, Column, Kind
from testbed.results.daa.columns import as_number, checked, daa_columns
from testbed.results.flight_row import Row, value
from testbed.run.directory import BadInputError
from testbed.run.journal import Index, row_of
from testbed.run.planned import Planned

RATIO = "risk_ratio."


def refuse(campaign: Campaign) -> None:
    """Raise ``BadInputError`` for a column of ``stop`` or ``daa.weight`` that there is not."""
    known = {column.name: column for column in (*METRICS, *daa_columns(campaign.daa))}
    if campaign.study.part.flies and (campaign.stop or campaign.daa):
        asked = "stop" if campaign.stop else "daa"
        raise BadInputError(f"{asked}: the study '{campaign.study.kind}' flies by itself, and its rows have no columns")
    if campaign.stop is not None:
        column = campaign.stop.column
        ratios = [] if campaign.daa is None else [f"{RATIO}{name}" for name in (SPHERE, *campaign.daa.all_volumes)]
        fits = [name for name, one in known.items() if one.kind in (Kind.FLAG, Kind.NUMBER)]
        if column not in (*ratios, *fits):
            what = "; risk_ratio.<volume> goes with a section daa" if column.startswith(RATIO) and not ratios else ""
            raise BadInputError(
                f"stop.column: no column '{column}' of numbers or of true and false{what}; there are: {_few(ratios + fits)}"
            )
    if weighted(campaign):
        known[WEIGHT.name] = WEIGHT
    weight = campaign.daa.weight if campaign.daa else ""
    if weight and not weight.startswith("label.") and (weight not in known or known[weight].kind is not Kind.NUMBER):
        raise BadInputError(f"daa.weight: no column '{weight}' of numbers; an axis of the sweep is 'label.<axis>'")


def _few(names: Sequence[str]) -> str:
    return ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")


def batches(campaign: Campaign, planned: Planned) -> Iterator[np.ndarray]:
    """Numbers in the plan of all flights of the first batch, of the first two, and so on; without a rule, of all at once."""
    if campaign.stop is None:
        yield np.arange(len(planned))
        return
    replicates = np.fromiter((flight["replicate"] for flight in planned.flights), dtype=np.int64, count=len(planned))
    for below in boundaries(campaign.stop.every, int(replicates.max(initial=-1)) + 1):
        yield np.flatnonzero(replicates < below)


def boundaries(every: int, most: int) -> Iterator[int]:
    """How many replicates there are after each batch, the last with all of them."""
    below = every
    while below < most:
        yield below
        below += every * max(1, math.ceil(0.1 * below / every))
    yield most


def enough(campaign: Campaign, planned: Planned, index: Index, which: np.ndarray) -> bool:
    """Whether the intervals are narrow enough by the flights of these numbers, all of which have been flown."""
    stop = campaign.stop
    places = index.places(planned.ids[which])
    if stop is None or (places < 0).any():
        return False
    more = daa_columns(campaign.daa)
    rows = index.lines(places, lambda line: checked(row_of(line), more))
    widths = list(_widths(campaign, rows, {column.name: column for column in (*METRICS, *more)}))
    return bool(widths) and all(width <= stop.width for width in widths)  # NaN, where there is no interval, is not


def _widths(campaign: Campaign, rows: Sequence[Row], known: dict[str, Column]) -> Iterator[float]:
    """Of each interval that has to be narrow."""
    assert campaign.stop is not None
    name = campaign.stop.column
    if name.startswith(RATIO):
        from testbed.results.daa.risk import risk_of

        assert campaign.daa is not None
        ratios = risk_of(rows, campaign.daa, campaign.seed).ratios
        yield from (one.width for one in ratios if one.volume == name.removeprefix(RATIO))
        return
    cells: dict[str, list[Any]] = {}
    for row in rows:
        cells.setdefault(str(row["cell"]), []).append(row.get(name) if known[name].kind is Kind.FLAG else value(row, name))
    for values in cells.values():
        numbers = [number for number in map(as_number, values) if math.isfinite(number)]
        effect = (
            statistics.share(name, int(sum(numbers)), len(numbers))
            if known[name].kind is Kind.FLAG
            else statistics.median(name, known[name].unit, numbers)
        )
        yield effect.high - effect.low


def flights(campaign: Campaign, planned: Planned, index: Index) -> int:
    """How many the run is whole with: all that are planned, or those after which it has enough."""
    if campaign.stop is None:
        return len(planned)
    last = np.zeros(0, dtype=int)  # the flights of the last batch that is complete: it went on after those before
    for which in batches(campaign, planned):
        if (index.places(planned.ids[which]) < 0).any():
            break
        last = which
    return len(last) if len(last) and enough(campaign, planned, index, last) else len(planned)
