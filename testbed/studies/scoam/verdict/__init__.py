"""The verdict: from the rows of a campaign to one word for each claim of the paper. The rules are in ``docs/verdict.md``."""

from testbed.studies.scoam.verdict.judge import judge
from testbed.studies.scoam.verdict.model import Verdict
from testbed.studies.scoam.verdict.text import csv_bytes

__all__ = ["Verdict", "csv_bytes", "judge"]
