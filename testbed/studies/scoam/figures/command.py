"""``testbed figures``: the paper's figures as a command."""

from pathlib import Path
from typing import Annotated

import typer


def figures(out: Annotated[Path, typer.Option(help="Where the figures go.")] = Path("reports/runs/figures")) -> list[str]:
    """Draw the paper's fourteen figures from the testbed's own geometry, as SVG, PNG (needs Chromium) and one recording.

    The numbers beside them are computed, and stand in values.csv, too.

    Example: testbed figures --out figures
    """
    from testbed.studies.scoam.figures.write import browser, write_figures

    written = [str(file) for file in write_figures(out)]
    return written if browser() else [*written, "no PNG: there is no chromium here"]
