"""What former runs of ``testbed bench`` found: a CSV with a line a run, and whether something has become dearer since."""

import csv
import io
import os
import platform
import statistics
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

from testbed.run.identity import revision

WHO = ("date", "revision", "machine", "load")
SHOWN = 5  # runs beside today's
DRIFT = 1.15  # a figure this much above or below the median of those has drifted

Line = Mapping[str, str]


def today(figures: Mapping[str, float]) -> dict[str, str]:
    """The line of this run. ``load``: of the machine, over the last minute, since figures of a busy one are no news."""
    code = revision()
    commit = str(code["revision"] or "unknown")[:11] + ("+" if code["dirty"] else "")  # + where files were changed since
    where = f"{platform.node()} {platform.machine()} {os.cpu_count()} Python {platform.python_version()}"
    when = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    busy = f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    who = dict(zip(WHO, (when, commit, where, busy), strict=True))
    return who | {name: f"{value:.3f}" for name, value in figures.items()}


def read(file: Path) -> list[dict[str, str]]:
    """Former runs, oldest first; none where there is no file. Raises ``ValueError`` for one that is none of ours."""
    if not file.exists():
        return []
    reader = csv.DictReader(io.StringIO(file.read_text(encoding="utf-8")))
    if tuple(reader.fieldnames or ())[: len(WHO)] != WHO:
        raise ValueError(f"{file}: not a history of 'testbed bench', whose columns begin with {','.join(WHO)}")
    return [{name: value or "" for name, value in line.items() if name} for line in reader]


def append(file: Path, line: Line) -> None:
    """Add a run; a figure that is new gets a column of its own. Raises as ``read`` does."""
    lines = [*read(file), line]
    names = list(dict.fromkeys([*WHO, *(name for each in lines for name in each)]))
    out = io.StringIO(newline="")
    writer = csv.DictWriter(out, names, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(lines)
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(f"{file.name}.part")  # never half a history
    part.write_text(out.getvalue(), encoding="utf-8", newline="")
    part.replace(file)


def beside(before: Sequence[Line], now: Line) -> str:
    """The last runs on this machine, figure by figure, beside this one; and what has drifted."""
    former = [line for line in before if line.get("machine") == now["machine"]][-SHOWN:]
    if not former:
        return "history: no former run on this machine"
    lines = [
        f"history: the last {len(former)} on this machine, oldest first, then this one",
        f"{'':<44}{'  '.join(_short(line) for line in former)}",
    ]
    drifted = []
    for name in (name for name in now if name not in WHO):
        values = [line.get(name, "") for line in former]
        lines.append(f"{name:<44}{'  '.join(f'{value:>12}' for value in values)}  {now[name]:>8}")
        known = [float(value) for value in values if value]
        if known and (middle := statistics.median(known)) > 0.0:
            change = float(now[name]) / middle
            if not 1.0 / DRIFT <= change <= DRIFT:
                drifted.append(f"drifted: {name} is {now[name]}, the median of those was {middle:.3f} ({100.0 * (change - 1.0):+.0f} %)")
    return "\n".join([*lines, *(drifted or [f"nothing has drifted by more than {100.0 * (DRIFT - 1.0):.0f} %"])])


def _short(line: Line) -> str:
    return f"{line['revision'][:12]:>12}"
