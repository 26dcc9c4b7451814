"""What the flights of each cell have in the columns of detect and avoid: counts of flags, and the finite values of numbers."""

import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from testbed.results.columns import Column, Kind
from testbed.results.daa.columns import as_number
from testbed.results.flight_row import Row

MOST_CELLS = 400


@dataclass
class DaaCell:
    """One cell. ``first``: a row of it."""

    first: dict[str, Any]
    n: int = 0
    values: dict[str, "array[float]"] = field(default_factory=dict)


@dataclass
class DaaCells:
    """The first cells of a run, in plan order."""

    columns: Sequence[Column]
    cells: dict[str, DaaCell] = field(default_factory=dict)
    left_out: set[str] = field(default_factory=set)

    def add(self, row: Row) -> None:
        """One more flight."""
        name = str(row["cell"])
        if name not in self.cells and len(self.cells) >= MOST_CELLS:
            self.left_out.add(name)
            return
        cell = self.cells.setdefault(name, DaaCell({**row, "events": ()}))
        cell.n += 1
        for column in self.columns:
            if column.kind is not Kind.TEXT and math.isfinite(number := as_number(row.get(column.name))):
                cell.values.setdefault(column.name, array("d")).append(number)
