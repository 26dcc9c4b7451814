"""``make_env``: a campaign's flights, one command after the other (docs/stepping.md). What it needs of gymnasium is in ``env.py``."""

from collections.abc import Callable
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Final, get_args

from testbed.campaign import load_campaign
from testbed.campaign.reading.expand import cell_names, each_plan, replicates_of
from testbed.campaign.words.planning import PlannerSpec
from testbed.campaign.words.settings import Campaign, FlightPlan

if TYPE_CHECKING:
    from testbed.run.env import Asks, CommandKind, FlightEnv, Reward

MOST: Final = {"acceleration": 25.0, "velocity": 1.0}
"""Sizes of the numbers of a command that the action space is drawn with: m/s^2, and of a direction."""
TOLD = 12  # cells that are named where one has to be chosen


def make_env(
    campaign: Campaign | str | Path,
    cell: str | None = None,
    flight_id: str | None = None,
    *,
    command: "CommandKind" = "acceleration",
    asks: "Asks" = "when_threatened",
    most: float | None = None,
    reward: "Reward | None" = None,
) -> "FlightEnv":
    """A gymnasium environment that flies a cell of a campaign, which may be a file, with the commands that it is stepped with.

    ``cell``: which, where there are several; ``flight_id``: the cell, and the first replicate, of that flight. ``asks`` says when a command
    is asked for. ``most`` bounds the action space. Raises ``ValueError`` in a sentence, ``SpecError`` for a campaign that is none, and
    ``ImportError`` without gymnasium.
    """
    try:
        from testbed.run import env
    except ModuleNotFoundError as missing:
        if missing.name != "gymnasium":
            raise
        raise ImportError("make_env needs gymnasium, which is an extra: pip install 'vosc-testbed[env]'", name=missing.name) from None
    for name, value, known in (("command", command, env.CommandKind), ("asks", asks, env.Asks)):
        if value not in get_args(known):
            raise ValueError(f"{name} must be one of {', '.join(get_args(known))}, not {value!r}")
    if most is not None and not 0.0 < most < float("inf"):
        raise ValueError(f"most must be a finite number above 0, not {most!r}")
    plan_of, first = _replicates(campaign if isinstance(campaign, Campaign) else load_campaign(campaign), cell, flight_id)
    plan = plan_of(first)
    if plan.study.part.flies:
        raise ValueError(f"'{plan.cell}' is what the study '{plan.study.kind}' flies, which is not one flight that could be stepped")
    if asks == "when_threatened" and plan.planner.kind != PlannerSpec().kind:
        raise ValueError(f"the planner '{plan.planner.kind}' asks nobody for a command; asks='always' flies without it")
    return env.FlightEnv(plan_of, first, command, asks, most or MOST[command], reward or env.by_outcome)


def _replicates(campaign: Campaign, cell: str | None, flight_id: str | None) -> tuple[Callable[[int], FlightPlan], int]:
    """The replicates of the cell that is asked for, by their numbers, and the number of the first to fly."""
    if flight_id is not None:
        plan = next((plan for plan in each_plan(campaign) if plan.flight_id == flight_id), None)
        if plan is None or cell not in (None, plan.cell):
            raise ValueError(f"the campaign has no flight '{flight_id}'" + (f" in the cell '{cell}'" if cell is not None else ""))
        return replicates_of(campaign, plan.cell), plan.replicate
    names = list(islice(cell_names(campaign), TOLD + 1))
    if cell is None and len(names) == 1:
        (cell,) = names
    told = ", ".join(f"'{name}'" for name in names[:TOLD]) + (", ..." if len(names) > TOLD else "")
    if cell is None:
        raise ValueError(f"the campaign has several cells; say which by cell=: {told}")
    try:
        return replicates_of(campaign, cell), 0
    except KeyError:
        raise ValueError(f"the campaign has no cell '{cell}'; there are: {told}") from None
