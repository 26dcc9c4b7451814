"""Campaigns of very many flights: neither plans nor rows are held, and a run that goes on begins at once."""

import json
import math
import random
import time
import tracemalloc
from dataclasses import replace

import numpy as np
import pyarrow.parquet as pq
import pytest

from testbed.campaign import expand, load_campaign
from testbed.campaign.reading import expand as expanding
from testbed.results import tables
from testbed.run import estimate, journal, planned, runner
from testbed.run.directory import BadInputError
from testbed.run.engines import LocalEngine, attempt
from testbed.run.runner import Order
from testbed.show import gathered
from testbed.show.page import render_page
from tests.run import fakes
from tests.run.little import CAMPAIGN, Here, contents, stop_after

KEPT = ("results.csv", "results.parquet", "index.html", "plan.json")
PARTS = """\
parts:
  many: {sweep: {sensor.range_m: [1, 2, 3], method.kind: [none, scoam]}, replicates: 3}
  drawn: {draw: {sensor.range_m: {between: [40, 50]}}, replicates: 4}
"""


@pytest.fixture(autouse=True)
def one_code(monkeypatch):
    monkeypatch.setattr("testbed.run.identity.code_hash", lambda: "c0de")


def written(folder, text=CAMPAIGN):
    file = folder / "little.yaml"
    file.write_text(text)
    return file


def job(one):
    return replace(fakes.fly(one), series=None)  # those of the fakes are none that the page could draw


def fly(folder, *overrides, **settings):
    return runner.run(Order(**{"source": folder / "little.yaml", "engine": Here(), "out": folder / "out", "job": job} | settings,
                            overrides=overrides))  # fmt: skip


def peak_of(folder, replicates):
    """The most memory that a run needs, of what Python and numpy take. Its flights are done already when half are resumed."""
    folder.mkdir()
    written(folder)
    tracemalloc.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            fly(folder, f"replicates={replicates}", progress=stop_after(replicates))
        fly(folder, f"replicates={replicates}")
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.slow
def test_memory_does_not_grow_with_the_flights(tmp_path, monkeypatch):
    """A row alone takes 5 kB, a plan 6 kB. 8 bytes for each of some 20 numbers may stay: ids, places, what the cells' medians are of; of
    flights that the page does not list.
    """
    monkeypatch.setattr(gathered, "MOST_FLIGHT_ROWS", 200)
    peak_of(tmp_path / "warm", 10)
    few, many = peak_of(tmp_path / "few", 250), peak_of(tmp_path / "many", 1000)
    assert (many - few) / (2 * 750) < 700


