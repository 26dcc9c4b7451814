"""The data sheet says what the aircraft does, and stands alone."""

import re
from pathlib import Path

import numpy as np
import pytest

from testbed.airframe.chart import Line, chart, ticks
from testbed.airframe.data_sheet import number, write_data_sheet
from tests.command import testbed


@pytest.mark.slow
def test_page_of_gtm_t2_has_its_figures_and_needs_no_network(tmp_path: Path) -> None:
    file = write_data_sheet("gtm_t2", tmp_path / "sheets")
    assert file == tmp_path / "sheets" / "gtm_t2.html"
    page = file.read_text()
    for figure in ("28.7 m/s", "20.25 deg", "8.98 rad/s", "7.17", "3.94 g", "JSBSim", "NASA Open Source Agreement"):
        assert figure in page
    assert not re.findall(r"""(?:src|href)=["'](?!#)""", page)
    assert "nan" not in re.sub(r"<[^>]+>", " ", page).lower().split()
    done = testbed("aircraft", "gtm_t2", "--out", "again", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "again/gtm_t2.html\n")
    assert file.read_bytes() == (tmp_path / "again" / "gtm_t2.html").read_bytes()


def test_ticks_are_round_and_span_the_range() -> None:
    assert ticks(0.13, 0.87, 5) == [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
    assert ticks(-3.0, 41.0, 6) == [-10.0, 0.0, 10.0, 20.0, 30.0, 40.0, 50.0]
    assert ticks(2.0, 2.0, 4)


def test_a_gap_in_a_curve_is_a_gap() -> None:
    svg = chart([Line(np.arange(6.0), np.array([1, 2, np.nan, 3, 4, 5]), "a<b")], "x", "y")
    assert svg.count("<polyline") == 2
    assert "a&lt;b" in svg


def test_numbers_have_a_real_minus() -> None:
    assert number(-1.25, 1) == "\u22121.2"
    assert number(float("nan"), 2) == "\u2013"
