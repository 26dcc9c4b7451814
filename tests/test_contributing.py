"""CONTRIBUTING is true: its files exist, its walks can be walked, its YAML loads, and its Python is a part that keeps its promises."""

import ast
import itertools
import re
from pathlib import Path
from typing import NamedTuple

import pytest

from testbed import expand, load_campaign
from testbed.contracts.check import check

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "CONTRIBUTING.md").read_text()
WALKS = dict(re.findall(r"^### (.+?)\n\n((?:\d\. .+\n)+)", TEXT.partition("## Three walks")[2].partition("\n## ")[0], re.M))
STEP = re.compile(r"^\d\. `(?P<file>[\w/.]+\.py)`: `(?P<symbol>\w+)`[^\n]*?(?:hands on `(?P<name>\w+)`)?\.$", re.M)
MOST_FILES = 5


class Stage(NamedTuple):
    """A step of a walk; ``hands_on`` is the word to look for in the next file, empty at the end."""

    file: Path
    symbol: str
    hands_on: str


def stages(walk: str) -> list[Stage]:
    return [Stage(ROOT / found["file"], found["symbol"], found["name"] or "") for found in STEP.finditer(WALKS[walk])]


def names_in(tree: ast.AST) -> set[str]:
    """Every name of a module's top level."""
    found = {getattr(node, "name", "") for node in ast.iter_child_nodes(tree)}
    return found | {
        target.id for node in ast.walk(tree) if isinstance(node, ast.Assign) for target in node.targets if isinstance(target, ast.Name)
    }


def test_there_are_three_walks() -> None:
    assert len(WALKS) == 3
    for walk, lines in WALKS.items():
        assert len(stages(walk)) == lines.count("\n"), f"{walk}: every line is a step"
        assert all(stage.hands_on for stage in stages(walk)[:-1])


@pytest.mark.parametrize("walk", WALKS)
def test_a_walk_can_be_walked(walk: str) -> None:
    way = stages(walk)
    assert len({stage.file for stage in way}) <= MOST_FILES
    for stage in way:
        assert stage.file.exists(), stage.file
        assert stage.symbol in names_in(ast.parse(stage.file.read_text())), f"{stage.file.name} has no {stage.symbol}"
    for stage, following in itertools.pairwise(way):
        for file in (stage.file, following.file):
            assert re.search(rf"\b{stage.hands_on}\b", file.read_text()), f"'{stage.hands_on}' is not in {file.name}"


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
