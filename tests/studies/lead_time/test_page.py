"""The page of a lead-time study leads with its answer: one sentence and one picture, whose figures are those of the searches."""

import math
import re
from dataclasses import asdict, replace
from statistics import median

import pytest

from testbed.studies.lead_time.compare import flyable, groups
from testbed.studies.lead_time.line import Line, Searches, line_of
from testbed.studies.lead_time.page import page_text
from testbed.studies.lead_time.search import Found
from testbed.studies.lead_time.svg_pictures import LEFT, WIDTH
from testbed.studies.lead_time.top import hero
from tests.studies.lead_time.studies import study as planned

PROVENANCE = {
    "flights_flown": 78, "flights_planned": 78, "plan_hash": "ab", "code_hash": "cd", "versions": {"jsbsim": "1"}, "aircraft": {},
}  # fmt: skip
LEADS = {"direct": [0.8 + 0.1 * k for k in range(13)], "insertion_point": [2.0 + 0.2 * k if k < 8 else math.inf for k in range(13)]}


def searches() -> Searches:
    """13 encounters, each answered at once and through the insertion point, on rails and by an aircraft that needs half a second more."""
    lines = []
    for rung, aircraft in (("rails", ""), ("jsbsim", "gtm_t2")):
        for answer, leads in LEADS.items():
            plant = {"direct": "vo_instant", "insertion_point": "kinematic"}[answer] if rung == "rails" else rung
            for k, lead in enumerate(leads):
                late = 0.5 if aircraft else 0.0
                found = Found(
                    lead + late, 0.7 + 0.05 * k + late, 0, [-3.0, 1.0, 2.0], 25.0, 30.0, 60.0, 12.0, 14.0 * k, 0.4, 60.0 * lead, 3
                )
                where = ("methods", plant, answer, aircraft, "scoam", 8.0, 0.0, math.nan, "none", k)
                lines.append(Line(*where, (1.0, 3.0, 6.0), 1.0, 0.02, found))
    return Searches("How early?", 7, tuple(lines), PROVENANCE)


def test_the_answer_is_that_of_the_searches() -> None:
    study = searches()
    top = hero(groups(study.lines), study.lines)
    of = {answer: [line.found for line in study.lines if line.aircraft and line.answer == answer] for answer in LEADS}
    lead, best = (median(getattr(found, name) for found in of["direct"]) for name in ("lead_s", "best_s"))
    assert f"SCOAM needs a lead of {lead:.2f} s in the median of 13 encounters where the best manoeuvre needs {best:.2f} s" in top.answer
    assert "through the insertion point, no lead suffices in 5 of 13" in top.answer
    assert top.rests == "Rests on 52 searches of 156 flights, over 13 encounters."
    marks = {float(text) for text in re.findall(r'class="median"[^>]*>([\d.]+) s<', str(top.picture))}
    late = median(found.lead_s for found in of["insertion_point"])
    assert marks == {round(lead, 2), round(best, 2), round(late, 2)}
    dots = [float(x) for x in re.findall(r'<circle class="dot c1" cx="([\d.]+)"', str(top.picture))]
    assert [(x - LEFT) / (WIDTH - LEFT) * 6.0 for x in dots] == pytest.approx([lead], abs=0.002)


def test_the_answer_stands_before_the_tables_and_the_sentences_after_them() -> None:
    page = page_text(searches())
    order = ["SCOAM needs a lead of", 'class="dot c1"', 'id="leads"', 'id="waste"', 'id="words"', 'id="definitions"']
    assert [page.index(part) for part in order] == sorted(page.index(part) for part in order)
    assert page == page_text(searches())
    assert "Not finished" not in page
    assert "Not finished: 78 of 90 searches." in page_text(replace(searches(), provenance=PROVENANCE | {"flights_planned": 90}))


def test_a_flyable_path_is_an_answer_beside_the_insertion_point_and_changes_none_of_the_others() -> None:
    """It needs 0.4 s less than the path that asks nobody, in the encounters that both have a lead for, and has none in eight."""
    study = searches()
    through = [line for line in study.lines if line.answer == "insertion_point" and line.aircraft]
    leads = [line.found.lead_s - 0.4 if k < 5 else math.inf for k, line in enumerate(through)]
    flown = [
        replace(line, answer="flyable", study="flyable", found=replace(line.found, lead_s=lead))
        for line, lead in zip(through, leads, strict=True)
    ]
    more = replace(study, lines=(*study.lines, *flown))
    ((key, cost),) = flyable(groups(more.lines))
    assert (key.answer, cost.method.pairs, cost.method.lost, cost.method.gained) == ("flyable", 5, 3, 0)
    before, after = hero(groups(study.lines), study.lines), hero(groups(more.lines), more.lines)
    assert after.answer == before.answer[:-1] + "; on a path within the aircraft's limits, no lead suffices in 8 of 13."
    page = page_text(more)
    assert "What a flyable path costs" in page
    assert "What a flyable path costs" not in page_text(study)
    assert "some lead lets SCOAM keep the radius in these encounters" in page
    assert "5 of 13 for gtm_t2 (on a path within the aircraft&#39;s limits)" in page


def test_the_line_of_a_search_on_flyable_paths_says_so() -> None:
    found = asdict(searches().lines[0].found)
    for path, answer in (("hermite", "insertion_point"), ("flyable", "flyable")):
        plan = planned(plant={"kind": "kinematic"}, replan={"path": path, "rejoin": {"when": "clear"}})
        line = line_of(plan, {"found": found})
        assert (line.answer, line.rung) == (answer, "kinematic")
