"""Labels are spelt in one place: a campaign that spells one otherwise is refused with its line, and code cannot."""

import ast
from pathlib import Path

import pytest

from testbed.campaign import SpecError, load_campaign
from testbed.studies.scoam import labels
from testbed.studies.scoam.labels import AIR, LABELS, Axis, Compass, Design, Encounter, Method, Part, Rung, Severity
from testbed.studies.scoam.page import paper_names
from testbed.studies.scoam.page.picture_data import PICTURED
from testbed.studies.scoam.verdict import csv_words
from testbed.studies.scoam.verdict.flights import Flights
from tests.studies.scoam.verdict_rows import row

ROOT = Path(__file__).parents[3]
SHIPPED = (ROOT / "campaigns" / "paper.yaml").read_text()

WRONG = [
    (
        "      severity:\n",
        "      severety:\n",
        "parts.turbulence.sweep.severety",
        "knows no axis 'severety' in the part 'turbulence'",
        "severity",
    ),
    ("        severe:", "        sever:", "parts.turbulence.sweep.severity", "the study 'scoam' knows no severity 'sever'", "severe"),
    ("  turbulence:\n    rep", "  turbulance:\n    rep", "parts.turbulance", "the study 'scoam' knows no part 'turbulance'", "turbulence"),
    (
        "        single_106_10:\n",
        "        single_107_10:\n",
        "parts.calm.sweep.encounter",
        "no encounter 'single_107_10'",
        "single_106_10",
    ),
    ("        point_load:", "        point_laod:", "parts.calm.sweep.rung", "the study 'scoam' knows no rung 'point_laod'", "point_load"),
    ("        gtm_t2: {aircraft", "        gtm: {aircraft", "parts.calm.sweep.flown_by", "knows no flown_by 'gtm'", "gtm_t2"),
    ('"6.0": {rep', '"six": {rep', "parts.remedy.sweep.lead_s", "needs labels that are numbers, not 'six'", ""),
    (
        "        ground_fixed: {tr",
        "        as_printed: {tr",
        "parts.wind.sweep.design",
        "knows no design 'as_printed'",
        "it knows: anchored, ground_fixed",
    ),
]


@pytest.mark.parametrize("wrong", [WRONG[:1], WRONG[1:2], WRONG[2:]])  # what is in an unknown axis or part is not looked at
def test_a_label_that_the_study_does_not_know_is_told_at_its_line(tmp_path: Path, wrong: list[tuple[str, str, str, str, str]]) -> None:
    text = SHIPPED
    for good, bad, *_ in wrong:
        assert text.count(good) == 1
        text = text.replace(good, bad)
    file = tmp_path / "paper.yaml"
    file.write_text(text)
    with pytest.raises(SpecError) as refused:
        load_campaign(file)
    for _, bad, path, says, hint in wrong:
        told = next(problem for problem in refused.value.problems if says in problem.message)
        assert told.path == path
        assert hint in told.hint
        assert told.spot.line == next(n for n, line in enumerate(text.splitlines(), 1) if bad.strip("\n").split("\n")[0] in line)


def test_an_axis_that_is_needed_and_missing_is_told_and_a_part_may_be_left_out(tmp_path: Path) -> None:
    head, _, rest = SHIPPED.partition("      severity:\n")
    file = tmp_path / "paper.yaml"
    file.write_text(head + rest[rest.index("\n\n") :])
    with pytest.raises(SpecError) as refused:
        load_campaign(file)
    (told,) = refused.value.problems
    assert told.message == "the part 'turbulence' has no axis 'severity', which the study 'scoam' needs"
    assert (told.path, told.spot.line) == ("parts.turbulence.sweep", 1 + head[: head.rindex("    sweep:")].count("\n"))
    start, end = SHIPPED.index("  turbulence:\n"), SHIPPED.index("  # Encounters of the paper's class")
    file.write_text(SHIPPED[:start] + SHIPPED[end:])
    assert "turbulence" not in load_campaign(file).parts
    file.write_text(SHIPPED.partition("parts:")[0])
    with pytest.raises(SpecError, match="the study 'scoam' judges a campaign by its parts, and there are none"):
        load_campaign(file)


