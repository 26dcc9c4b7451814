"""What a run stores of each flight: recordings, raw columns, curves for the page. It follows from the whole plan alone."""

from collections.abc import Collection, Iterator, Mapping
from itertools import chain, islice, zip_longest

import numpy as np

from testbed.campaign.reading.blocks import resolved_parts
from testbed.campaign.reading.expand import axes_in_order
from testbed.campaign.words.grid import PART
from testbed.campaign.words.settings import Campaign
from testbed.run.directory import RunDirectory
from testbed.run.job import Job
from testbed.run.planned import MOST_FIRSTS, Planned
from testbed.run.world import World
from testbed.studies.study import Study

SERIES = MOST_FIRSTS
"""Flights whose time series are stored for the page: first replicates in plan order, one of each part in turn."""


def jobs(directory: RunDirectory, campaign: Campaign, planned: Planned, world: World, which: np.ndarray) -> Iterator[Job]:
    """A job for each plan of these numbers, in their order, made when it is asked for. A plan's file has labels in alphabetical order, the
    row of a flight has them in that of the axes.
    """
    parts, axes = resolved_parts(campaign), axes_in_order(campaign)
    pictured = _pictured(campaign, planned)
    with_series = _series_stored(planned, pictured)
    recordings, columns = directory.recordings.resolve(), directory.columns.resolve()
    for plan in planned.some(which):
        name = _part(campaign, plan.labels)
        part = parts[name]
        recorded = plan.flight_id in pictured if pictured and part.recordings == "selected" else is_stored(plan.replicate, part.recordings)
        yield Job(
            plan.model_copy(update={"labels": {axis: plan.labels[axis] for axis in axes[name]}}),
            recordings / f"{plan.flight_id}.rrd" if recorded else None,
            plan.flight_id in with_series,
            campaign.check,
            columns / f"{plan.flight_id}.parquet" if is_stored(plan.replicate, part.columns) else None,
            world,
            campaign.daa,
        )


def _part(campaign: Campaign, labels: Mapping[str, str]) -> str:
    """The part that a flight belongs to; without parts an empty name."""
    return labels[PART] if campaign.parts else ""


def is_stored(replicate: int, how: str | None) -> bool:
    """Whether something is kept of a replicate, by what the campaign says of keeping it."""
    return how == "all" or (how == "selected" and replicate == 0)


def _pictured(campaign: Campaign, planned: Planned) -> dict[str, None]:
    """The flights in the pictures of the study: of these alone it stores recordings, unless it is to store all or none."""
    study = campaign.study.made()
    if type(study).pictures is Study.pictures:
        return {}
    return {plan.flight_id: None for plan in planned.plans if study.pictures(plan)}


def _series_stored(planned: Planned, pictured: Collection[str]) -> set[str]:
    """The flights that a study pictures, and then fairly: no part goes without because one before it has many cells."""
    in_turn = (flight_id for turn in zip_longest(*planned.firsts.values()) for flight_id in turn if flight_id is not None)
    return set(islice(chain(pictured, in_turn), max(SERIES, len(pictured))))
