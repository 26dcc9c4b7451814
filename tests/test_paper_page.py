"""docs/paper.md names files, functions and tests that exist; and what it says of equation 23 is so."""

import ast
import math
import re
from pathlib import Path

import numpy as np

from testbed.cli import app
from testbed.studies import COMMANDS

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")


def rows(heading: str) -> list[list[str]]:
    section = PAGE.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def test_what_is_named_exists() -> None:
    named = re.findall(r"`([\w/]+\.py)::(\w+)`", PAGE)
    assert len(named) > 50
    for file, name in named:
        body = ast.parse((ROOT / file).read_text(encoding="utf-8")).body
        assert name in {node.name for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef)}, f"{file}::{name}"
    commands = {command.name or command.callback.__name__.replace("_", "-") for command in app.registered_commands if command.callback}
    for command in re.findall(r"`testbed (\w+)", PAGE):
        assert command in commands | set(COMMANDS), command
    for file in re.findall(r"`(docs/[\w/]+\.md|campaigns/[\w.]+)`", PAGE) + re.findall(r"testbed run ([\w/.]+)", PAGE):
        assert (ROOT / file).exists(), file


def test_every_equation_and_every_reference_has_a_row_and_no_cell_is_empty() -> None:
    equations = {int(n) for row in rows("Equations and steps") for a, b in spans(row[0], r"\(") for n in range(a, b + 1)}
    assert equations == set(range(1, 36))
    references = [n for row in rows("References") for a, b in spans(row[0], r"\[") for n in range(a, b + 1)]
    assert references == list(range(1, 25))
    assert all(cell for heading in ("Equations and steps", "Tables and figures", "References") for row in rows(heading) for cell in row)


def spans(text: str, bracket: str) -> list[tuple[int, int]]:
    found = re.findall(bracket + r"(\d+)[)\]](?:-" + bracket + r"(\d+)[)\]])?", text)
    return [(int(first), int(last or first)) for first, last in found]


def test_equation_23_turns_against_21_and_22() -> None:
    """Its matrices, the first on (x, y) and the second on (horizontal, z), take v_u to azimuth psi - delta psi, elevation theta - delta."""

    def printed(angle: float) -> np.ndarray:
        return np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])

    azimuth, elevation, d_azimuth, d_elevation = np.radians([24.7, 12.0, 11.9, 1.2])
    x, y = printed(d_azimuth) @ [math.cos(azimuth), math.sin(azimuth)]
    assert abs(math.atan2(y, x) - (azimuth - d_azimuth)) < 1e-12
    flat, z = printed(d_elevation) @ [math.cos(elevation), math.sin(elevation)]
    assert abs(math.atan2(z, flat) - (elevation - d_elevation)) < 1e-12
