"""Ratios of risk: counted in hand-made pairs, and their interval against the truth of a thousand made campaigns."""

import csv
import io
import math
from typing import Any

import numpy as np
import pytest

from testbed.campaign.words.daa import Daa, Volume
from testbed.results.daa.bootstrap import Z95, pairs_for_width, ratio_interval
from testbed.results.daa.risk import Risk, csv_bytes, risk_of

DAA = Daa(standards=(), volumes={"near": Volume(radius_m=10.0, half_height_m=5.0)})
KINDS = {"both": (True, True), "saved": (True, False), "induced": (False, True), "neither": (False, False)}


def row(method: str, replicate: int, entered: bool | None, cell: str = "", weight: float = 1.0) -> dict[str, Any]:
    labels = {"wind": cell or "calm", "method": method}
    clearance = math.nan if entered is None else -1.0 if entered else 1.0
    return {
        "labels": labels, "cell": "/".join(labels.values()), "replicate": replicate, "method": method, "entered_near": entered,
        "least_clearance_m": clearance, "horizontal_miss_m": 3.0, "vertical_miss_m": 4.0, "encounter_radius_m": weight,
        "plant": "kinematic", "aircraft": "gtm_t2",
    }  # fmt: skip


def flights(counts: dict[str, int], method: str = "scoam", cell: str = "") -> list[dict[str, Any]]:
    kinds = [kind for kind, n in counts.items() for _ in range(n)]
    without = [row("none", k, KINDS[kind][0], cell) for k, kind in enumerate(kinds)]
    return without + [row(method, k, KINDS[kind][1], cell) for k, kind in enumerate(kinds)]


def test_pairs_are_split_into_unresolved_and_induced() -> None:
    calm, windy = flights({"both": 6, "saved": 24, "induced": 3, "neither": 7}), flights({"both": 5, "saved": 5}, cell="windy")
    alone = [row("scoam", 99, True), row("scoam", 7, None)]
    risk = risk_of([*calm, *windy, alone[0]], DAA, seed=1)
    assert risk.unpaired == 1
    (sphere, near, *_) = risk.ratios
    assert [one.volume for one in risk.ratios] == ["sphere", "near"] * 2
    assert [dict(one.circumstances) for one in risk.ratios] == [{"wind": "calm"}] * 2 + [{"wind": "windy"}] * 2
    for one in (sphere, near):
        assert (one.encounters, one.unresolved, one.resolved, one.induced) == (40, 6, 24, 3)
        assert one.interval.value == pytest.approx(9 / 30, abs=1e-12)
        assert (one.unresolved_ratio, one.induced_ratio) == pytest.approx((6 / 30, 3 / 30), abs=1e-12)
        assert (one.share_without, one.share_with) == pytest.approx((30 / 40, 9 / 40), abs=1e-12)
        assert one.interval.low < 0.3 < one.interval.high
        assert one.wide  # 40 encounters are few
    table = list(csv.DictReader(io.StringIO(csv_bytes(risk, DAA).decode())))
    assert [float(line["ratio"]) for line in table] == [9 / 30, 9 / 30, 0.5, 0.5]
    assert {line["limits"] for line in table} == {"the radius of each", "horizontal < 10 m, vertical < 5 m"}


def test_what_is_not_measured_is_in_no_pair_and_one_axis_alone_says_who_avoids() -> None:
    rows = flights({"both": 4, "saved": 4})
    rows[3] = row("none", 3, None)
    (_, near) = risk_of(rows, DAA, seed=1).ratios
    assert near.encounters == 7
    assert dict(near.method) == {"method": "scoam"}
    only = [one for one in rows if one["method"] != "none"]
    assert risk_of(only, DAA, seed=1).ratios == []


def test_weights_count_an_encounter_as_so_many() -> None:
    """One weighted 3 is what three alike are; one without a weight is left out."""
    heavy = Daa(standards=(), volumes=DAA.volumes, weight="encounter_radius_m")
    kinds = [("both", 3.0), ("saved", 1.0), ("saved", 2.0), ("induced", 1.0), ("saved", -1.0)]
    rows = [row("none", k, KINDS[kind][0], weight=weight) for k, (kind, weight) in enumerate(kinds)]
    rows += [row("scoam", k, KINDS[kind][1]) for k, (kind, _) in enumerate(kinds)]
    found = risk_of(rows, heavy, seed=1)
    near = found.ratios[1]
    assert near.interval.value == pytest.approx(4.0 / 6.0, abs=1e-12)
    assert (near.unresolved_ratio, near.induced_ratio) == pytest.approx((0.5, 1 / 6), abs=1e-12)
    assert (near.share_without, near.share_with) == pytest.approx((6 / 7, 4 / 7), abs=1e-12)
    assert (near.encounters, near.resolved, found.unweighted) == (4, 2, 1)


