"""A campaign with parts of somebody's own is read in a worker first.

Such a part is used once when its campaign is read, so that a mistake is told at its place. It may loop, leave, or close what it finds
open: in a worker that costs a sentence, as it costs a flight one row.
"""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from testbed.campaign.words.settings import Campaign
from testbed.run.directory import BadInputError
from testbed.run.engines import Died, LocalEngine

LONGEST_S = 30.0
"""Reading the largest campaigns takes a few seconds."""


def load_tried(source: Path, overrides: Sequence[str] = ()) -> Campaign:
    """The campaign in a file. Raises ``SpecError``, and ``BadInputError`` where a part of it ends or hangs who reads it."""
    from testbed.campaign import load_campaign

    if _names_parts(source, overrides):
        ((_, ended),) = LocalEngine(1, wall_limit_s=LONGEST_S).imap(_read, [(source, tuple(overrides))])
        if isinstance(ended, Died):
            raise BadInputError(f"{source}: a part of your own cannot be tried: {ended.reason}")
    return load_campaign(source, overrides)


def _names_parts(source: Path, overrides: Sequence[str]) -> bool:
    """Whether plug-ins may be asked for; what cannot be read is told by who reads it."""
    try:
        text = source.read_bytes()
    except (OSError, ValueError):
        return False
    return b"plugins" in text or any("plugins" in override for override in overrides)


def _read(asked: tuple[Path, tuple[str, ...]]) -> None:
    from testbed.campaign import SpecError, load_campaign

    with suppress(SpecError):  # the driver finds the same, and tells it
        load_campaign(*asked)
