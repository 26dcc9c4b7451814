"""Do the tests notice a fault? Changes one place of the code at a time and runs the tests that pass through it: ``make mutants``.

A *mutant* is the project with one operator, number or word changed. Killed: some test fails or hangs. Survived: none does, so
either the change does not matter or a test is missing. Each wing is judged by the tests of its own folder; which of them pass
through which line is measured once, by coverage.py; the changes are those of cosmic-ray. The mutants are drawn from the seed, a
share from each wing of the house; the same seed
draws the same from the same code. Each is tried in a copy of the project, so nothing here is touched.
"""

import argparse
import csv
import difflib
import json
import os
import random
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue

ROOT = Path(__file__).parents[2]
WINGS = ("testbed/flight", "testbed/results", "vosc")
LONGEST_S = 300
"""The tests of one mutant; what takes longer hangs."""
MOST_TESTS = 40
"""The quickest that pass through the line: the others would say the same later."""
COPIED = (
    "testbed",
    "vosc",
    "tests",
    "aircraft",
    "campaigns",
    "docs",
    "reports",
    "pyproject.toml",
    "README.md",
    "CONTRIBUTING.md",
    "Makefile",
)
NOT_COPIED = shutil.ignore_patterns("runs", "__pycache__", ".hypothesis", "*.rrd")
SAME_MEANING = ("BitOr", "ReplaceBinaryOperator_BitOr", "AddDecorator", "RemoveDecorator", "VariableInserter", "VariableReplacer")
"""Changes that a type annotation or an import already refuses, or that need arguments."""


@dataclass(frozen=True)
class Mutant:
    """One change: the file, the operator of cosmic-ray and which of its places; ``line`` is where."""

    path: str
    operator: str
    occurrence: int
    line: int


def main() -> int:
    """Draw, try, tell. Exit code 1 when one survived that ``explained.csv`` does not name."""
    asked = _asked()
    with tempfile.TemporaryDirectory(prefix="mutants-") as scratch:
        passes = _passing_through(asked, Path(scratch))
        drawn = _drawn(asked.count, asked.seed)
        copies: SimpleQueue[Path] = SimpleQueue()
        for number in range(asked.workers):
            copies.put(_copy(Path(scratch) / f"copy{number}"))

        def tried(mutant: Mutant) -> tuple[Mutant, str, str]:
            copy = copies.get()
            try:
                result = _tried(mutant, copy, asked.python, passes)
            finally:
                copies.put(copy)
            print(f"{result[0]:10} {mutant.path}:{mutant.line} {mutant.operator}", file=sys.stderr, flush=True)
            return mutant, *result

        with ThreadPoolExecutor(asked.workers) as pool:
            results = list(pool.map(tried, drawn))
    return _told(results, asked.out)


def _asked() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=210, help="mutants in all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--python", default=sys.executable, help="the interpreter that has the project's packages and coverage")
    parser.add_argument("--map", type=Path, default=None, help="keep which test passes through which line here, and use it if there")
    parser.add_argument("--out", type=Path, default=Path("reports/runs/mutants.csv"))
    return parser.parse_args()


# ---------------------------------------------------------------------------------------------------------- which tests


Passing = dict[str, dict[str, list[str]]]
"""File -> line number as text -> tests that pass through it, ``tests/.../test_x.py::test_y``, the quickest first."""


def _passing_through(asked: argparse.Namespace, scratch: Path) -> Passing:
    if asked.map and asked.map.exists():
        known: Passing = json.loads(asked.map.read_text())
        return known
    settings, data = scratch / "coveragerc", scratch / "coverage"
    settings.write_text(f"[run]\ndynamic_context = test_function\nsource = testbed\n    vosc\ndata_file = {data}\n")
    command = [
        asked.python,
        "-m",
        "coverage",
        "run",
        f"--rcfile={settings}",
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "--durations=0",
    ]
    folders = [f"tests/{wing.removeprefix('testbed/')}" for wing in WINGS]
    done = subprocess.run([*command, *folders, "-m", "not browser and not viewer"], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"the tests fail before anything is changed:\n{done.stdout[-3000:]}")
    passes = _read_contexts(data, _durations(done.stdout))
    if asked.map:
        asked.map.write_text(json.dumps(passes))
    return passes


def _durations(told: str) -> Counter[str]:
    """Seconds that each test function took, all its parameters together."""
    seconds: Counter[str] = Counter()
    for line in told.splitlines():
        words = line.split()
        if len(words) == 3 and words[1] in ("call", "setup") and words[0].endswith("s"):
            seconds[words[2].split("[")[0]] += float(words[0][:-1])
    return seconds


