"""``testbed audit``: the audit of the paper's printed numbers as a command."""

from pathlib import Path
from typing import Annotated

import typer


def audit(out: Annotated[Path, typer.Option(help="Where audit.csv and audit.html go.")] = Path("reports/paper")) -> list[str]:
    """Put every number that the paper prints to the test, under named readings."""
    from testbed.studies.scoam.audit.report import write_audit

    return [str(file) for file in write_audit(out)]


audit.examples = ("testbed audit", "testbed audit --out audit")  # type: ignore[attr-defined]
