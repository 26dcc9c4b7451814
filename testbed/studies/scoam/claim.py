"""A claim of the paper and what became of it: the row of ``verdict.csv`` and of the table that leads the page.

The words are fixed. How each follows from flights is in ``docs/verdict.md``; everything here is a figure that was computed from rows.
"""

from dataclasses import dataclass
from typing import Final, Literal

from testbed.results.statistics import Effect, Spread

HOLDS: Final = "holds"
HOLDS_ONLY_IF: Final = "holds only if"
FAILS_KINEMATICALLY: Final = "fails kinematically"
FAILS_WHEN_FLOWN: Final = "fails when flown"
NOT_DETERMINED: Final = "not determined"
TOO_FEW: Final = "too few to say"
"""In the place of a word that so few flights or draws do not settle."""
VERDICT_WORDS: Final = (HOLDS, HOLDS_ONLY_IF, FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, NOT_DETERMINED, TOO_FEW)

Word = Literal["holds", "holds only if", "fails kinematically", "fails when flown", "not determined", "too few to say"]


@dataclass(frozen=True)
class Claim:
    """One claim or printed number. Values are in ``unit``; NaN where a rung has none. All of them are of ``aircraft`` and ``reading``."""

    key: str  # e.g. table2.scoam.deflection, words.single.safe
    where: str  # Table 2, Table 4, Section 5.1, Abstract ...
    text: str  # the claim as a reader of the paper would recognise it
    paper: str  # what is printed, as printed; empty for a claim in words
    unit: str
    quantity: str  # what the figures of the next columns are, e.g. "commanded deflection", "least clearance"
    reading: str  # which reading of the paper's encounter they belong to
    aircraft: str
    kinematic: float
    point_mass: float
    flown_calm: float
    flown_air: Spread  # steady wind and turbulence
    word: Word
    condition: str  # completes "holds only if"; empty otherwise
    effect: Effect
    robustness_share: float  # share of the robustness draws with the same word; NaN where there are no draws
    robustness_n: int
    deciding_limit: str  # by ablation: docs/verdict.md names them; empty if none
    why: str  # one sentence for the reader, every number in it generated


@dataclass(frozen=True)
class Step:
    """One rung of a waterfall: the clearance there, and what the step from the rung before cost (negative: lost), m."""

    rung: str
    clearance_m: float
    change_m: float


@dataclass(frozen=True)
class Waterfall:
    """Clearance from the direction flown at once to turbulence, for one encounter, method and aircraft."""

    encounter: str
    method: str
    aircraft: str
    steps: tuple[Step, ...]
    alone_m: dict[str, float]  # limit of the point mass -> clearance it costs when it is the only one
    last_m: dict[str, float]  # limit of the point mass -> clearance that comes back when only it is taken away from all of them


@dataclass(frozen=True)
class Control:
    """A control: what it should show, how many flights did, and out of how many."""

    name: str
    expected: str
    met: int
    n: int
    exceptions: str


@dataclass(frozen=True)
class Rank:
    """One method on the population, on one rung: flights, share that kept the radius with its 95 % interval, and medians."""

    rung: str
    method: str
    n: int
    safe: int
    safe_low: float
    safe_high: float
    clearance: Spread
    deflection: Spread
    extra_length: Spread  # against the flight of the same encounter without planner
    clear_time: Spread
    load_factor: Spread
    versus_scoam: (
        Effect  # paired by encounter: clearance of scoam minus the method's; McNemar's p in ``mcnemar_p`` for the share that is safe
    )
    mcnemar_p: float
