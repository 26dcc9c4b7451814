"""A run directory from Python: its rows, its plans and what its flights did, as tables of pandas. Nothing is flown here."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.results.columns import AXIS, METRICS, Kind
from testbed.run.directory import BadInputError, RunDirectory
from testbed.run.planned import Planned
from testbed.run.stored import existing, plan_of

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

FLAGS_OF_DAA = ("entered_", "manoeuvre_needed", "false_manoeuvre", "missed_manoeuvre")
"""What the flags begin with that a campaign with a section daa has beside the others."""


@dataclass(frozen=True)
class Run:
    """A run directory, opened to be read."""

    directory: RunDirectory

    @cached_property
    def results(self) -> "pd.DataFrame":
        """One row a flight, in plan order, typed as in ``results.parquet``; ``attrs`` has ``units`` and ``definitions`` by column.

        Metres, seconds, degrees: the unit is in the name too. ``docs/results.md`` says what each column is.
        """
        file = self.directory / "results.parquet"
        if not file.is_file():
            raise BadInputError(
                f"{file}: not there; a run writes it when it ends (testbed report {self.directory.path} writes it of the flights that are "
                "done), a study of searches has a table of its own instead"
            )
        table = _table(file)
        if lost := [column.name for column in METRICS if column.name not in table.column_names]:
            raise BadInputError(f"{file}: not a table of this version of testbed, it has no {lost[0]}")
        frame: pd.DataFrame = table.to_pandas()
        flags = [column.name for column in METRICS if column.kind is Kind.FLAG]
        flags += [one.name for one in table.schema if one.type == "bool" and one.name.startswith(FLAGS_OF_DAA)]
        frame[flags] = frame[flags].astype("boolean")  # true, false or missing, whether a flight of the run has none or not
        frame.attrs["units"] = _told(table.schema, b"unit")
        frame.attrs["definitions"] = _told(table.schema, b"definition")
        return frame

    @cached_property
    def _plan(self) -> tuple[Campaign, Planned]:
        return plan_of(self.directory)

    @property
    def campaign(self) -> Campaign:
        return self._plan[0]

    @property
    def plans(self) -> Sequence[FlightPlan]:
        """What was to be flown, flown yet or not: read from the plan's file flight by flight, as you ask for them."""
        return self._plan[1].plans

    def series(self, columns: str | Sequence[str] | None = None, every_s: float | None = None) -> "pd.DataFrame":
        """What the flights did over time: ``flight_id``, ``time_s`` and the signals, one row an instant; flights in plan order.

        ``columns``: names of signals, or one (``own.pos_enu_m`` stands for its three parts), by default all that were stored.
        ``every_s``: one instant every so many seconds from 0 on, to the nearest tick; by default every tick of the plant. A flight has a
        series where the campaign said ``columns: all`` or ``selected``.
        """
        import pandas as pd

        wanted = None if columns is None else _names("columns", columns)
        stored = [one for flight in self._plan[1].flights if (self.directory.columns / f"{(one := flight['flight_id'])}.parquet").is_file()]
        if not stored:
            raise BadInputError(f"{self.directory.path}: kept no series; fly the campaign with --set columns=all (or selected)")
        frames = [self._series_of(flight_id, wanted, every_s) for flight_id in stored]
        return pd.concat(frames, ignore_index=True)

    def _series_of(self, flight_id: str, columns: Sequence[str] | None, every_s: float | None) -> "pd.DataFrame":
        file = self.directory.columns / f"{flight_id}.parquet"
        table = _table(file)
        if "time_s" not in table.column_names or b"flight" not in (table.schema.metadata or {}):
            raise BadInputError(f"{file}: not the columns of a flight")
        if columns is not None:
            table = table.select(_selected(table.column_names, columns))
        if every_s is not None:
            table = table.take(_ticks(table, every_s))
        frame: pd.DataFrame = table.to_pandas()
        frame.insert(0, "flight_id", flight_id)
        return frame

    def join(self, other: "Run", on: str | Sequence[str], suffixes: tuple[str, str] = ("", "_other")) -> "pd.DataFrame":
        """The rows of this run, each beside the one of the other run that equals it in the columns ``on``; rows without one are left out.

        An axis can be named without its ``label.``. What both have gets the suffixes. Raises ``ValueError`` for what is no run or no column
        of both, and where several flights of either run are equal in ``on``: that would pair each with each.
        """
        import pandas as pd

        if not isinstance(other, Run):
            raise ValueError(f"join: give the other run as open_run({str(other)!r}), not as {type(other).__name__}")
        mine, theirs = self.results, other.results
        names = [_column(mine, theirs, name) for name in _names("on", on)]
        for name in names:
            if pd.api.types.is_numeric_dtype(mine[name]) != pd.api.types.is_numeric_dtype(theirs[name]):
                raise ValueError(f"{name}: holds numbers in one run and text in the other, so no two rows are equal in it")
        for run, frame in ((self, mine), (other, theirs)):
            if (twice := frame.duplicated(names)).any():
                again = frame.loc[twice, names].iloc[0].to_dict()
                raise ValueError(f"{run.directory.path}: several flights have {again}; name more columns in on, such as replicate")
        return mine.merge(theirs, on=names, suffixes=suffixes)


def open_run(path: str | Path) -> Run:
    """A run directory. Raises ``BadInputError`` if there is none."""
    return Run(existing(Path(path)))


def _table(file: Path) -> "pa.Table":
    """A Parquet file of a run, whatever it holds."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        return pq.read_table(file)
    except (pa.ArrowException, OSError, UnicodeDecodeError) as problem:
        why = (str(problem).splitlines() or [type(problem).__name__])[0]
        raise BadInputError(f"{file}: cannot be read as a table ({why}); testbed report writes results.parquet again") from None


def _told(schema: "pa.Schema", key: bytes) -> dict[str, str]:
    return {field.name: field.metadata[key].decode() for field in schema if field.metadata}


def _names(what: str, given: str | Sequence[str]) -> list[str]:
    """One name or several, as a list."""
    names = [given] if isinstance(given, str) else list(given)
    if not names:
        raise ValueError(f"{what}: name at least one column")
    return names


def _selected(there: Sequence[str], wanted: Sequence[str]) -> list[str]:
    """Columns of a file: the time, and the wanted ones or their parts."""
    chosen = ["time_s"]
    for name in wanted:
        found = [column for column in there if column == name or column.rpartition(".")[0] == name]
        if not found:
            raise ValueError(f"no signal '{name}' was kept; there are: {', '.join(there)}")
        chosen += [column for column in found if column not in chosen]
    return chosen


def _ticks(table: "pa.Table", every_s: float) -> Any:
    """Rows nearest to multiples of a time."""
    import numpy as np

    if not every_s > 0.0:
        raise ValueError(f"every_s: give a time above 0 s, got {every_s}")
    hz = json.loads(table.schema.metadata[b"flight"])["plant_hz"]
    last_s = (table.num_rows - 1) / hz
    instants = np.arange(0.0, last_s + 0.5 / hz, every_s)
    return np.unique(np.minimum(np.round(instants * hz), table.num_rows - 1).astype(int))


def _column(mine: "pd.DataFrame", theirs: "pd.DataFrame", name: str) -> str:
    """A column that both have, by its name or as an axis."""
    both = [column for column in mine.columns if column in theirs.columns]
    for found in (name, f"{AXIS}{name}"):
        if found in both:
            return found
    raise ValueError(f"'{name}' is no column of both runs; there are: {', '.join(both)}")
