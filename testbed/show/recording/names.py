"""Names of things in a view that is seen from one place: none over another, wherever the things move."""

from collections.abc import Sequence

import numpy as np
import rerun as rr

from testbed.show import labels
from testbed.show.cameras import Shot
from testbed.show.palette import dimmed, rgba
from testbed.show.recording.timeline import Clock

Array = np.ndarray
OUTSIDE = (0.9, 0.44)  # what is out of the picture has no name in it
FAR = 0.06  # a name that had to give way by more has a line to its place, in heights of the picture
HZ = 10.0  # names follow so often: finding a place for them costs more than all the rest


class Names:
    """Collects names with the places that they belong to, and writes them where there is room. The first have their way."""

    def __init__(self, shot: Shot, rows: Array) -> None:
        """``rows``: those of the places that follow at which names are written."""
        self._shot, self._rows, self._all = shot, rows, list[tuple[str, Sequence[str] | str, str, Array, float]]()

    def add(self, entity: str, said: Sequence[str] | str, colour: str, places: Array, below: float = 0.0) -> None:
        """A name, or what it is at each row, at ``places`` (n, 3), NaN while there is nothing to name, or so much below it."""
        self._all.append((entity, said, colour, places, below))

    def log(self, clock: Clock, time_s: Array) -> None:
        """Write them all."""
        rows = self._rows
        seen = [self._shot.seen(places[rows]) - [0.0, below] for *_, places, below in self._all]
        there = [(np.abs(at) < OUTSIDE).all(axis=1) for at in seen]  # NaN is not
        placed = [np.full((len(rows), 2), np.nan) for _ in self._all]
        sheet = labels.Sheet()
        for k in range(len(rows)):
            shown = [n for n in range(len(self._all)) if there[n][k]]
            texts = [said if isinstance(said := self._all[n][1], str) else said[rows[k]] for n in shown]
            sizes = sheet.sizes(texts)
            for n, place in zip(shown, labels.spread(np.array([seen[n][k] for n in shown]), sizes), strict=True) if shown else ():
                placed[n][k] = place
        for (entity, said, colour, places, _), at, shown_at in zip(self._all, placed, there, strict=True):
            if shown_at.any():
                _log(clock, entity, said, colour, time_s, rows, self._shot.at(at, places[rows]), shown_at)
                moved = shown_at & (np.abs(at - self._shot.seen(places[rows]))[:, 1] > FAR)
                _log_leaders(clock, entity, colour, time_s[rows], places[rows], self._shot.at(at, places[rows]), moved)


def _log(clock: Clock, entity: str, said: Sequence[str] | str, colour: str, time_s: Array, rows: Array, at: Array, shown: Array) -> None:
    clock.static(entity, rr.Points3D.from_fields(colors=rgba(colour), radii=rr.Radius.ui_points(0.1)))

    def build(k: Array) -> rr.ComponentColumnList:
        chosen = k[shown[k]]
        texts = [said if isinstance(said, str) else said[rows[row]] for row in chosen]
        return rr.Points3D.columns(positions=at[chosen].reshape(-1, 3), labels=texts).partition(shown[k].astype(int))

    clock.send(entity, time_s[rows], build)


def _log_leaders(clock: Clock, entity: str, colour: str, time_s: Array, places: Array, at: Array, moved: Array) -> None:
    """Lines from names to their places, while these are far apart."""
    if not moved.any():
        return
    clock.static(f"{entity}/leader", rr.LineStrips3D.from_fields(colors=rgba(dimmed(colour)), radii=rr.Radius.ui_points(0.5)))
    ways = np.stack([places, at], axis=1)

    def build(k: Array) -> rr.ComponentColumnList:
        return rr.LineStrips3D.columns(strips=list(ways[k[moved[k]]])).partition(moved[k].astype(int))

    clock.send(f"{entity}/leader", time_s, build)
