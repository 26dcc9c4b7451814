"""CONTRIBUTING is true: its files exist, its walks can be walked, its YAML loads, and its Python is a part that keeps its promises."""

import ast
import itertools
import re
from pathlib import Path

import pytest

from testbed import expand, load_campaign
from testbed.contracts.check import check

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "CONTRIBUTING.md").read_text()
WALKS = dict(re.findall(r"^### (.+?)\n\n((?:\d\. .+\n)+)", TEXT.partition("## Three walks")[2].partition("\n## ")[0], re.M))
STEP = re.compile(r"^\d\. `(?P<file>[\w/.]+\.py)`: `(?P<symbol>[\w.]+)`", re.M)
MOST_FILES = 5


def steps(walk: str) -> list[tuple[Path, str]]:
    return [(ROOT / found["file"], found["symbol"]) for found in STEP.finditer(WALKS[walk])]


def defined(tree: ast.AST, symbol: str) -> bool:
    """``Class.member`` or a name of the module."""
    name, _, rest = symbol.partition(".")
    for node in ast.iter_child_nodes(tree):
        names = [getattr(node, "name", None)]
        if isinstance(node, ast.Assign):
            names = [target.id for target in node.targets if isinstance(target, ast.Name)]
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names = [node.target.id]
        if name in names:
            return not rest or defined(node, rest)
    return False


def module(file: Path) -> str:
    return ".".join(file.relative_to(ROOT).with_suffix("").parts)


def knows(file: Path, other: Path) -> bool:
    """Does a file import the other, or plug it in by its name?"""
    text = file.read_text()
    package, _, name = module(other).rpartition(".")
    return module(other) in text or f"from {package} import {name}" in text


def linked(first: Path, second: Path) -> bool:
    tables = [folder / "__init__.py" for folder in (first.parent, second.parent)]
    return first == second or knows(first, second) or knows(second, first) or any(knows(table, second) for table in tables)


def test_there_are_three_walks() -> None:
    assert len(WALKS) == 3
    assert all(len(steps(walk)) == walk_lines.count("\n") for walk, walk_lines in WALKS.items()), "every line is a step"


@pytest.mark.parametrize("walk", WALKS)
def test_a_walk_can_be_walked(walk: str) -> None:
    way = steps(walk)
    assert len({file for file, _ in way}) <= MOST_FILES
    for file, symbol in way:
        assert file.exists(), file
        assert defined(ast.parse(file.read_text()), symbol), f"{file.name} has no {symbol}"
    for (first, _), (second, _) in itertools.pairwise(way):
        assert linked(first, second), f"{first.name} and {second.name} do not know each other"


def test_the_files_it_names_are_there() -> None:
    named = set(re.findall(r"`((?:testbed|vosc|aircraft|campaigns|tests|reports|docs)/[\w/.]*)`", TEXT))
    assert len(named) > 20
    missing = [name for name in named if not (ROOT / name).exists()]
    assert not missing
    links = re.findall(r"\]\((?!http)([^)#]+)\)", TEXT)
    assert not [name for name in links if not (ROOT / name).exists()]


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", TEXT, re.M | re.S)


def test_its_python_is_a_method_that_keeps_its_promises(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (source,) = blocks("python")
    Path("mine.py").write_text(source)
    kept, lines = check("method", "mine:avoid", {})
    assert kept, "\n".join(lines)


def test_its_yaml_loads(tmp_path: Path) -> None:
    base = (ROOT / "campaigns" / "paper_single.yaml").read_text().partition("sweep:")[0]
    yamls = blocks("yaml")
    assert yamls
    for number, text in enumerate(yamls):
        file = tmp_path / f"{number}.yaml"
        file.write_text(re.sub(r"^(replicates|recordings):.*\n", "", base, flags=re.M) + text)
        assert expand(load_campaign(file))
