"""What a run stores of each flight: recordings, raw columns, curves for the page. It follows from the whole plan alone."""

from collections.abc import Iterator, Sequence
from itertools import chain, islice, zip_longest

from testbed.campaign.reading.blocks import resolved_parts
from testbed.campaign.words.grid import PART
from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.run.directory import RunDirectory
from testbed.run.job import Job
from testbed.run.world import World

SERIES = 64
"""Flights whose time series are stored for the page: first replicates in plan order, one of each part in turn."""


def jobs(directory: RunDirectory, campaign: Campaign, plans: Sequence[FlightPlan], world: World) -> list[Job]:
    """One job a plan, in plan order."""
    parts = resolved_parts(campaign)
    pictured = _pictured(campaign, plans)
    with_series = _series_stored(campaign, plans, pictured)
    recordings, columns = directory.recordings.resolve(), directory.columns.resolve()
    made = []
    for plan in plans:
        part = parts[_part(campaign, plan)]
        recorded = plan.flight_id in pictured if pictured and part.recordings == "selected" else _is_stored(plan, part.recordings)
        made.append(
            Job(
                plan,
                recordings / f"{plan.flight_id}.rrd" if recorded else None,
                plan.flight_id in with_series,
                campaign.check,
                columns / f"{plan.flight_id}.parquet" if _is_stored(plan, part.columns) else None,
                world,
            )
        )
    return made


def _part(campaign: Campaign, plan: FlightPlan) -> str:
    """The part that a flight belongs to; without parts an empty name."""
    return plan.labels[PART] if campaign.parts else ""


def _is_stored(plan: FlightPlan, how: str | None) -> bool:
    return how == "all" or (how == "selected" and plan.replicate == 0)


def _pictured(campaign: Campaign, plans: Sequence[FlightPlan]) -> tuple[str, ...]:
    """The flights in the pictures of the study: of these alone it stores recordings, unless it is to store all or none."""
    study = campaign.study.made()
    return tuple(plan.flight_id for plan in plans if study.pictures(plan))


def _series_stored(campaign: Campaign, plans: Sequence[FlightPlan], pictured: Sequence[str]) -> set[str]:
    """The flights that a study pictures, and then fairly: no part goes without because one before it has many cells."""
    return set(islice(chain(pictured, _in_turn(campaign, plans)), max(SERIES, len(pictured))))


def _in_turn(campaign: Campaign, plans: Sequence[FlightPlan]) -> Iterator[str]:
    turns: dict[str, list[str]] = {}
    for plan in plans:
        if plan.replicate == 0:
            turns.setdefault(_part(campaign, plan), []).append(plan.flight_id)
    return (flight_id for turn in zip_longest(*turns.values()) for flight_id in turn if flight_id is not None)
