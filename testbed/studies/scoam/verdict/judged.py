"""What ``judge`` gives back: the claims, and the tables that they rest on. All of it follows from rows alone."""

from dataclasses import dataclass

from testbed.results.statistics import Effect, Spread
from testbed.studies.scoam.claim import Claim, Control, Rank, Waterfall


@dataclass(frozen=True)
class Case:
    """One method in one encounter in calm air, on one rung: what the tables of the paper show. Metres, degrees, seconds."""

    encounter: str
    aircraft: str
    method: str  # either side of DROAM by itself
    rung: str
    clearance_m: float
    deflection_deg: float  # (a) commanded
    flown_deflection_deg: float  # (b) of the velocity at the passage of the insertion point
    peak_deflection_deg: float  # (c) largest before clear
    path_length_m: float  # from the route's start
    avoidance_time_s: float  # (a) to the closest passage of the insertion point
    clear_time_s: float  # (b) to clear
    load_factor: float
    bank_deg: float
    roll_rate_dps: float
    cross_track_m: float
    replans: int


@dataclass(frozen=True)
class AirCell:
    """The flights of one method in one kind of air. ``kept`` and the clearance are of the threats alone."""

    design: str  # calm, anchored, ground_fixed (steady wind: never pooled), turbulence
    strength: str  # m/s of wind or severity
    encounter: str
    method: str
    aircraft: str
    rung: str
    flights: int
    threats: int  # of them; the rest keeps the radius without planner
    kept: int
    low: float
    high: float
    at_least: float  # one-sided 95 % lower bound: the 99 % of a claim is shown where this is 0.99 or more
    marginal: int
    fail_on_rails: int  # threats in which the point on rails fails already
    clearance: Spread


@dataclass(frozen=True)
class Counted:
    """Flights of a part: how many, how many say nothing (crashed program, no trim), how many are marginal; and its replicates."""

    part: str
    flights: int
    silent: int
    marginal: int
    replicates: int


@dataclass(frozen=True)
class ReadingCell:
    """One reading of the method in one encounter, or over the population, by one aircraft on one rung. All of it is of threats alone."""

    method: str
    part: str
    encounter: str
    aircraft: str
    rung: str
    n: int
    kept: int
    low: float
    high: float
    clearance: Spread
    pairs: int  # with the paper's own reading in the same encounter and air
    other: int  # of them: another clearance, so another answer or another path
    only_this: int  # of them: only this reading keeps every radius
    only_own: int
    mcnemar_p: float
    difference: Effect  # clearance, this reading's minus the paper's own
    no_path: int  # flights in which the planner found no path
    forbidden_by: str  # what forbade it, the most frequent first, each with its count


@dataclass(frozen=True)
class Verdict:
    """Claims in the order of the page: words first, then printed numbers, each merged number followed by its readings."""

    claims: tuple[Claim, ...]
    waterfalls: tuple[Waterfall, ...]
    controls: tuple[Control, ...]
    ranks: tuple[Rank, ...]
    cases: tuple[Case, ...]
    air: tuple[AirCell, ...]
    counted: tuple[Counted, ...]
    readings: tuple[Claim, ...] = ()
    """That the path is safe, for each way to read the method; nothing where none was flown."""
    reading_cells: tuple[ReadingCell, ...] = ()

    @property
    def leading(self) -> tuple[Claim, ...]:
        """The claims of the leading table: without the single readings of the numbers."""
        return tuple(claim for claim in self.claims if "@" not in claim.key)
