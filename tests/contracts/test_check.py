"""``testbed check`` passes what is built in, and says in words which promise a part of one's own breaks."""

from pathlib import Path

import pytest

from testbed.contracts import flown
from testbed.contracts.check import CheckError, check, given_options
from testbed.core import registry
from tests.command import testbed

GOOD = "def avoid(own, obstacles):\n    '''Turns up.'''\n    x, y, z = own.vel_mps\n    return Choice((-y, x, z), 'avoided')\n"
BROKEN = {
    "answers with a Choice": [
        "def avoid(own, obstacles):\n    return own.vel_mps\n",
        "def avoid(own, obstacles):\n    return Choice((1.0, 2.0), 'avoided')\n",
        "def avoid(own, obstacles):\n    return Choice((float('nan'), 0.0, 0.0), 'avoided')\n",
        "def avoid(own, obstacles):\n    return Choice(own.vel_mps, 'turned')\n",
        "def avoid(own, obstacles):\n    1 / sum(own.vel_mps[:2])\n    return Choice(own.vel_mps, 'avoided')\n",
    ],
    "gives the same answer": [
        "import random\n\ndef avoid(own, obstacles):\n    x, y, z = own.vel_mps\n    a = random.choice([1.0, -1.0])\n"
        "    return Choice((-a * y, a * x, z), 'avoided')\n",
        "seen = []\n\ndef avoid(own, obstacles):\n    seen.append(own)\n    x, y, z = own.vel_mps\n"
        "    return Choice((-y, x, z) if len(seen) % 2 else (y, -x, z), 'avoided')\n",
    ],
    "leaves what it is given alone": [
        "def avoid(own, obstacles):\n    x, y, z = own.vel_mps\n    object.__setattr__(own, 'vel_mps', (-y, x, z))\n"
        "    return Choice(own.vel_mps, 'avoided')\n",
    ],
    "keeps the speed": ["def avoid(own, obstacles):\n    return Choice(tuple(2 * v for v in own.vel_mps), 'avoided')\n"],
}


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)

    def save(text: str) -> None:
        (tmp_path / "mine.py").write_text(f"from vosc.methods import Choice\n\n\n{text}")

    return save


@pytest.mark.slow
@pytest.mark.parametrize("kind", registry.names("method"))
def test_every_method_that_is_built_in_keeps_its_promises(kind: str) -> None:
    kept, lines = check("method", kind, {})
    assert kept, "\n".join(lines)


@pytest.mark.parametrize("kind", registry.names("guidance"))
def test_every_law_that_is_built_in_keeps_its_promises(kind: str) -> None:
    kept, lines = check("guidance", kind, {})
    assert kept, "\n".join(lines)


def test_a_good_method_of_one_s_own_passes(write) -> None:
    write(GOOD)
    kept, lines = check("method", "mine:avoid", {})
    text = list(lines)
    assert kept, text
    assert text[-1] == "method 'mine:avoid': all 6 promises kept"


MUTATING = """\
def avoid(own, obstacles):
    x, y, z = own.vel_mps
    for one in obstacles:
        object.__setattr__(one, 'radius_m', 1.0)
    return Choice((x, y, z), 'avoided')
"""


def test_a_method_that_changes_what_it_is_given_always_to_the_same_is_named(write) -> None:
    """Each promise is tried in encounters of its own; only the one about what is given is broken."""
    write(MUTATING)
    kept, told = check("method", "mine:avoid", {})
    lines = list(told)
    assert not kept
    assert [line for line in lines if line.startswith("broken")] == [
        "broken  leaves what it is given alone: encounter 0: own or obstacles are others after the call"
    ]
    write(MUTATING.replace("object.__setattr__(one, 'radius_m', 1.0)", "pass"))
    (fares,) = [line.partition(";")[0] for line in check("method", "mine:avoid", {})[1] if "can be asked" in line]
    assert any(line.startswith(fares) for line in lines)  # its cones were those of the encounters as they were
    assert "unsafe" in fares


@pytest.mark.slow
@pytest.mark.parametrize(("promise", "text"), [(promise, text) for promise, texts in BROKEN.items() for text in texts])
def test_what_a_method_breaks_is_named(write, promise: str, text: str) -> None:
    write(text)
    kept, lines = check("method", "mine:avoid", {})
    assert not kept
    assert any(line.startswith("broken") and promise in line for line in lines)


def test_a_law_that_ignores_its_path_is_named(write) -> None:
    write(
        "from testbed.flight.guidance.law import Memory, Telemetry\nfrom testbed.flight.plants.base import Command\n\n\n"
        "class Straight:\n"
        "    def __init__(self, setting):\n        self.n = 0\n"
        "    def start(self, s_m):\n        return Memory(s_m, s_m)\n"
        "    def step(self, memory, state, path):\n        self.n += 1\n"
        "        bank = 0.001 * self.n\n"
        "        return Command(-bank, 1.0, 50.0, 0.0), Memory(memory.s_m + 0.8, 0.0), Telemetry(memory.s_m, -bank, 1.0, 0.0)\n"
    )
    kept, lines = check("guidance", "mine:Straight", {})
    broken = [line for line in lines if line.startswith("broken")]
    assert not kept
    assert [any(words in line for line in broken) for words in ("memory alone", "banks towards", "follows a path")] == [True] * 3


def test_options_are_checked_before_anything_is_tried(write) -> None:
    write(GOOD.replace("obstacles)", "obstacles, side: str = 'left')"))
    kept, lines = check("method", "mine:avoid", given_options(["sidd=left", "side=3"]))
    text = "\n".join(lines)
    assert not kept
    assert "sidd: unknown option 'sidd'" in text
    assert "side: must be a text, not 3" in text


