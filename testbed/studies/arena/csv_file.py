"""``arena.csv``: every share and rank, one row each. What the columns are is in ``docs/arena.md``."""

import csv
import io
import math
from collections.abc import Iterator

from testbed.studies.arena.flights import CONTROL, Place
from testbed.studies.arena.ranks import Cost, Judged, Share, Standing

COLUMNS = (
    "table rung flown_by population method shape lead_even_s lead_odd_s encounters flights kept share low high clearance_p05_m "
    "clearance_median_m clearance_p95_m deflection_median_deg extra_path_median_m load_factor_median bank_median_deg roll_rate_median_dps "
    "rank only_first only_this p p_holm lost_by"
).split()
LEAD, BEST, POPULATION = "lead", "best", "population"
Line = dict[str, str | float]


def csv_text(judged: Judged) -> str:
    """Six significant digits; an empty field for what does not exist."""
    sink = io.StringIO(newline="")
    writer = csv.writer(sink, lineterminator="\n")
    writer.writerow(COLUMNS)
    for line in lines(judged):
        writer.writerow([_text(line.get(name, "")) for name in COLUMNS])
    return sink.getvalue()


def lines(judged: Judged) -> Iterator[Line]:
    """The rows: shares by lead; standings at the own best lead; those by population."""
    for place, by_method in judged.leads.items():
        for method, by_lead in by_method.items():
            for lead_s, share in by_lead.items():
                yield _who(LEAD, place, method, judged) | {"lead_even_s": lead_s, "lead_odd_s": lead_s} | _share(share)
    for place, standings in judged.places.items():
        for one in standings:
            yield _who(BEST, place, one.method, judged) | _share(one.share) | _standing(one)
    for method, by_population in judged.populations.items():
        for population, share in by_population.items():
            yield _who(POPULATION, judged.overall, method, judged) | {"population": population} | _share(share)


def _who(table: str, place: Place, method: str, judged: Judged) -> Line:
    return {"table": table, "rung": place.rung, "flown_by": place.flown_by, "method": method, "shape": judged.shapes[method]}


def _share(of: Share) -> Line:
    return dict(vars(of))


def _standing(one: Standing) -> Line:
    found: Line = {"lead_even_s": one.even_s, "lead_odd_s": one.odd_s, **_cost(one.cost)}
    if one.shape != CONTROL:
        found |= {name: getattr(one, name) for name in ("rank", "only_first", "only_this", "p", "p_holm")}
    return found | {"lost_by": "; ".join(f"{kind} {count}" for kind, count in one.lost.items())}


def _cost(of: Cost) -> Line:
    return {
        "clearance_p05_m": of.clearance_m.p05,
        "clearance_median_m": of.clearance_m.median,
        "clearance_p95_m": of.clearance_m.p95,
        "deflection_median_deg": of.deflection_deg.median,
        "extra_path_median_m": of.extra_path_m.median,
        "load_factor_median": of.load_factor.median,
        "bank_median_deg": of.bank_deg.median,
        "roll_rate_median_dps": of.roll_rate_dps.median,
    }


def _text(value: str | float) -> str:
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else f"{value + 0.0:.6g}"
