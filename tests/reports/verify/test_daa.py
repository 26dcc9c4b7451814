"""Entries into volumes and ratios of risk, computed again: they agree with those of the testbed, and find what is changed."""

import csv
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reports.verify import report
from reports.verify.daa_volumes import entered
from reports.verify.raw import Obstacle, Raw
from testbed.run import runner
from tests.here import Here

CAMPAIGN = """\
name: met
question: Does avoidance lower the risk?
seed: 3
replicates: 8
plant: {kind: kinematic}
route: {start_enu_m: [0, 0, 0], goal_enu_m: [500, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
replan: {answer: direct, swell_m: 8}
encounters:
  kind: approaches
  own_at_enu_m: [25, 0, 0]
  own_direction_deg: [0, 0]
  miss_m: {edges: [0, 25, 60], chances: [0.25, 0.75], drawn: [0.5, 0.5]}
  crossing_deg: [30, 180]
  speed_mps: [20, 50]
  vertical_rate_mps: [-4, 4]
  time_to_cpa_s: 5
  radius_m: 25
recordings: none
columns: all
daa:
  volumes:
    ball: {shape: sphere, radius_m: 24}
    near: {radius_m: 35, half_height_m: 15, edge: in}
    ahead: {radius_m: 35, half_height_m: 15, tau_s: 5}
sweep:
  sensor.range_m: [80, 300]
  method.kind: [none, orca]
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("met")
    (folder / "met.yaml").write_text(CAMPAIGN)
    return runner.run(runner.Order(source=folder / "met.yaml", engine=Here(), out=folder / "out", command=())).directory


def said_of(run: Path) -> tuple[bool, str]:
    said: list[str] = []
    return report.verify(run, said.append), "\n".join(said)


def test_weighted_ratios_of_a_flown_campaign_agree(run: Path) -> None:
    agrees, said = said_of(run)
    assert agrees, said
    # in two ranges: the sphere, four standards and two volumes of its own; DO-365 phase I and `ahead` reach ahead
    assert "14 shares and ratios of risk agree; 4 of volumes that reach ahead are not judged here" in said
    rows = list(csv.DictReader((run / "risk.csv").read_text().splitlines()))
    sphere = [row for row in rows if row["volume"] == "sphere" and "300" in row["circumstances"]]
    # a miss of a sphere counts three times a hit: the share is none that so many encounters of one weight have
    assert int(sphere[0]["resolved"]) > 0
    assert float(sphere[0]["share_without"]) * 8 != int(sphere[0]["resolved"]) + int(sphere[0]["unresolved"])
    assert "Encounters weigh by <code>weight</code>" in (run / "index.html").read_text()


@pytest.mark.parametrize(
    ("table", "change", "told"),
    [
        ("risk.csv", lambda row: row.update(ratio=repr(float(row["ratio"]) + 1e-6)), "ratio"),
        ("risk.csv", lambda row: row.update(induced=str(int(row["induced"]) + 1)), "induced"),
        ("results.csv", lambda row: row.update(entered_near={"true": "false", "false": "true"}[row["entered_near"]]), "entered_near"),
        ("results.csv", lambda row: row.update(weight=repr(2.0 * float(row["weight"]))), "share_without"),
    ],
)
def test_what_was_changed_is_found(run: Path, tmp_path: Path, table: str, change: Callable[[dict[str, str]], None], told: str) -> None:
    copy = Path(shutil.copytree(run, tmp_path / "out"))
    rows = list(csv.DictReader((copy / table).read_text().splitlines()))
    change(rows[0])
    with (copy / table).open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    agrees, said = said_of(copy)
    assert not agrees
    assert told in said


def test_an_entry_between_ticks_is_what_a_thousand_places_on_the_way_say() -> None:
    """Random straight ways past a cylinder and a ball, many of them near the limits."""
    rng, seen = np.random.default_rng(8), {True: 0, False: 0}
    shares = np.linspace(0.0, 1.0, 1001)[:, None]
    for _ in range(300):
        a, b = rng.uniform(-60.0, 60.0, (2, 3))
        still = np.zeros((2, 3))
        raw = Raw(np.array([0.0, 1.0]), np.array([a, b]), still, still, (Obstacle("O", 5.0, still, still),), {})
        way = a + shares * (b - a)
        round_, high, slant = np.linalg.norm(way[:, :2], axis=1), np.abs(way[:, 2]), np.linalg.norm(way, axis=1)
        for volume, depth in (((35.0, 15.0, False), np.maximum(round_ - 35.0, high - 15.0)), ((30.0, None, False), slant - 30.0)):
            if abs(depth.min()) > 0.2:  # nearer than a thousand places tell
                assert entered(raw, volume) == (depth.min() < 0.0)
                seen[bool(depth.min() < 0.0)] += 1
    assert min(seen.values()) > 100
