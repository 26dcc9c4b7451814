"""A case by its kind and number: made from a seed, tried, judged. The same seed and number are the same case on every machine."""

import importlib
import json
import os
import random
import shutil
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from testbed.campaign import SpecError, expand, load_campaign
from testbed.core.catalogue import AIRCRAFT_ROOT, aircraft_beside
from testbed.run.job import Job, run_job
from tests.fuzz import campaigns, judge, texts

MOST_PLANS = 20_000
"""Larger campaigns are read and checked, and not expanded: that is for `limits` to say."""

FLOWN_OF_EACH = 2
TRIES = 12
"""A mutated campaign that is refused is drawn again, with fewer changes, so that most cases are flown."""


class Case:
    """One case at work: where it keeps its files, and what was wrong."""

    def __init__(self, kind: str, seed: int, number: int, folder: Path) -> None:
        self.rng = random.Random(f"{kind} {seed} {number}")
        self.folder = folder
        self.faults: list[str] = []
        self.came_to = ""
        """``refused``, ``valid``, or outcomes of flights."""
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)

    def write(self, content: bytes | str, name: str = "campaign.yaml") -> Path:
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8", "surrogatepass"))
        return path

    def read(self, file: Path, overrides: tuple[str, ...] = ()) -> Any:
        """What ``testbed validate`` does: a campaign and its plans, or a refusal that is judged."""
        try:
            with aircraft_beside(file.parent):
                campaign = load_campaign(file, overrides)
                size = campaign.replicates * max(1, len(campaign.sweep) + len(campaign.parts))
                plans = expand(campaign) if size <= MOST_PLANS else ()
        except SpecError as error:
            self.came_to = "refused"
            self.faults += judge.text_faults(str(error))
            return None
        self.came_to = "valid"
        return campaign, plans

    def fly(self, file: Path) -> None:
        """The first flights of a campaign, each to a row that is judged."""
        if (found := self.read(file)) is None:
            return
        campaign, plans = found
        outcomes = []
        with aircraft_beside(file.parent):
            for plan in list(plans)[:FLOWN_OF_EACH]:
                columns = self.folder / "columns" / f"{plan.flight_id}.parquet" if campaign.columns == "all" else None
                recording = self.folder / "recordings" / f"{plan.flight_id}.rrd" if campaign.recordings == "all" else None
                result = run_job(Job(plan, recording, want_series=True, check=campaign.check, columns_path=columns))
                self.faults += judge.row_faults(result)
                outcomes.append(result.row["outcome"])
        self.came_to = ",".join(outcomes)


def yaml(case: Case) -> None:
    """A shipped campaign's text, changed at random, is read."""
    case.read(case.write(texts.mutated(case.rng)))


def sets(case: Case) -> None:
    """A shipped campaign is read with one to three ``--set`` that are mostly wrong."""
    file = texts.a_file(case.rng)
    overrides = tuple(texts.override(case.rng) for _ in range(case.rng.choice([1, 1, 2, 3])))
    case.write(json.dumps(overrides), "overrides.json")
    case.read(file, overrides)


def flown(case: Case) -> None:
    """A campaign of drawn settings is flown; if it is refused, one with fewer changes."""
    for tried in range(TRIES):
        drawn = campaigns.mutated(case.rng, most=max(1, 8 - tried))
        file = case.write(json.dumps(drawn, indent=1))
        case.fly(file)
        if case.came_to != "refused":
            return


def aircraft(case: Case) -> None:
    """A copy of an aircraft whose files are changed is read and, where that is allowed, flown."""
    rng = case.rng
    source = AIRCRAFT_ROOT / rng.choice(["gtm_t2", "gtm_t2", "c172p", "t37"])
    folder = case.folder / "aircraft" / "odd"
    shutil.copytree(source, folder)
    files = sorted(file for file in folder.rglob("*") if file.suffix in (".yaml", ".xml"))
    for _ in range(rng.choice([1, 1, 2])):
        file = folder / "aircraft.yaml" if rng.random() < 0.6 else rng.choice(files)
        if file.exists():
            _spoil(rng, file)
    speed = {"t37": 100}.get(source.name, 50)
    plant = rng.choice(["jsbsim", "jsbsim", "point_mass"])
    case.fly(
        case.write(
            json.dumps(campaigns.plain() | {"aircraft": "odd", "speed_mps": speed, "plant": {"kind": plant}, "vary": {"gains_share": 0.1}})
        )
    )


def _spoil(rng: random.Random, file: Path) -> None:
    """Change a file of an aircraft: a value, a line, bytes, or the whole of it."""
    lines = file.read_text(encoding="latin-1").splitlines(keepends=True)
    how = rng.randrange(8)
    if how == 0 and rng.random() < 0.5:
        file.unlink()
        return
    at = rng.randrange(len(lines))
    if how == 1:
        del lines[at:]
    elif how == 2:
        del lines[at]
    elif how == 3:
        lines.insert(at, lines[rng.randrange(len(lines))])
    elif how == 4:
        lines[at] = lines[at].replace(":", "s:", 1) if file.suffix == ".yaml" else lines[at].replace("<", "</", 1)
    else:
        lines[at] = _other_number(rng, lines[at])
    file.write_bytes("".join(lines).encode("latin-1") + (rng.randbytes(3) if how == 5 and rng.random() < 0.2 else b""))


def _other_number(rng: random.Random, line: str) -> str:
    words = line.split(" ")
    numbers = [n for n, word in enumerate(words) if any(c.isdigit() for c in word)]
    if not numbers:
        return line
    at = rng.choice(numbers)
    words[at] = rng.choice(["0", "-1", ".nan", "nan", "1e300", "-1e9", "1e-300", "abc", "", "12 m", "{}", "1e6", "0.001"])
    return " ".join(words) + ("" if words[-1].endswith("\n") else "\n")


KINDS: dict[str, Callable[[Case], None]] = {"yaml": yaml, "set": sets, "flown": flown, "aircraft": aircraft}


def _by_name(kind: str) -> Callable[[Case], None]:
    """A kind of the table, or the function that a test of the fuzzer itself names in the environment."""
    if kind in KINDS:
        return KINDS[kind]
    module, _, name = os.environ["FUZZ_KIND"].partition(":")
    return getattr(importlib.import_module(module), name)


def attempt(kind: str, seed: int, number: int, folder: Path) -> tuple[str, list[str]]:
    """(what it came to, what is wrong with that). An exception is wrong, whatever it is."""
    case = Case(kind, seed, number, folder)
    try:
        _by_name(kind)(case)
    except Exception as bug:
        last = traceback.extract_tb(bug.__traceback__)[-1]
        case.faults.append(f"{type(bug).__name__}: {str(bug)[:200]} {Path(last.filename).name}:{last.lineno}")
    return case.came_to, case.faults
