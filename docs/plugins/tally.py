"""A study: in how many flights every obstacle stays at least so far off, as a table and as the top of the page.

plugins: [./tally.py]
study: {kind: "tally:Tally", options: {least_m: 5.0}}
"""

from collections.abc import Mapping
from typing import Any

from markupsafe import Markup

from testbed.show.assets import PageHead
from testbed.studies.study import Run, Study, Written


class Tally(Study):
    """Judges flights that were flown anyway: when the text of this file has changed, the same flights are judged anew."""

    def __init__(self, least_m: float = 0.0) -> None:
        self.least_m = least_m

    def unfit(self, settings: Mapping[str, Any]) -> str | None:
        return None if settings.get("obstacles") else "needs an obstacle"

    def write(self, run: Run) -> Written:
        """``run.rows`` are those of rows.jsonl, in plan order; a flight that crashed has no clearance."""
        kept = sum((row["least_clearance_m"] or 0.0) >= self.least_m for row in run.rows if row["outcome"] != "crashed")
        line = f"{kept} of {len(run.rows)} flights stay {self.least_m:g} m clear"
        head = PageHead(Markup('<h2 id="tally">{}</h2>').format(line), Markup(), Markup(), nav=(("tally", "Tally"),))
        return Written({"tally.csv": f"kept,flights\n{kept},{len(run.rows)}\n".encode()}, head)
