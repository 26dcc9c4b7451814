"""A small arena from file to page: the same bytes whoever flies it, the figures of its table on the page, and computed again by others."""

import csv
import math
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from reports.rank_correlation import correlation, shares
from reports.verify import report
from testbed.campaign import SpecError, load_campaign
from testbed.core import registry
from testbed.run import runner
from testbed.run.engines import LocalEngine
from testbed.run.runner import Order
from tests.command import called
from tests.here import Here
from tests.studies.arena.flown import ARENA

CAMPAIGN = Path(__file__).resolve().parents[3] / "campaigns" / "arena.yaml"


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fly(tmp_path_factory.mktemp("arena"), Here())


def fly(folder: Path, engine: object) -> Path:
    (folder / "arena.yaml").write_text(ARENA)
    return runner.run(Order(source=folder / "arena.yaml", engine=engine, out=folder / "out")).directory


def table(directory: Path, name: str) -> list[dict[str, str]]:
    with (directory / "arena.csv").open(newline="") as file:
        return [line for line in csv.DictReader(file) if line["table"] == name]


@pytest.mark.slow
def test_shares_are_those_of_the_flights_and_of_the_right_shape(flown: Path) -> None:
    with (flown / "results.csv").open(newline="") as file:
        flights = list(csv.DictReader(file))
    leads = table(flown, "lead")
    assert len(leads) == 2 * (3 * 2 + 1)
    for line in leads:
        of = [
            float(row["least_clearance_m"]) >= -1e-6 and row["outcome"] not in ("diverged", "hit_ground")
            for row in flights
            if (row["label.method"], row["label.rung"]) == (line["method"], line["rung"])
            and float(row["label.lead_s"]) == float(line["lead_even_s"])
        ]
        assert (int(line["kept"]), int(line["flights"])) == (sum(of), 4)
    assert {line["method"]: line["shape"] for line in leads} == {
        "none": "control",
        "scoam": "direction",
        "scoam_path": "path",
        "geometric_guidance": "law",
    }
    assert all(int(line["kept"]) == 0 for line in leads if line["method"] == "none"), "every encounter hits who does nothing"
    late, early = ({line["method"]: int(line["kept"]) for line in leads if line["lead_even_s"] == lead} for lead in ("0.6", "2.5"))
    assert late["geometric_guidance"] < early["geometric_guidance"]


@pytest.mark.slow
def test_figures_on_the_page_are_those_of_the_table(flown: Path) -> None:
    page = (flown / "index.html").read_text()
    overall = re.search(r'id="costs".*?</table>', page, re.DOTALL).group()
    for line in table(flown, "best"):
        if line["rung"] == "flown":
            row = re.search(rf'<th scope="row">{line["method"]} .*?</tr>', overall, re.DOTALL).group()
            text = re.sub(r"<[^>]*>", " ", row)
            assert f"{line['kept']} of {line['flights']}," in text
            assert f"{100 * float(line['share']):.0f} %" in text
            assert f"{float(line['clearance_median_m']):.1f}".replace("-", "\N{MINUS SIGN}") in text
            if line["p_holm"]:
                assert f"{float(line['p_holm']):.3f}" in text
    best = max((line for line in table(flown, "best") if line["rung"] == "flown" and line["rank"]), key=lambda line: float(line["share"]))
    assert f"every radius is kept in {best['kept']} of {best['flights']} flights" in page
    assert page.count("<polyline") == 2 * 3, "a line a method and place, the control apart"


@pytest.mark.slow
def test_it_is_the_same_bytes_for_one_worker_and_two(flown: Path, tmp_path: Path) -> None:
    again = fly(tmp_path, LocalEngine(2))
    for name in ("arena.csv", "index.html", "results.csv", "answer.json"):
        assert (again / name).read_bytes() == (flown / name).read_bytes(), name
    with (again / "arena_timings.csv").open(newline="") as file:
        times = list(csv.DictReader(file))
    assert [line["flights"] for line in times] == ["8"] * 6
    assert all(0.0 < float(line["slowest_decision_median_ms"]) <= float(line["slowest_decision_p95_ms"]) for line in times)


