"""Keep what is small of a run, to be committed: ``python reports/publish.py RUN_DIR FOLDER [--target daa]``.

Of a run on the paper that is its page, ``verdict.csv`` and, where it has one, ``readings.csv``; of one on detect and avoid its page and
``risk.csv``. The recordings, ``results.csv`` and the plan stay in the run directory, so the page here does not link to them: a link
becomes its text, and a line at the head of the page says which command writes them and where to.
"""

import argparse
import re
import shutil
import sys
from pathlib import Path

LINK = re.compile(r'<a href="(?:recordings/|results\.csv)[^"]*">(.*?)</a>')
HERE, ELSEWHERE = '<body data-files="here">', '<body data-files="elsewhere">'
HEAD = "<main>\n"
NOTE = (
    '<p class="quiet">{more}This is a copy of'
    " <code>{run}/index.html</code>. The recordings, <code>results.csv</code> and what"
    " <code>testbed replay</code> needs are large and not kept beside it: <code>make {target}</code> writes them into that folder,"
    " and there flights are flown again.</p>\n"
)
LEAD_TIME = 'How early a threat must be answered: <a href="../lead_time/index.html">the lead-time study</a>. '
PAPER, DAA = "paper-full", "daa"  # the targets of the Makefile that make such runs
TABLES = {PAPER: ("verdict.csv", "readings.csv"), DAA: ("risk.csv",)}  # the first has to be there


def published(page: str, run: str, target: str = PAPER) -> str:
    """A run's page without links into the run directory ``run``, and with a line that says so and what ``target`` of make writes it."""
    before, head, after = page.replace(HERE, ELSEWHERE, 1).partition(HEAD)
    if not head or ELSEWHERE not in before:
        raise ValueError("not the page of a run: no <main>")
    return (
        LINK.sub(r"\1", before)
        + head
        + NOTE.format(run=run, target=target, more=LEAD_TIME if target == PAPER else "")
        + LINK.sub(r"\1", after)
    )


def main() -> int:
    """Publish the run that the command line names."""
    parser = argparse.ArgumentParser(prog="publish", description="Keep what is small of a run, to be committed.")
    parser.add_argument("run_dir", metavar="RUN_DIR", type=Path, help="a run directory with index.html and the table of its kind")
    parser.add_argument("folder", metavar="FOLDER", type=Path, help="where they go")
    parser.add_argument("--target", choices=list(TABLES), default=PAPER, help="what make calls it")
    asked = parser.parse_args()
    try:
        page = published((asked.run_dir / "index.html").read_text(encoding="utf-8"), asked.run_dir.as_posix(), asked.target)
        asked.folder.mkdir(parents=True, exist_ok=True)
        (asked.folder / "index.html").write_text(page, encoding="utf-8", newline="\n")
        first, *others = TABLES[asked.target]
        for name in (first, *(name for name in others if (asked.run_dir / name).is_file())):
            shutil.copyfile(asked.run_dir / name, asked.folder / name)
    except (OSError, ValueError) as problem:
        print(f"{asked.run_dir}: cannot be published ({problem})", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
