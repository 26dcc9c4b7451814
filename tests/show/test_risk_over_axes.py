"""Ratios of risk over the axes of a sweep: the numbers drawn are those of the ratios, and what is accepted is read off them."""

import math
import re
from typing import Any

import pytest

from testbed.campaign.words.daa import Daa, Volume
from testbed.results.daa.risk import Risk, risk_of
from testbed.results.statistics import Effect
from testbed.show.axis_words import RATIO
from testbed.show.over_axis import Line
from testbed.show.risk_over_axes import RiskCell, axes_part, ratios_over_axes, where_accepted

DAA = Daa(standards=(), volumes={"near": Volume(radius_m=10.0, half_height_m=5.0)}, accepted_ratio=0.4)
RANGES, LATENCIES, ENCOUNTERS = ("100", "200", "400"), ("0", "1"), 40
ENTERED = {("100", "0"): 30, ("200", "0"): 4, ("400", "0"): 0, ("100", "1"): 40, ("200", "1"): 20, ("400", "1"): 3}
"""Encounters, of forty all of which are entered without avoidance, in which SCOAM enters; ORCA always does."""


def _row(method: str, reach: str, latency: str, replicate: int, entered: bool) -> dict[str, Any]:
    labels = {"sensor.range_m": reach, "sensor.options.latency_s": latency, "method.kind": method}
    return {
        "labels": labels, "cell": "/".join(labels.values()), "replicate": replicate, "method": method, "entered_near": entered,
        "least_clearance_m": -1.0 if entered else 1.0, "plant": "jsbsim", "aircraft": "gtm_t2", "outcome": "reached",
    }  # fmt: skip


@pytest.fixture(scope="module")
def risk() -> Risk:
    rows = []
    for (reach, latency), count in ENTERED.items():
        for method in ("none", "scoam", "orca"):
            rows += [_row(method, reach, latency, k, method != "scoam" or k < count) for k in range(ENCOUNTERS)]
    return risk_of(rows, DAA, seed=1)


def test_each_point_is_the_ratio_of_its_cell(risk: Risk) -> None:
    over = ratios_over_axes(risk, DAA)
    assert over.metrics() == [RATIO + "sphere", RATIO + "near"]
    assert [(curve.axis, len(curve.panels)) for curve in over.curves] == [("sensor.range_m", 2), ("sensor.options.latency_s", 3)]
    by_place = {tuple(label for _, label in (*one.circumstances, *one.method)): one.interval for one in risk.ratios if one.volume == "near"}
    (pair,) = over.heat_maps
    scoam = next(grid for grid in pair.grids if grid.title.endswith("SCOAM"))
    for (x, y), cell in scoam.cells.items():
        effect = cell.effects[RATIO + "near"]
        assert effect.value == ENTERED[f"{x:g}", f"{y:g}"] / ENCOUNTERS
        assert (effect.low, effect.high) == by_place[f"{x:g}", f"{y:g}", "scoam"][1:]
        assert effect.low <= effect.value <= effect.high


def test_the_page_says_from_where_on_it_is_accepted_and_frames_it(risk: Risk) -> None:
    part = axes_part(risk, DAA)
    assert part is not None
    assert part["lines"] == [
        "sensor latency 0 s: SCOAM from 200 m on, ORCA nowhere",
        "sensor latency 1 s: SCOAM from 400 m on, ORCA nowhere",
    ]
    first = part["pictures"]["figures"][0]
    assert "framed: the whole interval is at most 0.40" in first["notes"][0]
    framed = {panel["title"].rpartition(", ")[2]: panel["svg"].count("oa-frame") for panel in first["each"][0]}
    assert framed == {"SCOAM": 3, "ORCA": 0}  # 4 of 40 and none at 0 s, 3 of 40 at 1 s
    said = re.findall(r"<title>([^<]*)</title>", first["each"][0][0]["svg"])
    assert len(said) == len(ENTERED)
    narrow = axes_part(risk, DAA.model_copy(update={"accepted_ratio": 0.01}))
    assert narrow is not None
    assert all("SCOAM nowhere" in line for line in narrow["lines"])


@pytest.mark.parametrize(
    ("highs", "said"),
    [
        ((0.9, 0.2, 0.1), "from 2 s on"),
        ((0.3, 0.4, 0.5), "up to 1 s"),
        ((0.1, 0.1, 0.1), "throughout (1 to 3 s)"),
        ((0.9, 0.2, 0.9), "at 2 s"),
        ((0.1, 0.9, 0.1), "at 1, 3 s"),
        ((0.9, 0.9, math.nan), "nowhere"),
    ],
)
def test_where_it_is_accepted_in_words(highs: tuple[float, ...], said: str) -> None:
    cells = [RiskCell({"labels": {}}, ratios={"ratio.x": Effect("", "", 0.0, 0.0, high, 9)}) for high in highs]
    line = Line("one", tuple((float(k + 1), cell) for k, cell in enumerate(cells)))
    assert where_accepted(line, "ratio.x", 0.3, "s") == said
