"""JSON whose bytes follow from the data alone: what is hashed, and what is stored to be compared."""

import json
from collections.abc import Mapping
from typing import Any


def canonical(data: Any) -> bytes:
    """The same bytes for the same JSON data."""
    return json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def cut(data: Mapping[str, Any], *holes: str) -> list[bytes]:
    """``canonical(data)`` in pieces, between which the values of the keys ``holes`` belong, in alphabetical order.

    For data that differ in few of their keys, the rest of which need then be written once.
    """
    pieces, piece = [], b"{"
    for key in sorted(data):
        piece += canonical(key) + b":"
        if key in holes:
            pieces.append(piece)
            piece = b""
        else:
            piece += canonical(data[key])
        piece += b","
    return [*pieces, piece[:-1] + b"}"]
