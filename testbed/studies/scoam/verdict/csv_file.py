"""``verdict.csv``: one line a claim, the same bytes on every machine."""

import csv
import io
import math
from typing import Any, Final

from testbed.studies.scoam.claim import Claim
from testbed.studies.scoam.verdict.judged import Verdict

SIGNIFICANT_DIGITS: Final = 6

VERDICT_COLUMNS: Final = (
    "key where text paper unit quantity reading aircraft kinematic point_mass flown_calm flown_air_p05 flown_air_median flown_air_p95 "
    "flown_air_n word condition effect_what effect_unit effect effect_low effect_high effect_n robustness_share robustness_n "
    "deciding_limit why"
).split()


def csv_bytes(verdict: Verdict) -> bytes:
    """All claims in order; figures with six significant digits, NaN as an empty field."""
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(VERDICT_COLUMNS)
    writer.writerows([_text(value) for value in _values(claim)] for claim in verdict.claims)
    return out.getvalue().encode()


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
