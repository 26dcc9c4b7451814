"""Where aircraft live on disk: every folder with an ``aircraft.yaml``. Adding an aircraft needs a folder and nothing else."""

from pathlib import Path

AIRCRAFT_ROOT = Path(__file__).resolve().parents[1] / "aircraft"


def aircraft_folders() -> dict[str, Path]:
    """Name to folder of every aircraft that can be flown, sorted by name."""
    return {file.parent.name: file.parent for file in sorted(AIRCRAFT_ROOT.glob("*/aircraft.yaml"))}
