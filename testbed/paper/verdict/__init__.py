"""The verdict: from the rows of a campaign to one word for each claim of the paper. The rules are in ``docs/verdict.md``."""

from testbed.paper.verdict.judge import judge
from testbed.paper.verdict.model import Verdict
from testbed.paper.verdict.text import csv_bytes

__all__ = ["Verdict", "csv_bytes", "judge"]
