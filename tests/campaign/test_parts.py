"""A campaign of several parts: which flights it has, in which order, under which names; and what is said of a bad one."""

import os
import subprocess
import sys
from collections.abc import Callable

import pytest

from testbed.campaign import Campaign, FlightPlan, SpecError, expand, load_campaign

Write = Callable[[str], str]
Complaint = Callable[..., str]

ROUTE = {"start_enu_m": (0, 0, 0), "goal_enu_m": (500, 0, 0), "start_direction_deg": (0, 0), "goal_direction_deg": (0, 0)}


def campaign(**settings: object) -> Campaign:
    return Campaign.model_validate({"name": "demo", "question": "?", "route": ROUTE, **settings})


def physics(plan: FlightPlan) -> dict[str, object]:
    return plan.model_dump(exclude={"flight_id", "cell", "labels", "campaign"})


def test_parts_follow_each_other_with_their_own_cells_settings_and_replicates(write: Write, parted: str) -> None:
    plans = expand(load_campaign(write(parted)))
    assert [(plan.cell, plan.replicate) for plan in plans] == [
        *(("calm/none/slow", 0), ("calm/scoam/slow", 0), ("calm/scoam/fast", 0)),
        *(("wind", 0), ("wind", 1)),  # the campaign's replicates
        *(("population/100", 0), ("population/100", 1), ("population/100", 2)),
        *(("population/200", 0), ("population/200", 1), ("population/200", 2)),
    ]
    calm, windy, drawn = plans[2], plans[3], plans[-1]
    assert calm.labels == {"part": "calm", "method.kind": "scoam", "flown": "fast"}
    assert (windy.labels, drawn.labels) == ({"part": "wind"}, {"part": "population", "sensor.range_m": "200"})
    assert [plan.air.wind.kind for plan in (calm, windy, drawn)] == ["calm", "steady", "steady"]
    assert (calm.speed_mps, windy.speed_mps) == (60, 50)
    assert len({plan.flight_id for plan in plans}) == len(plans)


def test_a_part_is_the_campaign_with_these_settings_and_this_sweep() -> None:
    sweep = {"method.kind": ["none", "scoam"]}
    of_part = expand(campaign(replicates=2, seed=3, parts={"only": {"set": {"sensor.range_m": 70, "replan.k": 2}, "sweep": sweep}}))
    alone = expand(campaign(replicates=2, seed=3, sensor={"range_m": 70}, replan={"k": 2}, sweep=sweep))
    assert [physics(plan) for plan in of_part] == [physics(plan) for plan in alone]
    assert [plan.cell for plan in of_part] == [f"only/{plan.cell}" for plan in alone]


def test_a_flight_keeps_its_id_when_other_parts_change() -> None:
    one = expand(campaign(parts={"a": {"sweep": {"replan.k": [1, 2]}}}))
    more = expand(campaign(replicates=1, parts={"b": {"replicates": 2}, "a": {"sweep": {"replan.k": [1, 2, 3]}}}))
    assert {plan.flight_id for plan in one} < {plan.flight_id for plan in more}


@pytest.mark.slow
def test_ids_are_the_same_in_every_process_and_after_a_trip_through_json(write: Write, parted: str) -> None:
    path = write(parted)
    code = f"from testbed.campaign import expand, load_campaign\nprint([p.flight_id for p in expand(load_campaign({path!r}))])"
    answers = {
        subprocess.run(
            [sys.executable, "-c", code], env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, text=True, check=True
        ).stdout
        for seed in ("0", "1")
    }
    loaded = load_campaign(path)
    assert answers == {f"{[plan.flight_id for plan in expand(loaded)]}\n"}
    assert expand(Campaign.model_validate_json(loaded.model_dump_json())) == expand(loaded)


