"""How many encounters an interval of some width takes: told by ``testbed validate`` before anything is flown."""

from testbed.campaign.reading.blocks import resolved_parts
from testbed.campaign.words.settings import Campaign
from testbed.results.columns import METRICS, Kind
from testbed.results.daa.bootstrap import pairs_for_width
from testbed.results.daa.columns import daa_columns
from testbed.results.statistics import share_interval

MOST = 10**9


def told(campaign: Campaign) -> list[str]:
    """Lines for people; none of a campaign that names no width."""
    lines = []
    replicates = max(part.replicates or 1 for part in resolved_parts(campaign).values())
    power = campaign.daa.power if campaign.daa else None
    if power is not None:
        needed = pairs_for_width(power.width, power.ratio, power.share, power.induced)
        expected = f"a ratio of risk of {power.ratio:g} (induced {power.induced:g}) where {power.share:g} have the event without avoidance"
        lines.append(f"a 95 % interval {power.width:g} wide takes about {needed:,} encounters, by {expected}; {_has(replicates, needed)}")
    flags = [column.name for column in (*METRICS, *daa_columns(campaign.daa)) if column.kind is Kind.FLAG]
    if campaign.stop is not None and campaign.stop.column in flags:
        needed = flights_for_share(campaign.stop.width)
        lines.append(
            f"a 95 % interval {campaign.stop.width:g} wide of the share {campaign.stop.column} takes at most {needed:,} flights a cell; "
            f"{_has(replicates, needed)}"
        )
    return lines


def _has(replicates: int, needed: int) -> str:
    return f"the campaign has {replicates:,}: {'enough' if replicates >= needed else 'too few'}"


def flights_for_share(width: float, share: float = 0.5) -> int:
    """Least number of flights after which the interval of a share (Clopper-Pearson) is at most so wide; by default at its widest."""

    def narrow(n: int) -> bool:
        low, high = share_interval(round(share * n), n)
        return high - low <= width

    few, many = 0, 1
    while many < MOST and not narrow(many):
        few, many = many, 2 * many
    while many - few > 1:
        middle = (few + many) // 2
        few, many = (few, middle) if narrow(middle) else (middle, many)
    return many
