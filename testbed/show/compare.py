"""What two runs are told to differ in: the figures of ``testbed.results.compare``, and what is said around them; as text."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from testbed.results.compare import Compared, Difference, ShareDifference
from testbed.show import words
from testbed.show.shown_columns import SHOWN_COLUMNS
from testbed.show.text_table import aligned

MOST_CHANGES = 40  # lines of settings, or of words, in a terminal
TONE_WORDS: Final = {"better": "better", "worse": "worse", "changed": "changed", "same": ""}
INTERVALS: Final = (
    "Differences are the second run less the first, within pairs. In brackets: 95 % interval, of a median by order statistics (none "
    "below six pairs), of a share exact; both take pairs as independent of each other."
)


@dataclass(frozen=True)
class Side:
    """One of the two runs. ``name``: how it is called here."""

    name: str
    path: str
    question: str
    when: str
    planned: int
    flown: int
    page: str
    """Empty if there is none."""


@dataclass(frozen=True)
class Change:
    """Something that has one text in the first run and another in the second; ``more``: what it is, in words."""

    name: str
    first: str
    second: str
    more: str = ""


@dataclass(frozen=True)
class Comparison:
    """All of it."""

    first: Side
    second: Side
    compared: Compared
    notes: Sequence[str]
    settings: Sequence[Change]
    """What of campaign, code and versions differs."""
    judged: str
    """What judges both runs: ``verdict.csv``, ``checks.csv``, or nothing."""
    words: Sequence[Change]
    """Judgements that differ."""
    words_in_both: int

    @property
    def told_differences(self) -> list[Difference]:
        """Those of the columns that pages show, or of a study's own figures."""
        return _told(self.compared.differences)


def _told(differences: Sequence[Difference]) -> list[Difference]:
    shown = {column.name for column in SHOWN_COLUMNS}
    return [one for one in differences if one.column.name in shown] or list(differences)


def heading(one: Difference) -> str:
    """What a metric is called where no other stands beside it."""
    return {"at": "time of least clearance"}.get(one.column.heading, one.column.heading)


def interval(one: Difference) -> str:
    """``-1.0 [-1.4 to -0.6]``; a dash for the bounds of too few pairs."""
    return _with_bounds(one.effect.value, one.effect.low, one.effect.high, one.column.digits)


def share_interval(one: ShareDifference) -> str:
    """The same in per cent points."""
    value, low, high = (100.0 * x for x in (one.effect.value, one.effect.low, one.effect.high))
    return _with_bounds(value, low, high, 1)


def _with_bounds(value: float, low: float, high: float, digits: int) -> str:
    bounds = words.interval(low, high, "", digits)
    sign = "+" if value > 0.0 and float(f"{value:.{digits}f}") else ""
    return f"{sign}{words.number(value, digits)}" + (f" [{bounds}]" if bounds != words.DASH else "")


def circumstances(labels: Mapping[str, str]) -> str:
    """A cell in words."""
    return ", ".join(words.circumstance(axis, label) for axis, label in labels.items() if label) or "all"


def headline(of: Comparison) -> list[str]:
    """The answer in two or three sentences: what became of the radii before any median."""
    lead = of.compared.lead
    left = len(of.compared.pairs) - lead.n
    pairs = words.counted(lead.n, "pair") + (" with avoidance" if left else "")
    kept = [lead.kept] if lead.kept else list(of.compared.shares[:1])
    said = [
        f"Of {pairs}, {one.only_first} no longer {_plural(one.name) if one.only_first != 1 else one.name} and {one.only_second} newly "
        f"{'does' if one.only_second == 1 else 'do'}; {one.first} do in {of.first.name}, {one.second} in "
        f"{of.second.name}."
        for one in kept
    ] or [f"{pairs} compared."]
    for difference in _told(lead.differences)[:1]:
        alike = difference.effect.n - difference.up - difference.down
        moved = f"more in {difference.up} and less in {difference.down} of {words.counted(difference.effect.n, 'pair')}" + (
            f", in {alike} the same" if alike else ""
        )
        median = f"{interval(difference)} {difference.column.unit}".rstrip()
        said.append(f"{words.capital(heading(difference))}: {moved}; in the median {median}.")
    if left:
        said.append(f"Left out of this: {words.counted(left, 'pair')} without avoidance.")
    if of.judged:
        said.append(f"{len(of.words)} of {of.words_in_both} words of {of.judged} changed.")
    return said


