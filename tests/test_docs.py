"""The generated page of the columns is up to date, and its commands run."""

import importlib.util
import re
from pathlib import Path

from testbed.flight.record.signals import SIGNALS
from testbed.results.columns import COLUMNS

DOCS = Path(__file__).parents[1] / "docs"


def test_the_page_of_the_columns_is_what_is_declared() -> None:
    spec = importlib.util.spec_from_file_location("make_results", DOCS / "make_results.py")
    assert spec is not None
    assert spec.loader is not None
    make = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(make)
    page = (DOCS / "results.md").read_text(encoding="utf-8")
    assert page == make.text(), "write it again: make docs"
    listed = re.findall(r"^\| `([^`]+)`", page, re.M)
    assert listed == [*(column.name for column in COLUMNS), *(signal.name for signal in SIGNALS)]
