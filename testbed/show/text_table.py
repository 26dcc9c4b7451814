"""Tables of plain text, whose columns stand below each other: for a terminal, a log, a mail."""

from collections.abc import Collection, Sequence

GAP = "  "


def aligned(headings: Sequence[str], rows: Sequence[Sequence[str]], right: Collection[int] = ()) -> list[str]:
    """Its lines. ``right``: columns of numbers, whose ends stand below each other. Without headings there is no line for them."""
    lines = [list(headings), *map(list, rows)] if any(headings) else [list(row) for row in rows]
    widths = [max((len(line[k]) for line in lines), default=0) for k in range(len(headings))]
    return [
        GAP.join(
            cell.rjust(wide) if k in right else cell.ljust(wide) for k, (cell, wide) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
