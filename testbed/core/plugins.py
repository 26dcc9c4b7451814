"""Files of the user's own, in which a campaign finds parts: ``plugins: [./tangent.py]``.

A file is read once, by the driver. Its text goes with every flight to the process that flies it, local or far away, and its SHA-256 is
part of what the flight is: a file that was changed is another planner. It is executed as a module of its own and can import what is
installed; files beside it are not looked for, since nothing would say when they change.
"""

import hashlib
import keyword
import sys
import traceback
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

from testbed.core.utf8 import reason

MOST_BYTES = 1_000_000


class PluginError(Exception):
    """A plug-in cannot be used; str() says which and why."""


@dataclass(frozen=True)
class Plugin:
    """A file of parts: what a campaign calls it, where it was, and its text."""

    name: str
    file: str
    source: str = field(repr=False)

    @property
    def sha256(self) -> str:
        return hashlib.sha256(self.source.encode()).hexdigest()


_texts: dict[tuple[str, str], Plugin] = {}  # by name and hash: all that were added
_modules: dict[tuple[str, str], ModuleType] = {}
_latest: dict[str, str] = {}


def read(path: Path) -> Plugin:
    """The plug-in in a file. Raises ``PluginError``."""
    name = path.stem
    if path.suffix != ".py" or not name.isidentifier() or keyword.iskeyword(name):
        raise PluginError(f"a plug-in is a Python file with a plain name, such as tangent.py, not '{path.name}'")
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise PluginError(f"no such file: {path}") from None
    except OSError as problem:
        raise PluginError(f"{path} cannot be read: {problem.strerror}") from None
    if len(data) > MOST_BYTES:
        raise PluginError(f"{path} has {len(data):,} bytes; at most {MOST_BYTES:,}")
    try:
        return Plugin(name, str(path.resolve()), data.decode("utf-8"))
    except UnicodeDecodeError:
        raise PluginError(f"{path} is not text in UTF-8") from None


def add(found: Iterable[Plugin]) -> None:
    """Make plug-ins known in this process and execute them, once each. Raises ``PluginError`` with the line at fault."""
    for plugin in found:
        key = (plugin.name, plugin.sha256)
        _texts.setdefault(key, plugin)
        if key not in _modules:
            _modules[key] = _executed(plugin)
        _latest[plugin.name] = plugin.sha256


def attribute(name: str, attribute: str, sha256: str | None = None) -> Any:
    """What a plug-in calls ``attribute``; of the text with that hash, or of the one added last. Raises ``PluginError``."""
    wanted = sha256 or _latest.get(name)
    if wanted is None or (name, wanted) not in _modules:
        known = f"there are: {', '.join(_latest)}" if _latest else "there are none"
        raise PluginError(f"no plug-in '{name}': name its file under 'plugins' ({known})")
    module = _modules[(name, wanted)]
    if not hasattr(module, attribute):
        public = [key for key, value in vars(module).items() if callable(value) and getattr(value, "__module__", "") == module.__name__]
        raise PluginError(f"{name}.py has no '{attribute}'; it has: {', '.join(public) or 'nothing that can be called'}")
    return getattr(module, attribute)


def sha256_of(name: str) -> str:
    """Hash of the plug-in of that name that was added last. Raises ``PluginError``."""
    if name not in _latest:
        raise PluginError(f"no plug-in '{name}': name its file under 'plugins'")
    return _latest[name]


def texts(pinned: Iterable[tuple[str, str]]) -> tuple[Plugin, ...]:
    """The plug-ins with these names and hashes, to be sent with a flight; what is not a plug-in of this process is passed over."""
    return tuple(_texts[key] for key in pinned if key in _texts)


def _executed(plugin: Plugin) -> ModuleType:
    name = f"testbed_plugin_{plugin.name}_{plugin.sha256[:12]}"
    module = ModuleType(name)
    module.__file__ = plugin.file
    sys.modules[name] = module  # dataclasses and pickle look a class's module up
    try:
        exec(compile(plugin.source, plugin.file, "exec"), module.__dict__)
    except BaseException as bug:
        del sys.modules[name]
        if isinstance(bug, KeyboardInterrupt):
            raise
        raise PluginError(f"{_where(plugin, bug)}: {reason(bug)}") from None
    return module


def _where(plugin: Plugin, bug: BaseException) -> str:
    """``tangent.py:12``, the last line of the file that was reached."""
    lines = [frame.lineno for frame in traceback.extract_tb(bug.__traceback__) if frame.filename == plugin.file]
    line = bug.lineno if isinstance(bug, SyntaxError) else lines[-1] if lines else None
    return f"{plugin.name}.py:{line}" if line else f"{plugin.name}.py"