def test_a_campaign_from_before_there_were_studies_is_told_what_to_write(tmp_path: Path) -> None:
    file = tmp_path / "paper.yaml"
    file.write_text(SHIPPED.replace("study: {kind: scoam}", "verdict: paper"))
    with pytest.raises(SpecError) as refused:
        load_campaign(file)
    (told,) = refused.value.problems
    assert (told.path, told.message, told.hint) == ("verdict", "unknown key 'verdict'", "write study: {kind: scoam}")
    assert told.spot.is_position


def test_the_shipped_campaign_has_every_part_and_every_label_that_is_declared() -> None:
    """Of what is listed: a label that no campaign has would be looked for in vain. DROAM has sides in calm air alone, two parts no air."""
    flown: dict[str, set[str]] = {}
    parts = load_campaign(ROOT / "campaigns" / "paper.yaml").parts
    assert set(parts) == set(LABELS)
    for part in parts.values():
        for axis, values in part.sweep.items():
            flown.setdefault(axis, set()).update(values)
    for axis, declared in (
        *((Axis.ENCOUNTER, Encounter), (Axis.METHOD, Method), (Axis.RUNG, Rung)),
        *((Axis.DESIGN, Design), (Axis.WIND_FROM, Compass), (Axis.SEVERITY, Severity)),
    ):
        assert flown[axis] == set(declared), axis


@pytest.mark.parametrize("part", [part for part in Part if part != Part.REMEDY])
def test_flights_that_differ_in_any_axis_but_the_method_are_at_different_places(part: Part) -> None:
    """Else a flight is held against one without planner that was flown elsewhere: in weaker air, or in another encounter."""
    here = {str(axis): "one" for axis in LABELS[part] if axis not in (Axis.METHOD, Axis.RUNG, Axis.FLOWN_BY)}
    avoiding = row(1.0, part=part, **here)
    assert Flights([row(2.0, part=part, method="none", **here), avoiding]).idle(avoiding)
    for axis in here:
        elsewhere = row(2.0, part=part, method="none", **here | {axis: "other"})
        assert Flights([elsewhere, avoiding]).idle(avoiding) is None, axis
    for other in ({"rung": "jsbsim"}, {"aircraft": "c172p"}):
        assert Flights([row(2.0, part=part, method="none", **here, **other), avoiding]).idle(avoiding) is None
    assert set(AIR) == {Axis.DESIGN, Axis.WIND_MPS, Axis.WIND_FROM, Axis.SEVERITY}


def test_an_axis_that_is_not_declared_cannot_be_selected_by() -> None:
    with pytest.raises(ValueError, match="'encouter' is not a valid Axis"):
        Flights([]).pick(Part.CALM, Method.SCOAM, Rung.KINEMATIC, encouter="single_106")


def test_pictures_and_names_are_of_labels_that_there_are() -> None:
    for one in PICTURED:
        known = LABELS[Part(one.labels[Axis.PART])]
        assert set(one.labels) - {Axis.PART} <= set(known)
        assert all(label in known[axis] for axis, label in one.labels.items() if isinstance(known.get(axis), tuple))
    assert set(paper_names.READING_NAMES) == set(Encounter) - {Encounter.CLASS}
    assert set(paper_names.RUNG_NAMES) == {*Rung, Part.WIND, Part.TURBULENCE}
    assert set(Method) - {Method.LEAST_DEFLECTION} <= set(paper_names.METHOD_NAMES)
    assert set(Method) - {Method.NONE} <= set(csv_words.METHOD_WORDS)


def test_no_label_is_spelt_outside_of_its_place() -> None:
    """Labels that mean nothing else in Python or in English: the others are words that a page or a key of a picture may have too."""
    every = {str(label) for kind in (Part, Encounter, Method, Rung, Design) for label in kind if "_" in label} | {"jsbsim", "flown_by"}
    spelt = [
        (file.name, node.lineno, node.value)
        for folder in ("verdict", "page")
        for file in (Path(labels.__file__).parent / folder).glob("*.py")
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.Constant) and node.value in every
    ]
    assert spelt == []
