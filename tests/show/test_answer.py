"""What a run says at its end, from rows whose counts are known."""

import json
import re

import pytest

from testbed.campaign.words.settings import Campaign
from testbed.results.checks import CheckResult
from testbed.show import hero
from testbed.show.answer import Answer, Tally, counted_bars, read
from testbed.show.gathered import gather
from testbed.show.runs_page import thumbnail

ROUTE = {"start_enu_m": [0, 0, 0], "goal_enu_m": [400, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
CAMPAIGN = Campaign.model_validate({"name": "a", "question": "who?", "seed": 7, "route": ROUTE})
NASTY = "</title><script>alert(1)</script>"


def row(flight_id, method, clearance_m, plant="jsbsim", **more):
    outcome = "collided" if clearance_m < 0.0 else "reached"
    who = {"flight_id": flight_id, "plant": plant, "aircraft": "gtm_t2", "method": method, "labels": {}, "outcome": outcome}
    return who | {"least_clearance_m": clearance_m, "cross_track_max_m": 1.5} | more


def told(rows, checks=()):
    tally = Tally()
    for one in rows:
        tally.add(one)
    return tally.answer(checks)


def test_it_says_who_kept_clear_and_which_flight_to_look_at():
    answer = told([row("a", "none", -20.0), row("b", "scoam", 2.0, "kinematic"), row("c", "scoam", -3.25), row("d", "scoam", -1.0)])
    assert answer.lines == (
        "Every radius was kept with no avoidance in 0 of 1 and with SCOAM in 0 of 2 (counted where each of them was flown, in 3 of 4 "
        "flights).",
        "With avoidance it was kept by kinematic point in 1 of 1 and by gtm_t2 flown in JSBSim in 0 of 2.",
        "Closest with avoidance: 3.25 m inside (gtm_t2 flown in JSBSim, SCOAM; flight c).",
    )
    assert answer.flight == "c"
    assert [(bar.name, bar.n, bar.tone) for bar in answer.bars][-1] == ("gtm_t2 flown in JSBSim, SCOAM", 2, "bad")


def test_of_many_methods_it_names_the_best_and_the_worst():
    rows = [row(f"{name}{k}", name, 1.0 if k < kept else -1.0) for name, kept in (("a", 1), ("b", 4), ("c", 0), ("d", 2)) for k in range(4)]
    assert told(rows).lines[0] == "Every radius was kept most often with b, in 4 of 4, and least often with c, in 0 of 4 (4 compared)."


def test_flights_without_a_result_are_told():
    nan = float("nan")
    failed = [row(name, "scoam", nan, cross_track_max_m=nan, outcome="crashed") for name in "abc"]
    assert told(failed).lines == ("All 3 flights failed to run.",)
    assert told(failed[:2]).lines == ("Both flights failed to run.",)
    assert told(failed[:1]).lines == ("Its only flight failed to run.",)
    some = told([*failed[:2], row("d", "scoam", 2.0)]).lines
    assert some[:2] == ("2 of 3 flights failed to run.", "Every radius was kept with SCOAM in 1 of 1.")
    assert told([row("a", "scoam", nan, cross_track_max_m=nan, outcome="trim_failed")]).lines == (
        "Nothing could be measured: 1 could not be trimmed.",
    )


def test_without_an_obstacle_it_says_how_far_from_the_path():
    answer = told([row("a", "none", float("nan")), row("b", "none", float("nan"), cross_track_max_m=2.5)])
    assert answer.lines == ("Farthest from its path: 2.50 m (gtm_t2 flown in JSBSim, no avoidance; flight b).",)


def test_a_check_says_whether_it_passed():
    checks = [CheckResult("radius", "m", 10.0, 10.1, 0.2), CheckResult("time", "s", 1.0, 3.0, 0.2)]
    assert told([], checks[:1]).lines == ("Check passed: 1 line, each within its tolerance; the nearest to it uses 50 %.",)
    assert told([], checks).lines == ("Check missed: 1 of 2 lines out of tolerance.",)


def test_it_comes_back_from_its_file_and_nothing_else_does():
    answer = told([row("a", "scoam", 2.0), row("b", "none", -1.0)])
    stored = json.loads(json.dumps(answer.as_dict()))
    assert read(stored) == answer
    broken = [{}, [], None, {**stored, "lines": "x"}, {**stored, "of": 3}, {**stored, "bars": [{"name": "x"}]}]
    broken += [
        {**stored, "bars": [stored["bars"][0] | change]}
        for change in ({"low": "0"}, {"low": 10**400}, {"tone": "x onload=y"}, {"name": 3}, {"n": None})
    ]
    assert [read(one) for one in broken] == [None] * len(broken)


@pytest.mark.parametrize(
    "answer", [told([row("a", NASTY, 2.0), row("b", "none", -1.0)]), Answer((), counted_bars([(NASTY, 3, "bad")]), "count")]
)
def test_its_picture_is_harmless_and_stays_inside_of_its_frame(answer):
    svg = thumbnail(answer)
    assert "<script" not in svg
    wide = float(re.search(r'viewBox="0 0 (\d+)', svg)[1])
    for x, width in re.findall(r'<rect x="([\d.-]+)" y="[\d.]+" width="([\d.]+)"', svg):
        assert 0.0 <= float(x) <= float(x) + float(width) <= wide


def cell(part, method, kept, replicates=1, plant="jsbsim", **labels):
    """Flights of one cell: so many of its replicates keep clear, and no two have the same clearance."""
    labels = ({"part": part} if part else {}) | {"method.kind": method} | labels
    return [
        row(f"{part}{method}{k}", method, (1.0 if k < kept else -1.0) * (1.0 + 0.1 * k), plant, labels=labels, replicate=k)
        for k in range(replicates)
    ]


def test_only_what_was_flown_in_the_same_circumstances_is_compared():
    shared = cell("a", "orca", 12, 20, radius="15") + cell("a", "scoam", 3, 20, radius="15")
    alone = cell("a", "scoam", 20, 20, radius="99") + cell("b", "scoam", 5, 5)
    line = told(shared + alone).lines[0]
    assert "with ORCA in 12 of 20 (95 % interval" in line
    assert "and with SCOAM in 3 of 20 (95 % interval" in line
    assert line.endswith(" (counted where each of them was flown, in 40 of 65 flights).")
    page = hero.campaign_hero(CAMPAIGN, gather(one | {"cell": "", "events": ()} for one in shared + alone), ()).answer
    assert re.search(r"radius in 12 of 20 flights \(.*\) with ORCA and 3 of 20 flights \(.*\) with SCOAM \(counted", page)


def test_without_the_same_circumstances_none_is_ranked():
    rows = cell("a", "orca", 1) + cell("a", "scoam", 0) + cell("b", "least_deflection", 0) + cell("b", "scoam", 1)
    assert told(rows).lines[0] == (
        "Every radius was kept in a with ORCA in 1 of 1 and with SCOAM in 0 of 1; "
        "in b with least deflection in 0 of 1 and with SCOAM in 1 of 1."
    )


def test_cells_that_were_flown_once_or_always_alike_have_no_interval():
    once = [one for k in range(12) for one in cell("", "scoam", k % 2, radius=str(k))]
    alike = [one | {"least_clearance_m": 2.0} for one in cell("", "scoam", 12, 12)]
    assert [told(rows).lines[0] for rows in (once, alike)] == [
        "Every radius was kept with SCOAM in 6 of 12.",
        "Every radius was kept with SCOAM in 12 of 12.",
    ]


def test_an_axis_of_any_name_can_say_who_is_compared_and_many_parts_are_cut_short():
    ways = [*cell("", "orca", 1, way="sideways", wind="0"), *cell("", "scoam", 0, way="best", wind="0")]
    assert told(ways).lines[0] == "Every radius was kept with ORCA in 1 of 1 and with SCOAM in 0 of 1."
    other = [*ways, *cell("", "scoam", 1, way="another", wind="0")]  # now it says more than the method does
    assert told(other).lines[0].endswith(", which were not flown in the same circumstances.")
    parts = [one for k in range(8) for one in cell(f"p{k}", f"m{k}", 0)]
    assert told(parts).lines[0].endswith("; in p5 with m5 in 0 of 1; and so on in 2 more parts.")
