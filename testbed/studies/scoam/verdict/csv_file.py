"""``verdict.csv``, one line a claim, and ``readings.csv``, one line a reading and place: the same bytes on every machine."""

import csv
import io
import math
from collections.abc import Iterable, Sequence
from typing import Any, Final

from testbed.studies.scoam.claim import Claim
from testbed.studies.scoam.verdict.judged import ReadingCell, Verdict

SIGNIFICANT_DIGITS: Final = 6

VERDICT_COLUMNS: Final = (
    "key where text paper unit quantity reading aircraft kinematic point_mass flown_calm flown_air_p05 flown_air_median flown_air_p95 "
    "flown_air_n word condition effect_what effect_unit effect effect_low effect_high effect_n robustness_share robustness_n "
    "deciding_limit why"
).split()

READING_COLUMNS: Final = (
    "method part encounter aircraft rung threats kept kept_low kept_high clearance_p05 clearance_median clearance_p95 pairs other "
    "only_this only_own mcnemar_p difference difference_low difference_high no_path forbidden_by"
).split()


def csv_bytes(verdict: Verdict) -> bytes:
    """All claims in order, those of the readings last; figures with six significant digits, NaN as an empty field."""
    return _table(VERDICT_COLUMNS, map(_values, (*verdict.claims, *verdict.readings)))


def readings_bytes(verdict: Verdict) -> bytes:
    """The figures behind the readings."""
    return _table(READING_COLUMNS, map(_figures, verdict.reading_cells))


def _table(columns: Sequence[str], lines: Iterable[list[Any]]) -> bytes:
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_text(value) for value in line] for line in lines)
    return out.getvalue().encode()


def _figures(cell: ReadingCell) -> list[Any]:
    clearance, difference = cell.clearance, cell.difference
    return [
        *(cell.method, cell.part, cell.encounter, cell.aircraft, cell.rung, cell.n, cell.kept, cell.low, cell.high),
        *(clearance.p05, clearance.median, clearance.p95, cell.pairs, cell.other, cell.only_this, cell.only_own, cell.mcnemar_p),
        *(difference.value, difference.low, difference.high, cell.no_path, cell.forbidden_by),
    ]


def _values(claim: Claim) -> list[Any]:
    air, effect = claim.flown_air, claim.effect
    return [
        *(claim.key, claim.where, claim.text, claim.paper, claim.unit, claim.quantity, claim.reading, claim.aircraft),
        *(claim.kinematic, claim.point_mass, claim.flown_calm, air.p05, air.median, air.p95, air.n),
        *(claim.word, claim.condition, effect.what, effect.unit, effect.value, effect.low, effect.high, effect.n),
        *(claim.robustness_share, claim.robustness_n, claim.deciding_limit, claim.why),
    ]


def _text(value: str | float) -> str:
    if isinstance(value, str | int):
        return str(value)
    if math.isnan(value):
        return ""
    return f"{float(f'{value:.{SIGNIFICANT_DIGITS}g}') + 0.0:.{SIGNIFICANT_DIGITS}g}"  # + 0.0: no negative zero
