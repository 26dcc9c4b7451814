"""The pages of the methods: complete, and with the pictures their script draws."""

import importlib.util
import re
from pathlib import Path

import pytest

from vosc.methods import METHODS

PAGES = Path(__file__).parents[2] / "docs" / "methods"


def script(path: Path):
    spec = importlib.util.spec_from_file_location(f"docs_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def make():
    return script(PAGES / "make.py")


def check_current(file: Path, picture: str) -> None:
    """A last digit may round otherwise elsewhere."""
    drawn = file.read_text(encoding="utf-8")
    numbers = [[float(x) for x in re.findall(r"-?\d+\.\d+", text)] for text in (drawn, picture)]
    assert numbers[0] == pytest.approx(numbers[1], abs=0.11)
    assert re.sub(r"-?\d+\.\d+", "", drawn) == re.sub(r"-?\d+\.\d+", "", picture)


@pytest.mark.parametrize("method", METHODS)
def test_page_has_its_parts_and_its_picture_is_current(method, make):
    page = (PAGES / f"{method}.md").read_text(encoding="utf-8")
    assert page.startswith(f"# {method}\n")
    assert f"]({method}.svg)" in page
    for part in ("**Assumes.**", "**Formula.**", "**Notes.**"):
        assert part in page
    check_current(PAGES / f"{method}.svg", make.picture(method))


def test_the_picture_of_the_insertion_pose_is_current_and_says_what_the_table_says():
    pose = script(PAGES.parent / "insertion_pose.py")
    check_current(PAGES.parent / "insertion_pose.svg", pose.picture())
    (_, _, _, _, quintic), (_, _, _, _, widest) = pose.curves()
    page = (PAGES.parent / "insertion_pose.md").read_text(encoding="utf-8")
    assert f"PH quintic, {1.0 / quintic.max():.1f} m at its tightest" in page
    assert f"widest curve, {1.0 / widest.max():.1f} m]" in page


@pytest.mark.slow
def test_table_has_every_method_and_a_small_run_agrees_with_it(make):
    text = (PAGES / "rates.md").read_text(encoding="utf-8")
    assert all(f"[{m}]({m}.md)" in text for m in METHODS)
    assert f"{make.ENCOUNTERS} random encounters, seed {make.SEED}" in text
    share = {}
    for line in text.splitlines():
        cells = [c.strip() for c in line.strip("|").split("|")]
        if cells[0].startswith("["):
            share[cells[0]] = [float(c) for c in cells[1:5]]
    tallies = make.measure(120)
    for (method, options), tally in zip(make.CASES, tallies, strict=True):
        name = " ".join(filter(None, (f"[{method}]({method}.md)", ", ".join(f"{k}={v}" for k, v in options.items()))))
        unsafe = 100 * tally.several["unsafe"] / tally.several.total()
        assert unsafe == pytest.approx(share[name][2], abs=18)  # 100 draws: 4 standard deviations


def test_index_links_every_page():
    index = (PAGES / "README.md").read_text(encoding="utf-8")
    assert all(f"]({m}.md)" in index for m in METHODS)
