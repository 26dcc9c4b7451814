"""The page that lists runs: question, answer, a small picture and where to look, newest first. No script, no network."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final
from urllib.parse import quote

from markupsafe import Markup, escape

from testbed.core.utf8 import clipped
from testbed.show import words
from testbed.show.answer import Answer, Bar
from testbed.show.assets import asset, environment

MARK: Final = '<meta name="generator" content="testbed runs">'
"""By it a page of runs is known, and may be written again."""

WIDTH, ROW, NAMES, RIGHT, TOP = 420, 22, 216, 42, 4  # px of the drawing; NAMES, RIGHT: the columns of names and of figures
LONGEST = 38  # characters of a name


@dataclass(frozen=True)
class Link:
    """A file of a run."""

    name: str
    path: str

    @property
    def href(self) -> str:
        return quote(self.path)


@dataclass(frozen=True)
class Told:
    """A run as the page tells it."""

    name: str
    question: str
    when: str
    outcomes: Mapping[str, int]
    answer: Answer | None
    state: str
    page: str
    links: Sequence[Link]
    recordings: int

    @property
    def href(self) -> str:
        return quote(self.page)

    @property
    def flights(self) -> str:
        n = sum(self.outcomes.values())
        return f"{words.counted(n, 'flight')}: {words.outcomes(self.outcomes)}" if n else ""

    @property
    def picture(self) -> Markup:
        return thumbnail(self.answer) if self.answer else Markup("")

    @property
    def caption(self) -> str:
        """What its picture shows."""
        if not self.answer or not self.answer.bars:
            return ""
        return (
            "Least clearance, m: median, and 5 to 95 % of the flights; left of the line is inside the obstacle"
            if self.answer.of == "clearance"
            else "Counts"
        )


def render_runs(runs: Sequence[Told]) -> str:
    """The whole page."""
    css = asset("page.css") + asset("runs.css")
    return environment().get_template("runs.html.j2").render(runs=runs, css=css, mark=Markup(MARK)) + "\n"


def thumbnail(answer: Answer) -> Markup:
    """The bars of an answer as a small drawing; left of the line, which is an obstacle's surface, is inside."""
    bars = answer.bars
    if not bars:
        return Markup("")
    height = TOP * 2 + ROW * len(bars)
    spans = answer.of == "clearance"
    values = [0.0, *(value for bar in bars for value in ((bar.low, bar.high) if spans else (bar.median,)))]
    low, high = min(values), max(values)
    wide = (high - low) or 1.0

    def x(value: float) -> float:
        return NAMES + 8 + (value - low) / wide * (WIDTH - NAMES - 8 - RIGHT)

    parts = [f'<svg viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{escape("; ".join(map(_read_aloud, bars)))}">']
    parts.append(f'<line class="zero" x1="{x(0.0):.1f}" y1="0" x2="{x(0.0):.1f}" y2="{height}"/>')
    for k, bar in enumerate(bars):
        y = TOP + k * ROW
        name = clipped(bar.name, LONGEST)
        ends = (bar.low, bar.high) if spans else (0.0, bar.median)
        figure = words.number(bar.median, 1) if spans else words.number(bar.median, 0)
        parts.append(f'<g class="{bar.tone or "plain"}"><title>{escape(_read_aloud(bar))}</title>')
        parts.append(f'<text x="{NAMES}" y="{y + 15}" text-anchor="end">{escape(name)}</text>')
        parts.append(f'<rect x="{x(ends[0]):.1f}" y="{y + 6}" width="{max(1.5, x(ends[1]) - x(ends[0])):.1f}" height="{ROW - 12}" rx="2"/>')
        if spans:
            parts.append(f'<circle cx="{x(bar.median):.1f}" cy="{y + 11}" r="4"/>')
        parts.append(f'<text class="figure" x="{WIDTH - 2}" y="{y + 15}" text-anchor="end">{figure}</text></g>')
    return Markup("".join([*parts, "</svg>"]))


def _read_aloud(bar: Bar) -> str:
    return f"{bar.name}: {words.number(bar.median, 1)} ({bar.n})"
