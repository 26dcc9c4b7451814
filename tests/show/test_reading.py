"""The page as it is read in a real browser, wide, narrow and on a phone, by day, by night and on paper: links land on their headings,
nothing is cut off, everything stands out from its ground, and the tables answer.
"""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from testbed.show.page import render_page
from testbed.studies.lead_time.page import page_text
from testbed.studies.scoam.page import render
from tests.show.test_page import PROVENANCE, campaign
from tests.studies.lead_time.test_page import searches
from tests.studies.scoam.test_verdict_page import flown, verdict

__all__ = ["flown", "verdict"]

CONTRAST = (Path(__file__).parent / "contrast.js").read_text(encoding="utf-8")
LANDED = """(id) => {
  const place = document.getElementById(id), heading = place.querySelector("h1, h2, h3, summary") || place;
  const below = heading.getBoundingClientRect().top - document.querySelector("nav").getBoundingClientRect().bottom;
  const atEnd = scrollY + innerHeight >= document.documentElement.scrollHeight - 2;  // there is no way farther down
  return below < 0 || below > (atEnd ? innerHeight - 80 : 60) ? Math.round(below) : null;
}"""
CUT = """() => [...document.querySelectorAll("table")].filter((table) => table.offsetParent)
  .filter((table) => { const box = table.closest(".scroll") || table.parentElement; return box.scrollWidth > box.clientWidth + 1; })
  .map((table) => table.closest("section").id)"""
WAYS = ((1400, "light"), (1000, "dark"), (400, "light"))

pytestmark = [pytest.mark.slow, pytest.mark.browser]


def opened(browser: Any, file: Path, width: int, scheme: str, problems: list[str], ready: str = "body[data-ready]") -> Any:
    page = browser.new_page(color_scheme=scheme, viewport={"width": width, "height": 900})
    page.on("console", lambda message: problems.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("request", lambda request: None if request.url.startswith(("file:", "data:", "blob:")) else problems.append(request.url))
    page.goto(file.as_uri())
    page.wait_for_selector(ready, timeout=120_000, state="attached")
    return page


def follows_every_link(page: Any) -> dict[str, float]:
    """The links of the navigation that do not land right below it, and how many px below it they do."""
    found = {}
    for anchor in page.evaluate("[...document.querySelectorAll('nav a')].map((a) => a.hash.slice(1))"):
        page.evaluate("(id) => document.querySelector(`nav a[href='#${id}']`).click()", anchor)
        page.wait_for_timeout(350)
        page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        found[anchor] = page.evaluate(LANDED, anchor)
    return {anchor: below for anchor, below in found.items() if below is not None}


def test_a_verdict_is_read_at_every_width(
    browser: Any, verdict: SimpleNamespace, flown: tuple[list[dict[str, Any]], dict[str, Any]], tmp_path: Path
) -> None:
    whole = render_page(campaign(), *flown, PROVENANCE, head=render(verdict, *flown))
    (tmp_path / "index.html").write_text(whole, encoding="utf-8")
    plain = whole.replace("Plots.run();", 'document.body.dataset.ready = "1";')  # the pictures, which take long, are drawn once
    (tmp_path / "plain.html").write_text(plain, encoding="utf-8")
    problems: list[str] = []
    for width, scheme in WAYS:
        page = opened(browser, tmp_path / ("index.html" if width == 400 else "plain.html"), width, scheme, problems)
        bars = page.locator(".hero-picture svg").bounding_box()
        assert width < 1400 or bars["y"] + bars["height"] < 900, "the answer and its picture are seen at once"
        assert follows_every_link(page) == {}, (width, scheme)
        page.evaluate("for (const fold of document.querySelectorAll('details:not(.columns)')) fold.open = true")
        page.evaluate("for (const why of document.querySelectorAll('.opener input')) why.click()")
        page.wait_for_timeout(300)
        assert page.evaluate(CUT) == [], (width, scheme)
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), (width, scheme)
        assert page.evaluate(CONTRAST) == [], (width, scheme)
        cards = page.evaluate("[...document.querySelectorAll('.scroll > table:not(.claims)')].map((t) => t.classList.contains('as-cards'))")
        assert width > 400 or all(cards)
        if width == 1400:
            page.emulate_media(media="print", color_scheme="light")
            assert page.evaluate(CONTRAST) == []
        page.close()
    assert problems == []


def test_flights_are_searched_chosen_and_sorted(browser: Any, flown: tuple[list[dict[str, Any]], dict[str, Any]], tmp_path: Path) -> None:
    rows = [
        flown[0][k % 16] | {"flight_id": f"f{k}", "replicate": k, "least_clearance_m": ((k * 37) % 200) - 60.5, "recording": None}
        for k in range(200)
    ]
    rows[150] |= {"recording": "recordings/f150.rrd"}
    for row in rows:
        row["outcome"] = "collided" if row["least_clearance_m"] < 0.0 else "reached"
    (tmp_path / "index.html").write_text(render_page(campaign(), rows, {}, PROVENANCE), encoding="utf-8")
    problems: list[str] = []
    page = opened(browser, tmp_path / "index.html", 1400, "light", problems, "#flights-data")
    page.locator("nav a", has_text="Flights").click()
    page.wait_for_selector("#flights-explorer[data-ready]")
    count, body = page.locator("#flights-explorer output"), page.locator("#flights-explorer tbody")
    assert body.locator("tr").count() == 60
    assert body.locator("tr").first.locator("a").get_attribute("href") == "recordings/f150.rrd"
    assert body.locator(".copy").first.get_attribute("title") == "copy: rerun recordings/f150.rrd"
    page.locator("#flights-explorer thead button", has_text="least clearance").click()
    assert body.locator("td.n").first.inner_text() == "\N{MINUS SIGN}60.50"
    page.locator("#flights-explorer .scroll").evaluate("(box) => { box.scrollTop = box.scrollHeight; }")
    page.wait_for_function("document.querySelectorAll('#flights-explorer tbody tr').length > 60")
    collided = sum(row["outcome"] == "collided" for row in rows)
    page.locator("#flights-explorer select[aria-label=outcome]").select_option(label=f"collided ({collided})")
    assert count.inner_text() == f"{collided} of 200 flights"
    both = [row for row in rows if row["outcome"] == "collided" and row["aircraft"] == "c172p"]
    page.locator("#flights-explorer input[type=search]").fill("c172p")
    assert count.inner_text() == f"{len(both)} of 200 flights"
    shown = body.locator("tr").all_inner_texts()
    assert len(shown) == min(60, len(both))
    assert all("c172p" in text and "collided" in text for text in shown)
    page.locator("#flights-explorer .columns summary").click()
    page.locator("#flights-explorer .columns label", has_text="roll rate").click()
    assert page.locator("#flights-explorer thead th").last.inner_text().startswith("roll rate")
    page.close()
    assert problems == []


def test_the_lead_time_page_is_read_at_every_width(browser: Any, tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text(page_text(searches()), encoding="utf-8")
    problems: list[str] = []
    for width, scheme in WAYS:
        page = opened(browser, tmp_path / "index.html", width, scheme, problems, "main")
        assert follows_every_link(page) == {}, (width, scheme)
        assert page.evaluate(CUT) == [], (width, scheme)
        assert page.evaluate(CONTRAST) == [], (width, scheme)
        page.close()
    assert problems == []
