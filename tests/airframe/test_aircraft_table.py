"""docs/aircraft.md is what its script writes: a row for each of its models, a count that adds up, and most of them fly."""

import re
import runpy
from pathlib import Path

from testbed.core.model_files import wheel_models

DOCS = Path(__file__).resolve().parents[2] / "docs"


def test_the_table_has_a_row_for_every_model_and_counts_those_that_fly() -> None:
    models = runpy.run_path(str(DOCS / "make_aircraft.py"))["MODELS"]
    assert set(models) <= set(wheel_models())
    text = (DOCS / "aircraft.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("| ")][1:]
    assert [row[0] for row in rows if row[0] != "---"] == list(models)
    number = re.compile(r"\d+\.\d+")
    flown = [row for row in rows if number.fullmatch(row[4]) and number.fullmatch(row[5])]
    assert f"{len(flown)} of {len(models)} fly it" in text
    assert len(flown) >= 15
    assert all(row[-1] for row in rows), "the rest with the reason"