def test_a_skip_takes_out_the_cells_that_match_every_key_of_an_entry() -> None:
    sweep = {"replan.k": [1, 2, 3], "method.kind": ["none", "scoam"], "sensor.range_m": [50, 100]}
    skip = [{"method.kind": "none", "replan.k": [2, "3"]}, {"sensor.range_m": 50, "method.kind": ["scoam"]}]
    everything = [plan.cell for plan in expand(campaign(sweep=sweep))]
    kept = [plan.cell for plan in expand(campaign(sweep=sweep, skip=skip))]
    gone = {"2/none/50", "2/none/100", "3/none/50", "3/none/100", "1/scoam/50", "2/scoam/50", "3/scoam/50"}
    assert kept == [cell for cell in everything if cell not in gone]


@pytest.mark.parametrize(
    ("override", "count"),
    [
        ("parts.population.replicates=5", 15),
        ("replicates=4", 13),
        ("parts.calm.sweep.method.kind=[none, scoam, droam_hp]", 13),
        ("parts.wind.sweep.method.kind=[none, scoam]", 13),
        ("parts.calm.skip=[]", 12),
        ("parts.calm={}", 10),
        ("parts.wind.set.air.wind={kind: calm}", 11),
        ("parts.wind.draw.replan.k={between: [1, 3]}", 11),
        ("parts.population.encounters.radius_m=[10, 10]", 11),
        ("parts={}", 2),
    ],
)
def test_an_override_reaches_into_a_part(write: Write, parted: str, override: str, count: int) -> None:
    path = write(parted)
    plans, before = expand(load_campaign(path, [override])), expand(load_campaign(path))
    assert len(plans) == count
    assert [plan.flight_id for plan in plans] != [plan.flight_id for plan in before]


def test_axes_of_other_parts_do_not_collide_with_an_override(write: Write, parted: str) -> None:
    """Calm sweeps the method; in the other parts the override counts, so it is taken."""
    plans = expand(load_campaign(write(parted), ["method.kind=none"]))
    assert [plan.method.kind for plan in plans[:5]] == ["none", "scoam", "scoam", "none", "none"]


# ruff: noqa: E501
FAULTS = [
    ("  calm:\n", "  'a b':\n", "23:3: parts.a b: must be letters, digits, '_' and '-' only, not the text 'a b'", ""),
    ("  wind:\n", "  none:\n  wind:\n", "33:3: parts.none: must be a section (keys and values), not empty", ""),
    ("  wind:\n", "  none: 3\n  wind:\n", "33:9: parts.none: must be a section (keys and values), not 3", ""),
    ("parts:\n", "sweep: {speed_mps: [1]}\nparts:\n", "22:1: sweep: goes into the parts: a campaign has a sweep or parts, not both", ""),
    ("replicates: 3", "replicate: 3", "38:5: parts.population.replicate: unknown key 'replicate'", "did you mean 'replicates'?"),
    ("replicates: 3", "replicates: 0", "38:17: parts.population.replicates: must be at least 1, not 0", ""),
    ("recordings: none", "recordings: some", "39:17: parts.population.recordings: must be one of 'all', 'none', 'selected', not 'some'", None),
    ("set: {obst", "set: {replicates: 2, obst", "40:11: parts.population.set.replicates: is no setting of a flight", "write it beside 'set'"),
    ("{air.wind:", "{air.wnd:", "25:11: parts.calm.set.air.wnd: unknown setting 'air.wnd'", "did you mean 'air.wind'?"),
    (
        "{kind: calm}}",
        "{kind: clam}}",
        "25:28: parts.calm.set.air.wind.kind: must be one of 'calm', 'steady', 'power_law', 'logarithmic', not 'clam'",
        "did you mean 'calm'?",
    ),
    ("set: {air.wind: {kind: calm}}", "set: calm", "25:5: parts.calm.set: must be a section of dotted paths and their values", ""),
    ("{air.wind: {kind: calm}}", "{speed_mps: 45}", "30:16: parts.calm.sweep.flown: overwrites 'speed_mps', which the axis 'set' sets", ""),
    ("slow: {speed_mps: 40}", "slow: {speed_mps: 0}", "29:27: parts.calm.sweep.flown.slow.speed_mps: must be more than 0 m/s, not 0 m/s", ""),
    ("      flown:", "      part:", "28:7: parts.calm.sweep.part: this label is the part's name", ""),
    ("flown: [fast]", "flwn: [fast]", "32:29: parts.calm.skip[0].flwn: the sweep has no axis 'flwn'", "did you mean 'flown'?"),
    ("[fast]", "[fst]", "32:37: parts.calm.skip[0].flown: the axis 'flown' has no label 'fst'", "did you mean 'fast'?"),
    ("[fast]", "[]", "32:29: parts.calm.skip[0].flown: matches nothing: it lists no label", ""),
    ("[fast]}", "fast}\n      - {method.kind: none, flown: fast}", "33:9: parts.calm.skip[1]: matches no cell that the entries before it leave", ""),
    ("none, flown: [fast]}", "[none, scoam]}", "31:5: parts.calm.skip: leaves no cell to fly", ""),
    ("- {method.kind: none, flown: [fast]}", "- {}", "32:9: parts.calm.skip[0]: must be a section of axes, each with a label or a list of labels", ""),
    ("      - {method.kind: none, flown: [fast]}\n", "      none\n", "32:7: parts.calm.skip: must be a list of sections {axis: label}", ""),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "head", "hint"), FAULTS)