def verify(directory: Path) -> tuple[int, str]:
    done = called(report.main, "verify", directory, cwd=directory.parent)
    return done.returncode, done.stdout


@pytest.mark.slow
def test_shares_and_ranks_are_computed_again_and_a_changed_one_is_named(flown: Path) -> None:
    code, said = verify(flown)
    assert code == 0, said
    assert f"{2 * 7 + 3 * 4 + 4 * 2} shares and ranks of the arena agree" in said
    file = flown / "arena.csv"
    kept = file.read_text()
    changes: dict[str, Callable[[str], str]] = {
        "share": lambda text: str(float(text) + 0.01),
        "rank": lambda text: str(int(text) + 1),
        "high": lambda text: str(float(text) - 0.001),
        "clearance_median_m": lambda text: str(float(text) + 0.01),
    }
    lines = kept.splitlines()
    heading = lines[0].split(",")
    number = next(k for k, line in enumerate(lines) if line.startswith("best,flown,,,scoam,"))
    try:
        for name, change in changes.items():
            fields = lines[number].split(",")
            fields[heading.index(name)] = change(fields[heading.index(name)])
            file.write_text("\n".join([*lines[:number], ",".join(fields), *lines[number + 1 :]]) + "\n")
            code, said = verify(flown)
            assert code == 1
            assert any(line.split()[:4] == ["best", "flown", "scoam", name] for line in said.splitlines()), said
        file.write_text("\n".join([*lines[:number], *lines[number + 1 :]]) + "\n")
        assert verify(flown)[0] == 1, "a row that is missing"
    finally:
        file.write_text(kept)


@pytest.mark.slow
def test_two_arenas_are_compared_by_their_shares(flown: Path) -> None:
    found = shares(flown)
    assert set(found) == {("rails", "gtm_t2"), ("point_mass", "gtm_t2"), ("flown", "")}
    assert set(found["flown", ""]) == {"scoam", "scoam_path", "geometric_guidance"}


def test_a_rank_correlation_is_the_textbook_s() -> None:
    first = {"a": 0.9, "b": 0.7, "c": 0.5, "d": 0.1, "gone": 1.0}
    n, rho, tau = correlation(first, {"a": 0.8, "b": 0.9, "c": 0.4, "d": 0.3})
    assert (n, rho, tau) == (4, pytest.approx(1 - 6 * 2 / (4 * 15)), pytest.approx(4 / 6))  # one swap of neighbours
    assert math.isnan(correlation(first, {"a": 1.0, "b": 1.0, "c": 1.0})[1])


def test_a_label_that_would_be_judged_by_nobody_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "arena.yaml"
    file.write_text(ARENA.replace("      rung:\n", "      rungs:\n"))
    with pytest.raises(SpecError, match="the study 'arena' knows no axis 'rungs' in the part 'crossing'"):
        load_campaign(file)
    file.write_text(ARENA.replace('"0.6": {', "soon: {").replace('lead_s: "0.6"', "lead_s: soon"))
    with pytest.raises(SpecError, match="the study 'arena' needs labels that are numbers, not 'soon'"):
        load_campaign(file)


def test_every_method_and_planner_there_is_takes_part() -> None:
    """A new one is missed here until it has its line; the same sweep in every part."""
    import yaml

    parts = yaml.safe_load(CAMPAIGN.read_text())["parts"]
    methods = parts["crossing"]["sweep"]["method"]
    assert all(part["sweep"] == parts["crossing"]["sweep"] and part["skip"] == parts["crossing"]["skip"] for part in parts.values())
    named = {settings["method.kind"] for settings in methods.values()}
    planners = {settings["planner"]["kind"] for settings in methods.values() if "planner" in settings}
    assert named == set(registry.names("method"))
    assert planners | {"replan"} == set(registry.names("planner"))
