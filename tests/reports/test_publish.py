"""What is committed of runs: small, and without links to what is not there."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from reports.publish import published

REPORTS = Path(__file__).parents[2] / "reports"
PAGE = """\
<body data-files="here">
<a href="results.csv">results.csv</a>, <a href="verdict.csv">verdict.csv</a>
<main>
<a href="#verdict">down</a>
<td><a href="recordings/ab.rrd">recordings/ab.rrd</a></td><td><a href="recordings/cd.rrd"><code>cd</code></a></td>
</main>
"""


def links(page: str) -> set[str]:
    """Files that a page links to or shows."""
    return set(re.findall(r'(?:href|src)="(?!#|data:|https?:)([^"#]+)', page))


def test_a_link_becomes_its_text_and_the_page_says_where_its_file_is() -> None:
    page = published(PAGE, "reports/runs/one")
    assert links(PAGE) == {"results.csv", "verdict.csv", "recordings/ab.rrd", "recordings/cd.rrd"}
    assert links(page) == {"verdict.csv", "../lead_time/index.html"}
    assert '<body data-files="elsewhere">' in page  # so that no script of the page makes links either
    assert "<td>recordings/ab.rrd</td><td><code>cd</code></td>" in page
    assert '<a href="#verdict">down</a>' in page
    assert page.index("<code>reports/runs/one/index.html</code>") < page.index("down")


def test_the_page_and_the_verdict_of_a_run_are_published(tmp_path: Path) -> None:
    run, folder = tmp_path / "run", tmp_path / "some" / "where"
    run.mkdir()
    (run / "index.html").write_text(PAGE)
    (run / "verdict.csv").write_text("key,word\n")
    (run / "results.csv").write_text("large\n")
    assert publish(run, folder) == (0, "")
    assert sorted(file.name for file in folder.iterdir()) == ["index.html", "verdict.csv"]
    assert (folder / "index.html").read_text() == published(PAGE, run.as_posix())
    (run / "risk.csv").write_text("ratio\n")
    assert publish(run, tmp_path / "daa", "--target", "daa") == (0, "")
    assert sorted(file.name for file in (tmp_path / "daa").iterdir()) == ["index.html", "risk.csv"]
    page = (tmp_path / "daa" / "index.html").read_text()
    assert ("make daa" in page, "lead_time" in page, links(page)) == (True, False, {"verdict.csv"})
    (run / "verdict.csv").unlink()
    code, why = publish(run, folder)
    assert (code, "verdict.csv" in why, "Traceback" in why) == (2, True, False)
    (run / "index.html").write_text("no page")
    assert publish(run, folder)[0] == 2


def publish(run: Path, folder: Path, *more: str) -> tuple[int, str]:
    done = subprocess.run([sys.executable, REPORTS / "publish.py", run, folder, *more], capture_output=True, text=True, check=False)
    return done.returncode, done.stderr


@pytest.mark.parametrize(
    "page",
    [page for name in ("paper", "lead_time", "arena", "daa") for page in REPORTS.glob(f"{name}/*.html")],
    ids=lambda page: page.parent.name,
)
def test_no_committed_page_links_to_what_is_not_there(page: Path) -> None:
    for name in links(page.read_text(encoding="utf-8")):
        assert (page.parent / name).is_file(), f"{page}: {name}"


def test_the_committed_page_of_the_paper_says_how_to_have_the_rest() -> None:
    assert "make paper-full" in (REPORTS / "paper" / "index.html").read_text(encoding="utf-8")
