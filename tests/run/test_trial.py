"""A part of somebody's own that hangs or ends who reads it costs a sentence."""

from pathlib import Path

import pytest

from testbed.campaign import SpecError
from testbed.run import trial
from testbed.run.directory import BadInputError

CAMPAIGN = """name: own
question: What does a part cost that cannot be tried?
plugins: [./mine.py]
method: {kind: "mine:avoid"}
route: {start_enu_m: [0, 0, 0], goal_enu_m: [900, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
"""
DOES = {
    "while True: pass": "ended after 3 s of wall-clock time",
    "os._exit(0)": "ended with exit code 0",
    "os.kill(os.getpid(), 9)": "killed by SIGKILL",
    "os.closerange(0, 256); raise RuntimeError": "the worker process",
}

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("where", ["avoid", "import"])
@pytest.mark.parametrize(("does", "said"), DOES.items())
def test_a_part_that_ends_or_hangs_its_reader_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str, does: str, said: str
) -> None:
    monkeypatch.setattr(trial, "LONGEST_S", 3.0)
    (tmp_path / "mine.py").write_text(
        f"import os\n{does}\n" if where == "import" else f"import os\ndef avoid(own, obstacles):\n    {does}\n"
    )
    (tmp_path / "own.yaml").write_text(CAMPAIGN)
    with pytest.raises(BadInputError, match=f"a part of your own cannot be tried: .*{said}"):
        trial.load_tried(tmp_path / "own.yaml")


def test_what_is_wrong_otherwise_is_told_as_ever(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("def avoid(own, obstacles):\n    return None\n")
    (tmp_path / "own.yaml").write_text(CAMPAIGN)
    with pytest.raises(SpecError, match=r"own\.yaml:4:1"):
        trial.load_tried(tmp_path / "own.yaml")
