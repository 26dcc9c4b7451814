"""Try many cases: ``python -m tests.fuzz.run``. Exit code 1 when something fell; each finding is told with what tries it again.

``--kind yaml --count 500``: so many of one kind; ``--only 17``: that one alone, its files kept in ``--folder``.
"""

import argparse
import shutil
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from tests.fuzz.cases import KINDS, attempt
from tests.fuzz.workers import Item, Tried, tried

LONG = {"yaml": 20_000, "set": 3_000, "flown": 3_000, "aircraft": 600}
SHORT = {"yaml": 60, "set": 20, "flown": 12, "aircraft": 4}
SEED = 1


def items(counts: dict[str, int], seed: int, first: int = 0) -> list[Item]:
    """The cases, those that take long first."""
    return [(kind, seed, number) for kind in reversed(counts) for number in range(first, first + counts[kind])]


def told(one: Tried) -> str:
    kind, seed, number = one.item
    again = f"python -m tests.fuzz.run --kind {kind} --seed {seed} --only {number}"
    return "".join(f"{fault}\n" for fault in one.faults) + f"    {again}"


def main() -> int:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz.run", description=__doc__)
    parser.add_argument("--kind", choices=list(KINDS), help="one kind alone")
    parser.add_argument("--count", type=int, help="cases of each kind")
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--only", type=int, metavar="N", help="the case with this number, in this process; needs --kind")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--folder", type=Path, help="where cases keep their files; default a folder that is removed")
    asked = parser.parse_args()
    if asked.only is not None:
        return only(asked.kind, asked.seed, asked.only, asked.folder or Path(tempfile.mkdtemp(prefix="fuzz-")))
    counts = {kind: asked.count or LONG[kind] for kind in KINDS if asked.kind in (None, kind)}
    folder = asked.folder or Path(tempfile.mkdtemp(prefix="fuzz-"))
    try:
        return many(items(counts, asked.seed, asked.first), folder, asked.workers)
    finally:
        if not asked.folder:
            shutil.rmtree(folder, ignore_errors=True)


def only(kind: str | None, seed: int, number: int, folder: Path) -> int:
    """One case, told at length."""
    if kind is None:
        print("--only needs --kind", file=sys.stderr)
        return 2
    came_to, faults = attempt(kind, seed, number, folder)
    print(f"{kind} {number} of seed {seed}: {came_to or 'nothing'}; its files: {folder}")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


def many(cases: list[Item], folder: Path, workers: int) -> int:
    """All of them; a summary for each kind at the end."""
    began = time.monotonic()
    came_to: dict[str, Counter[str]] = {}
    fell, most_mb = 0, 0.0
    for one in tried(cases, folder, workers):
        kind = one.item[0]
        came_to.setdefault(kind, Counter())[one.came_to.partition(",")[0] or "nothing"] += 1
        most_mb = max(most_mb, one.rss_mb)
        if one.faults:
            fell += 1
            print(f"{kind} {one.item[2]}: {told(one)}", flush=True)
    for kind, counted in came_to.items():
        print(f"{kind}: {counted.total()} cases: " + ", ".join(f"{n} {what}" for what, n in counted.most_common()))
    print(f"{fell} of {len(cases)} fell; {time.monotonic() - began:.0f} s; at most {most_mb:.0f} MB")
    return 1 if fell else 0


if __name__ == "__main__":
    sys.exit(main())