def _plural(name: str) -> str:
    """``keep every radius``, of what is called ``keeps every radius``."""
    verb, _, rest = name.partition(" ")
    return f"{verb.removesuffix('es') if verb.endswith('hes') else verb.removesuffix('s')} {rest}"


def text(of: Comparison) -> list[str]:
    """All of it for a terminal."""
    lines = [f"{of.first.name}: {of.first.path}, {_flown(of.first)}", f"{of.second.name}: {of.second.path}, {_flown(of.second)}", ""]
    lines += [*headline(of), *(f"note: {note}" for note in of.notes), ""]
    lines += _shares(of) + _differences(of) + _cells(of)
    if of.words:
        lines += _changes(f"words of {of.judged}", of, of.words)
    if of.settings:
        lines += _changes("what the runs were given", of, of.settings)
    return [*lines, INTERVALS]


def _flown(side: Side) -> str:
    return f"{words.counted(side.flown, 'flight')}" + (f", {side.when} UTC" if side.when else "")


def _shares(of: Comparison) -> list[str]:
    rows = [
        (
            one.name,
            str(one.effect.n),
            str(one.first),
            str(one.second),
            str(one.only_first),
            str(one.only_second),
            share_interval(one),
            f"{one.p:.2g}",
        )
        for one in of.compared.shares
    ]
    headings = ("flights", "pairs", of.first.name, of.second.name, "only first", "only second", "difference, % points", "McNemar's p")
    return [*aligned(headings, rows, right=range(1, 8)), ""] if rows else []


def _differences(of: Comparison) -> list[str]:
    changed = [one for one in of.told_differences if one.largest]
    rows = [
        (
            heading(one),
            one.column.unit,
            str(one.effect.n),
            *(words.number(x, one.column.digits) for x in (one.first, one.second)),
            interval(one),
            str(one.up),
            str(one.down),
            words.number(one.largest, one.column.digits),
            TONE_WORDS[one.tone],
        )
        for one in changed
    ]
    headings = ("median of", "unit", "pairs", of.first.name, of.second.name, "difference", "up in", "down in", "largest", "")
    lines = aligned(headings, rows, right=range(2, 9)) if rows else []
    alike = [heading(one) for one in of.told_differences if not one.largest]
    if alike:
        lines.append(f"the same in every pair: {', '.join(alike)}")
    return [*lines, ""]


def _cells(of: Comparison) -> list[str]:
    if len(of.compared.cells) < 2:
        return []
    first = of.compared.cells[0].differences[:1]
    rows = []
    for cell in of.compared.cells[:MOST_CHANGES]:
        one = next(iter(cell.differences), None)
        kept = (f"{cell.kept.first} of {cell.kept.effect.n}", f"{cell.kept.second} of {cell.kept.effect.n}") if cell.kept else ("", "")
        rows.append((circumstances(cell.labels), str(cell.n), *kept, interval(one) if one else words.DASH))
    what = f"{first[0].column.heading}, {first[0].column.unit}" if first else "difference"
    left = len(of.compared.cells) - len(rows)
    return [
        *aligned(("cell", "pairs", f"{of.first.name} keeps", f"{of.second.name} keeps", what), rows, right=range(1, 5)),
        *([f"... and {left} more cells, which the page has (--out FILE.html)"] if left else []),
        "",
    ]


def _changes(what: str, of: Comparison, changes: Sequence[Change]) -> list[str]:
    rows = [(one.name, one.first, one.second) for one in changes[:MOST_CHANGES]]
    left = [f"... and {len(changes) - MOST_CHANGES} more"] if len(changes) > MOST_CHANGES else []
    return [*aligned((what, of.first.name, of.second.name), rows), *left, ""]
