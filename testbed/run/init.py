"""The files that a study begins with: a first campaign, its schema, what to type next; and, if wanted, the project's own campaigns."""

from pathlib import Path

from testbed.core.catalogue import CAMPAIGN_ROOT, DATA
from testbed.run.directory import BadInputError

KIT = DATA / "study"
"""Every file in it is written into a new study as it is."""
SCHEMA = "campaign.schema.json"
EXAMPLES = "examples"


def begin_study(folder: Path, examples: bool = False) -> list[Path]:
    """Write the files into ``folder``, made if need be; returns them. Raises ``BadInputError`` rather than write over any file."""
    from testbed.campaign import schema

    if folder.exists() and not folder.is_dir():
        raise BadInputError(f"{folder}: not a directory; name another")
    texts = {file.relative_to(KIT): file.read_bytes() for file in _in(KIT)} | {Path(SCHEMA): schema().encode()}
    if examples:
        texts |= {EXAMPLES / file.relative_to(CAMPAIGN_ROOT): file.read_bytes() for file in _in(CAMPAIGN_ROOT)}
    there = sorted(str(name) for name in texts if (folder / name).exists())
    if there:
        shown = ", ".join(there[:3]) + (", ..." if len(there) > 3 else "")
        raise BadInputError(f"{folder}: has {shown} already, and nothing is written over; name another directory")
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(text)
    return [folder / name for name in sorted(texts)]


def _in(folder: Path) -> list[Path]:
    """Every file below, without what Python and editors leave behind."""
    files = (file for file in sorted(folder.rglob("*")) if file.is_file())
    return [file for file in files if not any(part.startswith((".", "__")) for part in file.relative_to(folder).parts)]