@pytest.mark.parametrize(
    ("kind", "said"),
    [("nothing", "no method 'nothing'; there are: none, scoam"), ("gone:avoid", "no such file"), ("mine:other", "has no 'other'")],
)
def test_what_is_not_there_is_said(write, kind: str, said: str) -> None:
    write(GOOD)
    with pytest.raises(CheckError, match=said):
        check("method", kind, {})


@pytest.mark.slow
def test_the_command(write, tmp_path: Path) -> None:
    write(GOOD)
    good = testbed("check", "method", "mine:avoid", cwd=tmp_path)
    assert (good.returncode, good.stdout.splitlines()[-1]) == (0, "method 'mine:avoid': all 6 promises kept")
    write(GOOD.replace("'avoided'", "'done'"))
    assert testbed("check", "method", "mine:avoid", cwd=tmp_path).returncode == 1
    bad = testbed("check", "method", "mine:avoid", "--set", "oops", cwd=tmp_path)
    assert bad.returncode == 2
    assert "expected KEY=VALUE" in bad.stderr


def test_the_planner_that_is_built_in_keeps_its_promises() -> None:
    kept, lines = check("planner", "replan", {})
    assert kept, "\n".join(lines)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "kind"),
    [("method", "tangent:avoid"), ("method", "pn:Law"), ("planner", "holder:Planner"), ("guidance", "pure_pursuit:Pursuit")],
)
def test_the_documented_files_keep_their_promises(family: str, kind: str) -> None:
    kept, lines = check(family, f"{Path(__file__).parents[2] / 'docs' / 'plugins'}/{kind}", {})
    assert kept, "\n".join(lines)


PLANNER = """\
import random


class Planner:
    def start(self, context):
        return context

    def step(self, memory, time_s, state, seen):
        {step}
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("step", "said"),
    [
        ("return None", "answers at every look"),
        ("return memory, 3", "the planner's path must be PH curves or finite points"),
        ("1 / 0", "raises ZeroDivisionError"),
        ("return memory, [state[:3], (state.x + random.uniform(300, 900), 50, 0)] if not time_s else None", "flies the same flight again"),
        ("return memory, [state[:3], (state.x + 5e4, 0, 0)] if not time_s else None", "brings the flight to its goal"),
    ],
)
def test_what_a_planner_breaks_is_named(write, monkeypatch: pytest.MonkeyPatch, step: str, said: str) -> None:
    """In one encounter: all of them are flown by the planners above, which break nothing."""
    monkeypatch.setattr(flown, "ENCOUNTERS", {"out of the way": flown.ENCOUNTERS["out of the way"]})
    write(PLANNER.format(step=step))
    kept, lines = check("planner", "mine:Planner", {})
    assert not kept
    assert any(line.startswith("broken") and said in line for line in lines), "\n".join(lines)


PARTS = """\
class Idle:
    def start(self, context): ...

class Veer:
    def __init__(self, setting): ...
    def start(self, s_m): ...

class Steers(Idle):
    def __init__(self, gain: float = 1.0):
        if gain <= 0.0:
            raise ValueError(f"gain: give a number above 0, got {gain}")
    def steer(self, memory, time_s, own, seen): ...

class Leaves(Idle):
    def __init__(self):
        raise SystemExit(3)
    def step(self, memory, time_s, state, seen): ...

def aside(own, obstacles, gain: float = 1.0):
    if gain <= 0.0:
        raise ValueError(f"gain: give a number above 0, got {gain}")
    x, y, z = own.vel_mps
    return Choice((-y, x, z), 'avoided')
"""


@pytest.mark.parametrize(
    ("family", "name", "given", "said"),
    [
        ("method", "Idle", {}, "a steering law needs start and steer; Idle has no steer"),
        ("planner", "Idle", {}, "a planner needs start and step; Idle has no step"),
        ("planner", "aside", {}, "this is a function that wants own, obstacles; a planner is a class with start and step"),
        ("guidance", "Veer", {}, "a guidance law needs start and step; Veer has no step"),
        ("planner", "Leaves", {}, "fails when it is tried: SystemExit: 3"),
        ("method", "Steers", {"gain": -1.0}, "gain: give a number above 0, got -1.0"),
        ("method", "aside", {"gain": -1.0}, "gain: give a number above 0, got -1.0"),
    ],
)
def test_what_no_campaign_could_use_is_one_line(write, family: str, name: str, given: dict, said: str) -> None:
    write(PARTS)
    kept, told = check(family, f"mine:{name}", given)
    lines = list(told)
    assert not kept
    assert len(lines) == 2, lines
    assert lines[0].startswith("broken  has options that a YAML can say: ")
    assert said in lines[0]
    assert lines[1] == f"{family} 'mine:{name}': 1 of 1 promises broken"


@pytest.mark.parametrize(
    ("body", "said"), [("raise ValueError(f'gain: give more than {gain}')", "gain: give more than -1.0"), ("return 3", "int has no start")]
)
def test_a_law_that_cannot_be_made_is_told_once(write, body: str, said: str) -> None:
    write(f"def make(setting, gain: float = 1.0):\n    {body}\n")
    kept, told = check("guidance", "mine:make", {"gain": -1.0})
    broken = [line for line in told if line.startswith("broken")]
    assert not kept
    assert len(broken) == 1
    assert said in broken[0]
