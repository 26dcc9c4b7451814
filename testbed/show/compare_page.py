"""The page of a comparison of two runs: one HTML file without script or network."""

from collections.abc import Sequence
from typing import Any, Final

from markupsafe import Markup

from testbed.results.compare import Cell, Compared, Difference
from testbed.show import words
from testbed.show.assets import asset, environment
from testbed.show.compare import INTERVALS, TONE_WORDS, Comparison, circumstances, heading, headline, interval, share_interval
from testbed.show.slopes import Slope, slope_chart

MOST_CELLS: Final = 300
MOST_LINES: Final = 120
MOST_CHANGES: Final = 300
TONES: Final = {"better": "good", "worse": "bad", "changed": "warn", "same": ""}


def render_comparison(of: Comparison) -> str:
    """The whole page."""
    cells = of.compared.cells
    return (
        environment()
        .get_template("compare.html.j2")
        .render(
            first=of.first,
            second=of.second,
            sentences=headline(of),
            notes=of.notes,
            intervals=INTERVALS,
            pictures=_pictures(of),
            shares=[_share(one) for one in of.compared.shares],
            differences=[_difference(one) for one in of.told_differences if one.largest],
            alike=", ".join(heading(one) for one in of.told_differences if not one.largest),
            outcomes=[(words.outcome(a), words.outcome(b), n, a == b) for (a, b), n in sorted(of.compared.outcomes.items())],
            columns=[one.column for one in cells[0].differences] if cells else [],
            cells=[_cell(cell, [one.column.name for one in cells[0].differences]) for cell in cells[:MOST_CELLS]],
            cells_left_out=max(0, len(cells) - MOST_CELLS),
            judged=of.judged,
            changed_words=of.words[:MOST_CHANGES],
            words_in_both=of.words_in_both,
            settings=of.settings[:MOST_CHANGES],
            settings_left_out=max(0, len(of.settings) - MOST_CHANGES),
            css=asset("page.css") + asset("compare.css"),
        )
        + "\n"
    )


def _pictures(of: Comparison) -> list[dict[str, Any]]:
    """A slope chart for each metric that is told by cell: a line a cell, or of one cell a line a pair."""
    cells = of.compared.cells
    made = []
    for one in cells[0].differences if cells else ():
        slopes = _cell_slopes(cells, one) if len(cells) > 1 else _pair_slopes(of.compared, one)
        column = one.column
        chart = slope_chart(
            slopes[:MOST_LINES],
            column.heading,
            column.unit,
            column.digits,
            (of.first.name, of.second.name),
            column.name == "least_clearance_m",
        )
        if chart:
            what = "cell, its median" if len(cells) > 1 else "pair"
            left = f"; {len(slopes) - MOST_LINES} more are not drawn" if len(slopes) > MOST_LINES else ""
            made.append({"title": column.heading, "unit": column.unit, "svg": chart, "caption": f"a line a {what}{left}"})
    return made


def _cell_slopes(cells: Sequence[Cell], like: Difference) -> list[Slope]:
    found = [(cell, one) for cell in cells for one in cell.differences if one.column.name == like.column.name]
    return [Slope(circumstances(cell.labels), one.first, one.second, _way(one, one.first, one.second)) for cell, one in found]


def _pair_slopes(of: Compared, like: Difference) -> list[Slope]:
    name = like.column.name
    both = [(pair.key[1], pair.first.values[name], pair.second.values[name]) for pair in of.pairs if name in pair.second.values]
    return [Slope(f"no. {number}", a, b, _way(like, a, b)) for number, a, b in both]


def _way(one: Difference, first: float, second: float) -> str:
    """Which way a line goes, whatever an interval says of it."""
    if abs(second - first) < 0.5 * 10.0**-one.column.digits:
        return "same"
    if not one.column.worse:
        return "changed"
    return "worse" if (second < first) == (one.column.worse == "low") else "better"


def _share(one: Any) -> dict[str, Any]:
    figures = (one.effect.n, one.first, one.second, one.only_first, one.only_second)
    return {
        "name": one.name,
        "figures": figures,
        "interval": share_interval(one),
        "p": f"{one.p:.2g}",
        "tone": TONES[one.tone],
        "word": TONE_WORDS[one.tone],
    }


def _difference(one: Difference) -> dict[str, Any]:
    return {
        "column": one.column,
        "heading": heading(one),
        "n": one.effect.n,
        "medians": [words.number(x, one.column.digits) for x in (one.first, one.second)],
        "interval": interval(one),
        "up": one.up,
        "down": one.down,
        "largest": words.number(one.largest, one.column.digits),
        "tone": TONES[one.tone],
        "word": TONE_WORDS[one.tone],
    }


def _cell(cell: Cell, names: Sequence[str]) -> dict[str, Any]:
    by_name = {one.column.name: one for one in cell.differences}
    kept = [f"{count} of {cell.kept.effect.n}" for count in (cell.kept.first, cell.kept.second)] if cell.kept else [Markup(""), Markup("")]
    lost = cell.kept is not None and cell.kept.second < cell.kept.first
    return {
        "name": circumstances(cell.labels),
        "n": cell.n,
        "kept": kept,
        "lost": lost,
        "figures": [interval(by_name[name]) if name in by_name else words.DASH for name in names],
    }
