"""What is generated in docs/ is up to date."""

import importlib.util
import re
import sys
from pathlib import Path
from typing import Any

from PIL import Image

from testbed.flight.record.signals import SIGNALS
from testbed.results.columns import COLUMNS
from testbed.results.daa.columns import DAA_METRICS, volume_columns

DOCS = Path(__file__).parents[1] / "docs"


def made_by(name: str) -> Any:
    """A script of docs/, imported."""
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    sys.modules[name] = make = importlib.util.module_from_spec(spec)  # where dataclasses look for it
    spec.loader.exec_module(make)
    return make


def test_the_page_of_the_columns_is_what_is_declared() -> None:
    make = made_by("make_results")
    page = (DOCS / "results.md").read_text(encoding="utf-8")
    assert page == make.text(), "write it again: make docs"
    listed = re.findall(r"^\| `([^`]+)`", page, re.M)
    of_daa = (*DAA_METRICS, *volume_columns("<volume>", ""))
    assert listed == [*(column.name for column in (*COLUMNS, *of_daa)), *(signal.name for signal in SIGNALS)]


def test_the_gallery_is_what_its_command_writes_and_stays_small() -> None:
    make = made_by("make_gallery")
    assert (DOCS / "gallery.html").read_text(encoding="utf-8") == make.page_text(), "write it again: make gallery"
    assert make.too_large() == []
    assert {file.name for file in make.PICTURES.iterdir()} == {one.file.name for one in make.ALL}
    for one in make.ALL:
        with Image.open(one.file) as picture:
            assert picture.width > 700, one.name
            assert (getattr(picture, "n_frames", 1) > 20) == (one is make.FILM), one.name
