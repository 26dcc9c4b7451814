"""The README's Python runs, and its commands exist."""

import re
from pathlib import Path

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