def test_a_run_that_goes_on_makes_no_plan_and_reads_no_row_again(tmp_path, monkeypatch):
    written(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        fly(tmp_path, progress=stop_after(5))
    monkeypatch.setattr(expanding, "each_plan", lambda _: pytest.fail("expanded the campaign again"))
    decoded, decode = [], journal.decode
    monkeypatch.setattr(journal, "decode", lambda line: decoded.append(line) or decode(line))
    at_first = []
    summary = fly(tmp_path, progress=lambda done, *_: at_first.append((done, len(decoded))))
    assert (summary.planned, summary.flown_now) == (8, 3)
    assert at_first[0][0] == 5
    assert at_first[0][1] <= 2  # the last line, when it is looked whether it is whole


def test_a_plan_file_that_was_changed_is_not_believed(tmp_path):
    written(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        fly(tmp_path, progress=stop_after(5))
    plan = tmp_path / "out" / "plan.json"
    whole = plan.read_bytes()
    plan.write_bytes(whole.replace(b'"speed_mps":50.0', b'"speed_mps":51.0'))
    assert plan.read_bytes() != whole
    assert fly(tmp_path).flown_now == 3
    assert plan.read_bytes() == whole
    with pytest.raises(BadInputError, match=r"speed_mps: 50\.0 there, 40"):
        fly(tmp_path, "speed_mps=40")


def test_axes_in_another_order_are_other_flights(tmp_path):
    """Though the JSON of the campaign is the same when its keys are sorted, and so are the settings of all flights."""
    sweep = ("  method.kind: [none, scoam]\n", "  sensor.range_m: [50, 60]\n")
    written(tmp_path, CAMPAIGN.partition("  method.kind")[0] + "".join(sweep))
    fly(tmp_path)
    written(tmp_path, CAMPAIGN.partition("  method.kind")[0] + "".join(sweep[::-1]))
    with pytest.raises(BadInputError, match="expands to other flights"):
        fly(tmp_path)


def test_a_plan_file_in_another_layout_is_read_as_well(tmp_path):
    written(tmp_path, CAMPAIGN.partition("sweep:")[0] + PARTS)
    fly(tmp_path)
    before = contents(tmp_path / "out")
    plan = tmp_path / "out" / "plan.json"
    for text in (json.dumps(json.loads(plan.read_bytes()), indent=1), plan.read_text().replace("\n", "")):
        plan.write_text(text)
        runner.report(tmp_path / "out")
        assert {name: data for name, data in contents(tmp_path / "out").items() if name in KEPT[:3]} == {n: before[n] for n in KEPT[:3]}


@pytest.mark.parametrize("damage", [b"", b"{", b'{"campaign":{},"flights":[\n', b'{"campaign":{},"flights":[\n{"flight_id":3}\n]}', b"[]"])
def test_a_plan_file_that_is_none_is_told(tmp_path, damage):
    (tmp_path / "plan.json").write_bytes(damage)
    with pytest.raises(BadInputError, match=r"plan\.json: damaged, or not a plan"):
        planned.opened(tmp_path / "plan.json")


def test_plans_are_read_as_they_were_made_in_any_order(tmp_path):
    campaign = load_campaign(written(tmp_path, CAMPAIGN.partition("sweep:")[0] + PARTS))
    made = expand(campaign)
    with (tmp_path / "plan.json").open("wb") as file:
        planned.write(file, campaign, iter(made))
    read = planned.opened(tmp_path / "plan.json")
    assert list(read.plans) == list(made)
    numbers = random.Random(1).sample(range(len(made)), len(made))
    assert list(read.some(np.array(numbers))) == [made[n] for n in numbers]
    assert [read.plans[n] for n in numbers] == [made[n] for n in numbers]
    assert read.plans[2:4] == list(made[2:4])
    assert json.loads((tmp_path / "plan.json").read_bytes())["flights"] == [plan.model_dump(mode="json") for plan in made]


def test_tables_are_the_same_written_piece_by_piece(tmp_path, monkeypatch):
    rows = [fakes.metrics_row(f"{n:012x}") | {"labels": {"axis": str(n % 3)}} for n in range(57)]
    axes = tables.axis_kinds(row["labels"] for row in rows)
    whole = tables.table(rows, axes)
    for at_once, group in ((500, 10_000), (10, 60), (5, 10), (1, 1)):
        monkeypatch.setattr(tables, "AT_ONCE", at_once)
        monkeypatch.setattr(tables, "ROW_GROUP", group)
        with (tmp_path / "r.csv").open("wb") as text, (tmp_path / "r.parquet").open("wb") as packed:
            tables.write(iter(rows), axes, text, packed)
        assert (tmp_path / "r.csv").read_bytes() == tables.csv_bytes(whole)
        assert pq.read_table(tmp_path / "r.parquet").equals(whole, check_metadata=True)
        if group >= len(rows):
            assert (tmp_path / "r.parquet").read_bytes() == tables.parquet_bytes(whole)
    with (tmp_path / "r.csv").open("wb") as text, (tmp_path / "r.parquet").open("wb") as packed:
        tables.write([], axes, text, packed)
    assert (tmp_path / "r.parquet").read_bytes() == tables.parquet_bytes(tables.table([], axes))


def crowd(number, cells):
    draw = random.Random(3)
    for n in range(number):
        clearance = draw.choice([math.nan, round(draw.uniform(-9.0, 9.0), 1)])
        cell = n * cells // number
        who = {"cell": f"cell {cell}", "labels": {"axis": str(cell), "method.kind": "none"}, "replicate": n % (number // cells)}
        yield fakes.metrics_row(f"{n:012x}") | who | {"least_clearance_m": clearance, "max_bank_deg": draw.uniform(0.0, 60.0)}


def test_what_the_page_lists_is_what_all_rows_would_give(monkeypatch):
    monkeypatch.setattr(gathered, "MOST_FLIGHT_ROWS", 300)
    monkeypatch.setattr(gathered, "MOST_CELL_ROWS", 300)
    rows = list(crowd(4000, 500))
    of = gathered.gather(iter(rows))
    by_clearance = sorted(rows, key=lambda row: (math.isnan(row["least_clearance_m"]), row["least_clearance_m"]))  # stable
    assert [one.row()["flight_id"] for one in of.listed] == [row["flight_id"] for row in by_clearance[:300]]
    assert [one.row()["max_bank_deg"] for one in of.listed] == [row["max_bank_deg"] for row in by_clearance[:300]]
    assert (of.n, of.cells_in_all, len(of.cells)) == (4000, 500, 300)
    assert of.worst[False, "max_bank_deg"]["max_bank_deg"] == max(row["max_bank_deg"] for row in rows)
    assert list(of.cells["cell 7"].values["max_bank_deg"]) == [row["max_bank_deg"] for row in rows if row["cell"] == "cell 7"]
    assert (of.telling_axes, of.listed_axes) == (["axis"], ["axis"])


@pytest.mark.slow
def test_the_page_of_many_flights_and_failures_is_cut_and_says_so(tmp_path, monkeypatch):
    """Three hundred crowded cells have three hundred histograms of each metric; the crashes have long tracebacks."""
    text = "x" * 40_000
    rows = [
        row | ({"outcome": "crashed", "message": f"no. {n}", "traceback": text} if n % 20 == 0 else {})
        for n, row in enumerate(crowd(9000, 400))
    ]
    page = render_page(load_campaign(written(tmp_path)), iter(rows), {}, {})
    assert len(page.encode()) < 2_500_000  # to which the library that draws adds 2 MB, and 64 flights' curves half of one
    assert "more are in" not in page
    monkeypatch.setattr(gathered, "MOST_FLIGHT_ROWS", 300)
    monkeypatch.setattr(gathered, "MOST_CELL_ROWS", 300)
    page = render_page(load_campaign(written(tmp_path)), iter(rows), {}, {})
    assert "100 more cells are in" in page
    assert "8700 more are in" in page
    assert page.count("Of 150 more cells there is no picture.") == 2  # of clearance, and of bank
    assert page.count('<details class="failure">') == 50
    assert "400 more flights failed to run" in page


@pytest.mark.slow
def test_the_estimate_is_near_what_a_run_writes(tmp_path):
    sweep = "sweep: {method.kind: [none, scoam], speed_mps: [45, 50]}\n"
    file = written(tmp_path, CAMPAIGN.partition("sweep:")[0].replace("recordings: none", "recordings: selected") + sweep)
    overrides = ("replicates=30", "columns=selected")
    campaign = load_campaign(file, overrides)
    counted = estimate.count(campaign)
    assert (counted.flights, counted.cells, counted.recordings, counted.columns) == (120, {"": 4}, 4, 4)
    of = estimate.estimate(campaign, counted, 1)
    assert (of.flown, of.said) == (estimate.SAMPLE, "")
    out = runner.run(Order(file, LocalEngine(1), tmp_path / "out", overrides)).directory
    really = {}
    for path in out.rglob("*"):
        name = path.relative_to(out).parts[0]
        really[name] = really.get(name, 0) + (path.stat().st_size if path.is_file() else 0)
    assert {name: (size, really[name]) for name, size in of.bytes.items() if not 0.75 < size / really[name] < 1.25} == {}
    assert set(of.bytes) == set(really) - {".lock", "campaign.yaml", "manifest.json", "answer.json", "index.html"}
    assert really["index.html"] < 5_000_000


def test_an_estimate_counts_what_is_stored_of_which_flight(tmp_path):
    parts = "parts:\n  a: {recordings: all, columns: none, replicates: 3}\n  b: {recordings: selected, columns: all, replicates: 5}\n"
    sweep = "  c: {recordings: none, columns: selected, replicates: 2, sweep: {speed_mps: [30, 31, 32, 33, 34, 35, 36, 37, 38]}}\n"
    campaign = load_campaign(written(tmp_path, CAMPAIGN.partition("sweep:")[0].replace("recordings: none\n", "") + parts + sweep))
    counted = estimate.count(campaign)
    assert (counted.flights_of, counted.cells) == ({"a": 3, "b": 5, "c": 18}, {"a": 1, "b": 1, "c": 9})
    assert (counted.recordings, counted.columns) == (3 + 1, 5 + 9)
    assert len(counted.sample) == estimate.SAMPLE
    assert [plan.cell for plan in counted.sample] == ["a", "c/30", "c/34", "c/38"]


def test_a_flight_of_the_sample_that_never_ends_is_told(monkeypatch):
    monkeypatch.setattr(estimate, "run_job", time.sleep)
    monkeypatch.setattr(estimate, "LONGEST_S", 0.5)
    begun = time.monotonic()
    assert estimate._flown([600.0]) == []
    assert time.monotonic() - begun < 60.0


def test_the_engine_of_the_tests_pulls_lazily():
    """Otherwise the bound on memory above would be one of the test's own making."""
    pulled = []
    stream = Here().imap(lambda x: x, (pulled.append(k) or k for k in range(9)))
    next(stream)
    assert pulled == [0]
    assert attempt(str, 1) == "1"
