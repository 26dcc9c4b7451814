"""What a case must come to: an answer that can be read, or a row whose numbers are there or known to be missing."""

import json
import math

from testbed.results.empty import undeclared
from testbed.run import journal
from testbed.run.job import JobResult

MOST_CHARACTERS = 30_000
"""A list of problems that is longer is read by nobody."""


def text_faults(text: str) -> list[str]:
    """What keeps a message from being read: nothing in it, a control character, half a character, no end."""
    found = []
    if not text.strip():
        found.append("an empty message")
    if len(text) > MOST_CHARACTERS:
        found.append(f"a message of {len(text):,} characters")
    if odd := next((c for c in text if not c.isprintable() and c not in "\n\t"), None):
        found.append(f"a message with the character U+{ord(odd):04X}")
    if "Traceback (most recent" in text:
        found.append("a traceback in a message")
    return found


def row_faults(result: JobResult) -> list[str]:
    """Of a flight's row: a failure of the program, a number that is missing without a reason or infinite, a row that cannot be kept."""
    row = result.row
    if row["outcome"] == "crashed":
        return [f"crashed: {row['message'][:200]} {_where(row['traceback'])}"]
    found = [f"{name} is {'missing' if math.isnan(row[name]) else row[name]} ({row['outcome']})" for name in undeclared(row)]
    again = journal.decode(journal.encode(result))
    if json.dumps(again.row["message"]) != json.dumps(row["message"]):
        found.append("a message that the journal does not keep")
    return found


def _where(traceback: str) -> str:
    """The last place in a traceback that is the project's own."""
    lines = [line.strip() for line in traceback.splitlines() if line.strip().startswith("File ")]
    own = [line for line in lines if "/testbed/" in line or "/vosc/" in line]
    named = (own or lines or [""])[-1]
    return named.rpartition("/")[2].replace('", line ', ":") if named else ""
