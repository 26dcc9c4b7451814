"""What an arena has found, for the end of the command and the list of runs."""

from testbed.show.answer import BAD, KEPT, UNSURE, Answer, counted_bars
from testbed.studies.arena.ranks import Judged
from testbed.studies.arena.sentences import racing, said

MOST_BARS = 6


def answer(judged: Judged) -> Answer:
    """The sentences, and how many flights the first six keep."""
    bars = []
    for one in racing(judged, judged.overall)[:MOST_BARS]:
        share = one.share
        bars.append((one.method, share.kept, KEPT if share.kept == share.flights else UNSURE if share.kept else BAD))
    return Answer(said(judged), counted_bars(bars), of="count")
