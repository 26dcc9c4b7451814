"""What lead times a study has found, in three lines."""

import math
from collections.abc import Sequence

from testbed.show import words
from testbed.show.answer import BAD, KEPT, UNSURE, Answer, counted_bars
from testbed.studies.lead_time.compare import groups, summary
from testbed.studies.lead_time.line import Line

HOW = {"direct": "direction at once", "insertion_point": "insertion point", "flyable": "flyable path"}


def answer(lines: Sequence[Line]) -> Answer:
    """Of the aircraft flown in calm air with the largest margin: what the median encounter needs, and where no lead suffices."""
    flown = {key: found for key, found in groups(lines).items() if key.rung == "jsbsim" and not key.wind_mps and key.turbulence == "none"}
    most = max((key.swell_m for key in flown), default=0.0)
    told, bars = [], []
    for key, found in sorted(flown.items(), key=lambda item: item[0].answer != "direct"):
        if key.swell_m != most or key.method != "scoam":
            continue
        of, name = summary(found), f"{key.aircraft}, {HOW[key.answer]}"
        needs = (
            f"the median encounter needs {words.number(of.lead.value, 2, 's')}"
            if math.isfinite(of.lead.value)
            else "in most none is enough"
        )
        told.append(
            f"{name}, margin {most:g} m: {needs} (best manoeuvre {words.number(of.best.value, 2, 's')}); no lead in {of.never} of {of.n}."
        )
        bars.append((name, of.n - of.never, KEPT if not of.never else BAD if of.never == of.n else UNSURE))
    return Answer(tuple(told[:3]) or (f"{len(lines)} searched.",), counted_bars(bars), of="count")
