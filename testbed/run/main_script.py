"""The script that runs a campaign, which workers need not know: so it works without a main guard, from stdin and from a prompt.

A spawned process imports the main script of its parent again. One that flies as it is imported would start workers in every worker.
"""

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import Any

GUARD = 'if this is a script of yours, put what it does under `if __name__ == "__main__":`'
"""What to write where workers do need it."""


@contextlib.contextmanager
def left_out(fn: Callable[..., Any]) -> Iterator[None]:
    """Processes that are started inside do not import the main script, unless ``fn``, which they call, is in it."""
    main = sys.modules.get("__main__")
    if main is None or getattr(fn, "__module__", "__main__") == "__main__":
        yield
        return
    there = {name: getattr(main, name) for name in ("__file__", "__spec__") if hasattr(main, name)}
    main.__spec__ = None
    if "__file__" in there:
        del main.__file__
    try:
        yield
    finally:
        for name, value in there.items():
            setattr(main, name, value)
