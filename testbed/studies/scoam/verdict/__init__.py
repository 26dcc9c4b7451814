"""The verdict: from the rows of a campaign to one word for each claim of the paper. The rules are in ``docs/verdict.md``."""

from testbed.studies.scoam.verdict.csv_file import csv_bytes, readings_bytes
from testbed.studies.scoam.verdict.judge import judge
from testbed.studies.scoam.verdict.judged import Verdict

__all__ = ["Verdict", "csv_bytes", "judge", "readings_bytes"]