def _read_contexts(data: Path, seconds: Counter[str]) -> Passing:
    """From coverage.py's own file: ``numbits`` is a bit for each line."""
    found: dict[str, dict[str, set[str]]] = {}
    query = (
        "SELECT file.path, context.context, line_bits.numbits FROM line_bits "
        "JOIN file ON file.id = line_bits.file_id JOIN context ON context.id = line_bits.context_id"
    )
    with sqlite3.connect(data) as base:
        for path, context, bits in base.execute(query):
            name = _node(context)
            if name is None:
                continue
            lines = found.setdefault(str(Path(path).relative_to(ROOT)), {})
            for number, byte in enumerate(bits):
                for bit in range(8):
                    if byte >> bit & 1:
                        lines.setdefault(str(number * 8 + bit), set()).add(name)
    return {path: {line: sorted(names, key=lambda n: (seconds[n], n)) for line, names in lines.items()} for path, lines in found.items()}


def _node(context: str) -> str | None:
    """``tests.flight.test_air.test_x`` as pytest names it; a class has a capital."""
    parts = context.split(".")
    if parts[0] != "tests":
        return None
    file = next((k for k, part in enumerate(parts) if part.startswith("test_")), None)
    return None if file is None or file + 1 >= len(parts) else "::".join(["/".join(parts[: file + 1]) + ".py", *parts[file + 1 :]])


def _tests_of(mutant: Mutant, passes: Passing) -> list[str]:
    """A line that runs at import belongs to no test: then those of the whole file."""
    lines = passes.get(mutant.path, {})
    return lines.get(str(mutant.line)) or sorted({name for names in lines.values() for name in names})


# ---------------------------------------------------------------------------------------------------------- the mutants


def _drawn(count: int, seed: int) -> list[Mutant]:
    draw = random.Random(seed)
    chosen: list[Mutant] = []
    for number, wing in enumerate(WINGS):
        share = count * (number + 1) // len(WINGS) - count * number // len(WINGS)
        there = [m for path in sorted((ROOT / wing).rglob("*.py")) for m in _mutants_of(path)]
        chosen += draw.sample(there, min(share, len(there)))
    return chosen


def _mutants_of(path: Path) -> Iterator[Mutant]:
    from cosmic_ray.ast import ast_nodes, get_ast_from_path
    from cosmic_ray.plugins import get_operator, operator_names

    tree = get_ast_from_path(path)
    for name in sorted(operator_names()):
        if any(part in name for part in SAME_MEANING):
            continue
        places = (place for node in ast_nodes(tree) for place in get_operator(name)().mutation_positions(node))
        for occurrence, (start, _) in enumerate(places):
            yield Mutant(str(path.relative_to(ROOT)), name, occurrence, start[0])


def _copy(folder: Path) -> Path:
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=NOT_COPIED)
        else:
            folder.mkdir(exist_ok=True)
            shutil.copy(source, folder / name)
    return folder


def _tried(mutant: Mutant, copy: Path, python: str, passes: Passing) -> tuple[str, str]:
    """How it ended, and the change as a diff."""
    from cosmic_ray.mutating import mutate_code
    from cosmic_ray.plugins import get_operator

    file = copy / mutant.path
    before = file.read_text(encoding="utf-8")
    after = mutate_code(before, get_operator(mutant.operator)(), mutant.occurrence)
    tests = _tests_of(mutant, passes)[:MOST_TESTS]
    change = "".join(difflib.unified_diff(before.splitlines(True), (after or "").splitlines(True), n=0)).split("\n", 2)[-1]
    if not tests:
        return "no test", change
    file.write_text(after or before, encoding="utf-8")
    try:
        # without the compiled files of the change before: they may have the same second and size
        environment = os.environ | {
            "PYTHONPATH": str(copy),
            "PYTHONDONTWRITEBYTECODE": "1",
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
        }
        command = [python, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
        done = subprocess.run(command, cwd=copy, env=environment, timeout=LONGEST_S, capture_output=True, check=False)
        return ("survived" if done.returncode == 0 else "killed"), change
    except subprocess.TimeoutExpired:
        return "hung", change
    finally:
        file.write_text(before, encoding="utf-8")


# ---------------------------------------------------------------------------------------------------------- what came out


def _told(results: list[tuple[Mutant, str, str]], out: Path) -> int:
    explained = {(row["path"], row["change"]) for row in csv.DictReader((Path(__file__).parent / "explained.csv").open(encoding="utf-8"))}
    out.parent.mkdir(parents=True, exist_ok=True)
    with out.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["path", "line", "operator", "ended", "change"])
        writer.writerows([m.path, m.line, m.operator, ended, change] for m, ended, change in results)
    print(dict(Counter(ended for _, ended, _ in results)), f"of {len(results)}; all of them in {out}")
    alive = [(m, change) for m, ended, change in results if ended in ("survived", "no test")]
    unexplained = [(m, change) for m, change in alive if (m.path, _short(change)) not in explained]
    for mutant, change in unexplained:
        print(f"\n{mutant.path}:{mutant.line} survived ({mutant.operator})\n{change}")
    return 1 if unexplained else 0


def _short(change: str) -> str:
    """The changed lines without where they are, so that an explanation outlives an edit above."""
    return " -> ".join(line[1:].strip() for line in change.splitlines() if line[:1] in "+-")


if __name__ == "__main__":
    raise SystemExit(main())