def test_one_fault_is_one_message_at_its_place(complaint: Complaint, parted: str, old: str, new: str, head: str, hint: str | None) -> None:
    assert parted.count(old) == 1
    lines = complaint(parted.replace(old, new)).split("\n")
    assert lines[0] == f"bad.yaml:{head}"
    # The skip refers to the axis that is renamed.
    assert len(lines) == 3 or old == "      flown:"
    if hint is not None:
        assert lines[2].partition("^")[2].strip() == hint


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("parts.clam.replicates=3", "--set parts.clam.replicates=3: there is no part 'clam' (did you mean 'calm'?)"),
        (
            "parts.calm.replicates=x",
            "--set parts.calm.replicates=x: parts.calm.replicates: must be a whole number, not the text 'x'",
        ),
        (
            "parts.calm.sweep.methd.kind=[none]",
            "--set parts.calm.sweep.methd.kind=[none]: parts.calm.sweep.methd.kind: unknown setting 'methd.kind'"
            " (did you mean 'method.kind'?)",
        ),
        (
            "sweep.method.kind=[none]",
            "--set sweep.method.kind=[none]: sweep: goes into the parts: a campaign has a sweep or parts, not both",
        ),
        (
            "parts.calm.foo=1",
            "--set parts.calm.foo=1: unknown setting 'parts.calm.foo' (known in parts.calm: draw, encounters, skip, sweep, set,"
            " replicates, recordings, columns)",
        ),
    ],
)
def test_a_bad_override_of_a_part_is_named_as_it_was_typed(complaint: Complaint, parted: str, override: str, message: str) -> None:
    assert complaint(parted, override).split("\n")[0] == message


def test_an_override_that_every_part_overwrites_is_refused(complaint: Complaint, parted: str) -> None:
    everywhere = parted.replace("  wind:\n", "  wind:\n    set: {air.wind: {kind: calm}}\n").replace(
        "{obstacles: []}", "{obstacles: [], air: {}}"
    )
    assert complaint(everywhere, "air.wind.speed_mps=3").split("\n")[0] == "--set air.wind.speed_mps=3: has no effect: every part sets it"
    own = parted.replace("  wind:\n", "  wind:\n    replicates: 2\n")
    assert complaint(own, "replicates=9") == "--set replicates=9: has no effect: every part sets it"


def test_parts_together_must_not_be_a_grid_that_nobody_can_mean() -> None:
    sweep = {"sensor.range_m": list(range(1, 7))}
    parts = {name: {"replicates": 100_000, "sweep": sweep} for name in "ab"}
    with pytest.raises(SpecError) as caught:
        expand(campaign(parts=parts))
    assert str(caught.value) == "parts: makes 1,200,000 flights; at most 1,000,000 (limits.flights sets that)"
