"""Tables that are searched, filtered and sorted in the page: packed columns that a script draws, and a plain table of the first rows for
who has none. Every text in them is made here, so that both show the same.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from markupsafe import Markup

from testbed.show.assets import packed_json

PLAIN_ROWS: Final = 100  # that are in the page without a script
MOST_CHOICES: Final = 40  # values of a column that can be chosen from
SPARK_WIDE, SPARK_HIGH, SPARK_POINTS = 56, 34, 28


@dataclass(frozen=True)
class Field:
    """A column. ``shown``: from the beginning, else on demand; ``facet``: its values can be chosen from; ``kind``: how it is drawn."""

    heading: str
    unit: str = ""
    title: str = ""
    kind: str = "text"  # text, number, badge, bad (a number, red where the row is marked), flight
    shown: bool = False
    facet: bool = False


@dataclass(frozen=True)
class Explorer:
    """A table: its columns, its rows of texts, and what else is known of a row by its number."""

    name: str  # of what its rows are, in the plural
    fields: tuple[Field, ...]
    rows: Sequence[Sequence[str]]
    tones: Mapping[str, str] = field(default_factory=dict)
    """Text of a badge to its colour."""
    marked: Sequence[int] = ()
    """Rows whose ``bad`` number is red."""
    links: Mapping[int, str] = field(default_factory=dict)
    notes: Mapping[int, str] = field(default_factory=dict)
    """What is said of a row when it is pointed at."""
    commands: Mapping[int, str] = field(default_factory=dict)
    command: str = ""
    """What is copied for a row: ``{}`` stands for the first line of its flight. ``commands``: for those that have another."""
    sparks: Mapping[int, Markup] = field(default_factory=dict)
    """The row's small picture, the inside of an SVG."""

    def plain(self) -> list[dict[str, Any]]:
        """The first rows, for the template."""
        marked = set(self.marked)
        return [
            {
                "cells": row,
                "bad": number in marked,
                "link": self.links.get(number, ""),
                "note": self.notes.get(number, ""),
                "command": self.command_of(number),
                "spark": self.sparks.get(number, ""),
            }
            for number, row in enumerate(self.rows[:PLAIN_ROWS])
        ]

    def command_of(self, number: int) -> str:
        """What opens or repeats a row."""
        return self.commands.get(number) or (self.command.format(self.rows[number][0].partition("\n")[0]) if self.command else "")

    def packed(self) -> str:
        """All of it for the script. A column of few values is a list of them and their numbers, one of many a text of lines."""
        columns = [
            {
                "heading": one.heading,
                "unit": one.unit,
                "title": one.title,
                "kind": one.kind,
                "shown": one.shown,
                "facet": one.facet,
                **_column([row[k] for row in self.rows]),
            }
            for k, one in enumerate(self.fields)
        ]
        told = {name: {str(k): text for k, text in getattr(self, name).items()} for name in ("links", "notes", "commands", "sparks")}
        whole = {"name": self.name, "n": len(self.rows), "columns": columns, "tones": dict(self.tones), "command": self.command}
        return packed_json(whole | {"marked": list(self.marked)} | told)


def _column(texts: Sequence[str]) -> dict[str, Any]:
    known = list(dict.fromkeys(texts))
    if len(known) <= max(MOST_CHOICES, len(texts) // 4) or any("\x1e" in text for text in known):
        number = {text: k for k, text in enumerate(known)}
        return {"values": known, "codes": [number[text] for text in texts]}
    return {"lines": "\x1e".join(texts)}


def spark(series: Mapping[str, Any]) -> Markup:
    """A flight from above, as small as a word: its track, and the obstacles where they were nearest."""
    track = [(x, y) for x, y in zip(series["x"], series["y"], strict=True) if x is not None and y is not None]
    if len(track) < 2:
        return Markup()
    balls = [(*one["nearest_enu_m"][:2], one["radius_m"]) for one in series.get("obstacles", ()) if None not in one["nearest_enu_m"][:2]]
    track = [track[round(k * (len(track) - 1) / (SPARK_POINTS - 1))] for k in range(SPARK_POINTS)]
    xs = [x for x, _ in track] + [x + s * r for x, _, r in balls for s in (-1, 1)]
    ys = [y for _, y in track] + [y + s * r for _, y, r in balls for s in (-1, 1)]
    wide, high = max(xs) - min(xs), max(ys) - min(ys)
    scale = min((SPARK_WIDE - 4) / max(wide, 1e-9), (SPARK_HIGH - 4) / max(high, 1e-9))
    left, top = (SPARK_WIDE - scale * wide) / 2, (SPARK_HIGH - scale * high) / 2

    def place(x: float, y: float) -> tuple[float, float]:
        return left + scale * (x - min(xs)), SPARK_HIGH - top - scale * (y - min(ys))

    points = " ".join(f"{u:.0f},{v:.0f}" for u, v in (place(x, y) for x, y in track))
    circles = "".join(f'<circle cx="{u:.1f}" cy="{v:.1f}" r="{max(scale * r, 1.0):.1f}"/>' for x, y, r in balls for u, v in [place(x, y)])
    return Markup(f'{circles}<polyline points="{points}"/>')
