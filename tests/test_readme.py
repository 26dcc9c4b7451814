"""The README's Python runs, and its commands exist."""

import re
from pathlib import Path

import pandas as pd
import pytest
from typer import Context
from typer.main import get_command

from testbed.cli import app

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


@pytest.mark.parametrize("block", re.findall(r"^```python\n(.*?)^```", README, re.M | re.S))
def test_its_python_runs(block: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    exec(compile(block, "README.md", "exec"), {})
    assert capsys.readouterr().out.strip()


def test_its_commands_exist() -> None:
    named = set(get_command(app).list_commands(Context(get_command(app))))  # type: ignore[attr-defined]
    asked = set(re.findall(r"^testbed ([\w-]+)", README, re.M))
    assert asked <= named
    assert {"run", "validate", "report", "replay", "bench", "audit"} <= asked


def test_the_files_it_names_are_there() -> None:
    for name in re.findall(r"\]\((?!http)([^)#]+)\)", README) + re.findall(r"campaigns/[\w/]+\.yaml", README):
        assert (ROOT / name).exists(), name


TABLE = [
    "words.single.safe",
    "words.single.flyable",
    "words.multi.safe",
    "words.deflection_least",
    "words.path_shortest",
    "words.time_least",
    "words.online",
    "words.superior",
    "words.overload",
]
"""Keys of verdict.csv in the order of the README's table."""


def figures(cell: str) -> list[str]:
    """Every number of a cell as it is written: ``-5.4 to -2.2 m`` gives ``-5.4`` and ``-2.2``."""
    return re.findall(r"-?\d+(?:\.\d+)?", cell)


def as_written(value: float, like: str) -> str:
    """A value with as many decimals as the written one; no minus before a zero."""
    decimals = len(like.partition(".")[2])
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def test_its_table_is_the_verdict_that_is_published() -> None:
    """Each figure, word, limit and share of the table is that of reports/paper/verdict.csv, as rounded there."""
    verdict = pd.read_csv(ROOT / "reports/paper/verdict.csv").set_index("key").to_dict("index")
    (table,) = re.findall(r"^\| claim .*?\n\| ---.*?\n(.*?)\n\n", README, re.M | re.S)
    lines = table.splitlines()
    assert len(lines) == len(TABLE)
    for key, line in zip(TABLE, lines, strict=True):
        claim = verdict[key]
        _, *cells, word, limit, robustness = (cell.strip() for cell in line.strip("|").split("|"))
        columns = [["kinematic"], ["point_mass"], ["flown_calm"], ["flown_air_p05", "flown_air_p95"]]
        for cell, names in zip(cells, columns, strict=True):
            values = [float(claim[name]) for name in names if pd.notna(claim[name])]
            written = figures(cell)
            assert written == [as_written(value, like) for value, like in zip(values, written, strict=True)], (key, cell)
        condition = claim["condition"]
        assert word == f"**{claim['word']}**" + ("" if pd.isna(condition) else f" {condition}"), key
        assert limit == ("-" if pd.isna(claim["deciding_limit"]) else claim["deciding_limit"]), key
        share = "-" if claim["robustness_n"] == 0 else f"{100.0 * claim['robustness_share']:.0f} %"
        assert robustness == share, key