def test_the_weight_of_a_drawn_encounter_counts_without_being_asked_for() -> None:
    """Rows of encounters that count 1 say nothing of it."""
    kinds = [("both", 3.0), ("saved", 0.5), ("induced", 1.0), ("saved", 1.0)]
    rows = [row(method, k, KINDS[kind][m]) for m, method in enumerate(("none", "scoam")) for k, (kind, _) in enumerate(kinds)]
    assert risk_of(rows, DAA, seed=1).weight == ""
    drawn = [one | ({} if (w := kinds[one["replicate"]][1]) == 1.0 else {"weight": w}) for one in rows]
    found = risk_of(drawn, DAA, seed=1)
    near = found.ratios[1]
    assert (found.weight, found.unweighted) == ("weight", 0)
    assert near.interval.value == pytest.approx(4.0 / 4.5, abs=1e-12)
    assert (near.share_without, near.share_with) == pytest.approx((4.5 / 5.5, 4.0 / 5.5), abs=1e-12)
    assert risk_of(drawn, DAA.model_copy(update={"weight": "encounter_radius_m"}), seed=1).ratios[1].interval.value == 2 / 3


@pytest.mark.slow
def test_a_thousand_intervals_cover_the_known_ratio() -> None:
    """400 encounters, 40 % with an event without avoidance, ratio 0.30 of which 0.05 is induced; a third of them with weights."""
    rng = np.random.default_rng(8)
    share, unresolved, induced, n = 0.4, 0.25, 0.05, 400
    covered = below = above = 0
    for k in range(1000):
        kind = rng.choice(4, size=n, p=[share * unresolved, share * (1 - unresolved), share * induced, 1 - share - share * induced])
        weights = rng.choice([0.5, 1.0, 2.0], size=n) if k % 3 == 0 else np.ones(n)
        value, low, high = ratio_interval(weights, (kind < 2).astype(float), np.isin(kind, (0, 2)).astype(float), rng)
        assert low <= value <= high
        covered += low <= unresolved + induced <= high
        below += high < unresolved + induced
        above += low > unresolved + induced
    assert 930 <= covered <= 970, (covered, below, above)
    assert min(below, above) >= 8, "the misses lie to both sides"


def test_intervals_where_resampling_says_nothing() -> None:
    rng = np.random.default_rng(1)
    n = 60
    every, none = np.ones(n), np.zeros(n)
    value, low, high = ratio_interval(every, every, none, rng)
    assert (value, low) == (0.0, 0.0)
    assert high == pytest.approx(1.0 - 0.025 ** (1 / 60), rel=1e-12)  # the exact upper end of 0 of 60
    value, low, high = ratio_interval(every, every, every, rng)
    assert value == 1.0
    assert math.log(high) == pytest.approx(Z95 * math.sqrt(0.5) / 60.5, rel=1e-9)
    assert low == pytest.approx(1.0 / high)
    assert all(map(math.isnan, ratio_interval(every, none, every, rng)))
    assert all(map(math.isnan, ratio_interval(np.zeros(0), np.zeros(0), np.zeros(0), rng)))


@pytest.mark.parametrize(("width", "ratio", "share", "induced"), [(0.2, 0.3, 0.4, 0.05), (0.1, 0.3, 0.5, 0.0), (0.3, 0.6, 0.3, 0.1)])
def test_so_many_encounters_give_an_interval_of_that_width(width: float, ratio: float, share: float, induced: float) -> None:
    n = pairs_for_width(width, ratio, share, induced)
    rng = np.random.default_rng(4)
    p = [share * (ratio - induced), share * (1 - ratio + induced), share * induced, 1 - share - share * induced]
    widths = []
    for _ in range(25):
        kind = rng.choice(4, size=n, p=p)
        _, low, high = ratio_interval(np.ones(n), (kind < 2).astype(float), np.isin(kind, (0, 2)).astype(float), rng)
        widths.append(high - low)
    assert np.median(widths) == pytest.approx(width, rel=0.12)


def test_the_same_rows_give_the_same_bytes() -> None:
    rows = flights({"both": 6, "saved": 24, "induced": 3})
    first, second = (csv_bytes(risk_of(rows, DAA, seed=5), DAA) for _ in range(2))
    assert first == second
    assert isinstance(risk_of([], DAA, seed=5), Risk)
