"""What a result depends on: the plan, the code, the versions of what it uses. Two runs with the same identity may share a directory."""

import hashlib
import json
import platform
import re
import subprocess
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path
from typing import Any

import vosc
from testbed.core.canonical import canonical
from testbed.core.catalogue import AIRCRAFT_ROOT, DATA, aircraft_folders

DISTRIBUTION = "vosc-testbed"
PACKAGE = Path(__file__).resolve().parents[1]


def versions() -> dict[str, str]:
    """Of Python and of every package the project needs at run time."""
    needs = (re.match(r"[\w.\-]+", line) for line in metadata.requires(DISTRIBUTION) or [] if "extra ==" not in line)
    names = sorted(match.group() for match in needs if match)
    return {"python": platform.python_version()} | {name: metadata.version(name) for name in names}


def code_hash() -> str:
    """Of every file of the packages and of their aircraft, committed or not: a changed tree is another code."""
    digest = hashlib.sha256()
    for folder in (PACKAGE, Path(vosc.__file__).parent, AIRCRAFT_ROOT):
        for file in _sources(folder):
            content = file.read_bytes()
            digest.update(f"{folder.name}/{file.relative_to(folder).as_posix()} {len(content)}\n".encode() + content)
    return short(digest)


def _sources(folder: Path) -> list[Path]:
    def counts(file: Path) -> bool:
        parts = file.relative_to(folder).parts
        carried = DATA in file.parents and DATA not in folder.parents  # as part of the package, where it decides no result
        return file.is_file() and not carried and "__pycache__" not in parts and not any(part.startswith(".") for part in parts)

    return sorted(filter(counts, folder.rglob("*")))


def revision() -> dict[str, Any]:
    """Commit and whether the tree differs from it; both None where the code is not in a repository of its own, but in a wheel."""
    root = AIRCRAFT_ROOT.parent
    if _git(root, "ls-files", "--error-unmatch", "testbed/__init__.py") is None:  # e.g. installed inside somebody else's repository
        return {"revision": None, "dirty": None}
    return {"revision": _git(root, "rev-parse", "HEAD"), "dirty": bool(_git(root, "status", "--porcelain"))}


def _git(root: Path, *arguments: str) -> str | None:
    try:
        done = subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, text=True, timeout=20, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()


def aircraft_hashes(names: Iterable[str]) -> dict[str, dict[str, str]]:
    """SHA-256 of each file of each aircraft flown."""
    folders = {name: aircraft_folders()[name] for name in sorted(set(names))}
    return {
        name: {file.relative_to(folder).as_posix(): hashlib.sha256(file.read_bytes()).hexdigest() for file in _sources(folder)}
        for name, folder in folders.items()
    }


def guests(names: Iterable[str]) -> dict[str, str]:
    """One hash for each aircraft flown that is not the project's own."""
    theirs = [name for name in names if aircraft_folders()[name].parent != AIRCRAFT_ROOT]
    return {name: short(hashlib.sha256(canonical(files))) for name, files in aircraft_hashes(theirs).items()}


def machine() -> dict[str, str]:
    """What kind of machine this is, not which one."""
    return {"system": platform.system(), "machine": platform.machine(), "libc": "-".join(filter(None, platform.libc_ver()))}


def short(digest: "hashlib._Hash") -> str:
    """The digits of a hash that are told and compared."""
    return digest.hexdigest()[:16]


def flat(data: Any, path: str = "") -> dict[str, Any]:
    """Nested data as dotted path to leaf; a list is a leaf unless it holds sections."""
    if isinstance(data, dict) and data:
        items = data.items()
    elif isinstance(data, list) and any(isinstance(item, dict) for item in data):
        items = {item.get("name", str(n)) if isinstance(item, dict) else str(n): item for n, item in enumerate(data)}.items()
    else:
        return {path: data}
    return {key: leaf for name, item in items for key, leaf in flat(item, f"{path}.{name}" if path else name).items()}


def differences(there: Any, now: Any) -> list[str]:
    """One sentence for each leaf that differs."""
    old, new = flat(there), flat(now)
    absent = object()
    return [
        f"{key}: {_shown(old, key)} there, {_shown(new, key)} now"
        for key in dict.fromkeys([*old, *new])
        if key and old.get(key, absent) != new.get(key, absent)
    ]


def _shown(leaves: dict[str, Any], key: str) -> str:
    text = json.dumps(leaves[key]) if key in leaves else "nothing"
    return text if len(text) <= 60 else text[:57] + "..."
