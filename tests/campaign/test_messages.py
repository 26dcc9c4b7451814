"""What a user reads about a bad file: every fault once, at its line and column, in plain words."""

import os
import pickle
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from testbed.campaign import SpecError, load_campaign
from testbed.campaign.reading.problems import NOWHERE, Problem

Complaint = Callable[..., str]

ONE_FAULT = [
    # (what to replace in the good text, by what, the head of the message after "bad.yaml:", the hint)
    ("speed_mps: 50", "sped_mps: 50", "5:1: sped_mps: unknown key 'sped_mps'", "did you mean 'speed_mps'?"),
    ("radius_m: 25", "radius: 25", "13:5: obstacles.O.radius: unknown key 'radius'", "did you mean 'radius_m'?"),
    ("plant:", "zzz:", "19:1: zzz: unknown key 'zzz'", None),
    ("    radius_m: 25\n", "", "12:5: obstacles.O.radius_m: this key is missing", ""),
    ("  goal_enu_m: [500, 200, 100]\n", "", "6:1: route: give goal_enu_m and goal_direction_deg, or a shape", ""),
    ("question: Does it load?\n", "", "1:1: question: this key is missing", ""),
    ("kind: steady, ", "", "20:7: air.wind.kind: this key is missing", ""),
    (
        "speed_mps: 50",
        "speed_mps: '50'",
        "5:12: speed_mps: must be a number, not the text '50'",
        "write 50, without quotes or unit: the key says m/s",
    ),
    (
        "speed_mps: 50",
        "speed_mps: 50 m/s",
        "5:12: speed_mps: must be a number, not the text '50 m/s'",
        "write 50, without quotes or unit: the key says m/s",
    ),
    ("speed_mps: 50", "speed_mps: 1:30", "5:12: speed_mps: must be a number, not the text '1:30'", ""),
    ("speed_mps: 50", "speed_mps: true", "5:12: speed_mps: must be a number, not true", ""),
    ("speed_mps: 50", "speed_mps:", "5:1: speed_mps: must be a number, not empty", ""),
    ("speed_mps: 50", "speed_mps: [50]", "5:12: speed_mps: must be a number, not a list", ""),
    ("speed_mps: 50", "speed_mps: .nan", "5:12: speed_mps: must be a finite number, not .nan", ""),
    ("speed_mps: 50", "speed_mps: -.inf", "5:12: speed_mps: must be a finite number, not -.inf", ""),
    ("speed_mps: 50", "speed_mps: 1e999", "5:12: speed_mps: must be a finite number, not .inf", ""),
    ("speed_mps: 50", "speed_mps: 0", "5:12: speed_mps: must be more than 0 m/s, not 0 m/s", ""),
    ("speed_mps: 50", "speed_mps: 1999", "5:12: speed_mps: must be at most 1000 m/s, not 1999 m/s", ""),
    ("speed_mps: 50", "speed_mps: !!float x", "5:12: 'x' is not a number", ""),
    ("speed_mps: 50", "speed_mps: !knots 50", "5:12: the tag !knots is not supported", ""),
    ("seed: 7", "seed: -7", "3:7: seed: must be at least 0, not -7", ""),
    ("seed: 7", "seed: 7.5", "3:7: seed: must be a whole number, not 7.5", ""),
    ("seed: 7", f"seed: {'9' * 400}", "3:7: a number of 400 characters", ""),
    ("question: Does it load?", "question: 42", "2:11: question: must be a text, not 42", ""),
    ("name: demo", "name: de mo", "1:7: name: must be letters, digits, '_' and '-' only, not the text 'de mo'", ""),
    ("name: demo", f"name: {'x' * 61}", "1:7: name: must have at most 60 characters, not 61", ""),
    ("[106, 12.4]", "[106, 91]", "16:26: obstacles.O.direction_deg[1]: must be at most 90 deg, not 91 deg", ""),
    ("[106, 12.4]", "[106]", "16:20: obstacles.O.direction_deg: must have 2 values, not 1", ""),
    ("[0, 0, 0]", "[]", "7:16: route.start_enu_m: must have 3 values, not 0", ""),
    *[
        ("plant:", f"replan: {{search: {{k_factors: {written}}}}}\nplant:", f"19:{column}: replan.search.k_factors{told}", "")
        for written, column, told in (
            ("[]", 30, ": must have at least 1 value, not 0"),
            ("[1, 2, 3, 4, 5, 6, 7, 8, 9]", 30, ": must have at most 8 values, not 9"),
            ("[0.5]", 31, "[0]: must be at least 1, not 0.5"),
        )
    ],
    ("[0, 0, 0]", "[0, 0, 0, 0]", "7:16: route.start_enu_m: must have 3 values, not 4", ""),
    ("[0, 0, 0]", "0", "7:16: route.start_enu_m: must be a list, not 0", ""),
    ("[0, 0, 0]", "[500, 200, 100]", "6:1: route: start_enu_m and goal_enu_m are the same point", ""),
    ("{time_s: 3}", "{}", "17:5: obstacles.O.when: give exactly one of time_s and own_reaches_enu_m", ""),
    ("plant: {kind: kinematic}", "plant: kinematic", "19:8: plant: must be a section (keys and values), not the text 'kinematic'", ""),
    ("plant: {kind: kinematic}", "plant:", "19:1: plant: must be a section (keys and values), not empty", ""),
    (
        "plant: {kind: kinematic}",
        "plant: {kind: kinmatic}",
        "19:15: plant.kind: no plant 'kinmatic'; there are: kinematic, point_mass, jsbsim",
        "did you mean 'kinematic'?",
    ),
    (
        "kind: steady",
        "kind: stedy",
        "20:20: air.wind.kind: must be one of 'calm', 'steady', 'power_law', 'logarithmic', not 'stedy'",
        "did you mean 'steady'?",
    ),
    ("speed_mps: 5,", "speed_mps: 55,", "20:39: air.wind.speed_mps: must be at most 40 m/s, not 55 m/s", ""),
    ("speed_mps: 5,", "speed: 5,", "20:28: air.wind.speed: unknown key 'speed'", "did you mean 'speed_mps'?"),
    ("air:", "rates: {guidance_hz: 50}\nair:", "20:1: rates: guidance_hz must divide plant_hz = 120", ""),
    ("plant:", "name: again\nplant:", "19:1: the key 'name' is there twice (first in line 1)", ""),
    ("name: demo", "? [a]\n: 1\nname: demo", "1:3: a key must be plain text", ""),
    # the sweep
    ("  method.kind:", "  methd.kind:", "22:3: sweep.methd.kind: unknown setting 'methd.kind'", "did you mean 'method.kind'?"),
    ("  method.kind:", "  plant.kind.x:", "22:3: sweep.plant.kind.x: unknown setting 'plant.kind.x'", "'plant.kind' is a single value"),
    ("  method.kind:", "  obstacles.P.speed_mps:", "22:3: sweep.obstacles.P.speed_mps[0]: there is no obstacle 'P'", "there are: O"),
    (
        "  method.kind: [none, scoam]",
        "  seed: [1, 2]",
        "22:3: sweep.seed: 'seed' belongs to the campaign as a whole, not to a flight",
        "",
    ),
    ("[none, scoam]", "[]", "22:3: sweep.method.kind: an axis without values makes no flights", ""),
    ("[none, scoam]", "[none, none]", "22:23: sweep.method.kind[1]: this value is there twice", ""),
    ("[none, scoam]", "[none, [scoam]]", "22:23: sweep.method.kind[1]: must be a text, not a list", ""),
    ("[none, scoam]", "none", "22:3: sweep.method.kind: must be a list of values, or a section of labels", ""),
    ("slow: {speed_mps: 40}", "slow: {speed_mps: -40}", "24:23: sweep.flown.slow.speed_mps: must be more than 0 m/s, not -40 m/s", ""),
    ("slow: {speed_mps: 40}", "slow: {speed: 40}", "24:12: sweep.flown.slow.speed: unknown setting 'speed'", "did you mean 'speed_mps'?"),
    (
        "slow: {speed_mps: 40}",
        "slow:",
        "24:5: sweep.flown.slow: must be a section of dotted paths and their values",
        "write {} for no change",
    ),
    ("slow: {speed_mps: 40}", "sl/ow: {speed_mps: 40}", "24:5: sweep.flown: a label is a short text without '/', not 'sl/ow'", ""),
    ("{climb_at_most_deg: 18}", "{climb_deg: 18}", "25:20: sweep.flown.high.begin.climb_deg: unknown key 'climb_deg'", None),
    ("{climb_at_most_deg: 18}", "{}", "25:12: sweep.flown.high.begin: give exactly one of at_route_s_m and climb_at_most_deg", ""),
    (
        "sweep:\n",
        "sweep:\n  obstacles.O.when.own_reaches_enu_m: [[1, 2, 3]]\n",
        "22:40: sweep.obstacles.O.when.own_reaches_enu_m[0]: obstacles.O.when: give exactly one of time_s and own_reaches_enu_m",
        "",
    ),
    (
        "  method.kind:",
        "  method:\n    kind:",
        "23:5: sweep.method.kind: must be a section of dotted paths and their values",
        "a path is one key: write 'method.kind'",
    ),
    # the YAML itself
    ("[0, 0, 0]", "[0, 0, 0", "7:16: this '[' is not closed", "noticed in line 8"),
    ("kind: kinematic}", "kind: kinematic", "19:8: this '{' is not closed", "noticed in line 20"),
    ("Does it load?", '"Does it load?', "2:11: this quote is not closed", ""),
    ("  - name: O", "\t- name: O", "12:1: a tab", "YAML is indented with spaces"),
    ("Does it load?", "Does it: load?", "2:18: a ':' where none can be", "check the indentation; a text with ': ' needs quotes"),
    ("Does it load?", "*nothing", "2:11: this alias has no anchor before it", "write &name at the first place"),
    ("Does it load?", "@home", "2:11: a value cannot start with this character", "put the text in quotes"),
    ("Does it load?", "nu\0l", "2:13: a NUL byte does not belong in a text file", ""),
    ("Does it load?", "es\x1bc", "2:13: the control character U+001B does not belong in a text file", ""),
    ("Does it load?", '"\\uD800"', "2:11: half a character (a lone surrogate) in the text", ""),
    ("plant:", "---\nplant:", "19:1: a second document starts here", "one campaign per file"),
    ("[0, 0, 0]", "&a [*a, 0, 0]", "7:16: this value contains itself through its alias *a", ""),
    ("[0, 0, 0]", "[" * 60 + "]" * 60, "7:35: nested too deeply", ""),
    ("  goal_enu_m:", "  <<: 3\n  goal_enu_m:", "8:7: '<<' takes a section, or a list of sections, by alias", ""),
]


@pytest.mark.parametrize(("old", "new", "head", "hint"), ONE_FAULT)
def test_one_fault_is_one_message_at_its_place(complaint: Complaint, good: str, old: str, new: str, head: str, hint: str | None) -> None:
    assert good.count(old) >= 1
    text = good.replace(old, new, 1)
    lines = complaint(text).split("\n")
    assert lines[0] == f"bad.yaml:{head}"
    assert len(lines) == 3
    number, column = (int(part) for part in head.split(":")[:2])
    source = text.split("\n")[number - 1]
    assert lines[1].startswith(f"{number:>6} | ")
    if len(source) <= 120 and source.isprintable():
        assert lines[1] == f"{number:>6} | {source}".rstrip()
        assert lines[2].index("^") == len("       | ") + column - 1
    if hint is not None:
        assert lines[2].partition("^")[2].strip() == hint


def test_the_form_to_the_letter(complaint: Complaint, good: str) -> None:
    assert complaint(good.replace("radius_m", "radios_m")) == (
        "bad.yaml:13:5: obstacles.O.radios_m: unknown key 'radios_m'\n    13 |     radios_m: 25\n       |     ^ did you mean 'radius_m'?"
    )


def test_all_faults_at_once_in_the_order_of_the_file_overrides_last(complaint: Complaint, good: str) -> None:
    text = (
        good.replace("seed: 7", "seed: x")
        .replace("plant:", "plan:")
        .replace("radius_m: 25", "radius_m: -1")
        .replace("none, scoam", "nune, scoam")
    )
    heads = [
        line for line in complaint(text, "speed_hold=air", "foo.bar=1", "sensor.range_m").split("\n") if line.startswith(("bad", "--set"))
    ]
    assert [head.split(": ")[0] for head in heads] == [
        "bad.yaml:3:7",
        "bad.yaml:13:15",
        "bad.yaml:19:1",
        "bad.yaml:22:17",
        "--set foo.bar=1",
        "--set sensor.range_m",
        "--set speed_hold=air",
    ]


def test_a_wrong_name_of_a_part_says_which_there_are(complaint: Complaint, good: str) -> None:
    message = complaint(good.replace("kind: scoam", "kind: scom"))
    assert message.startswith("bad.yaml:18:16: method.kind: no method 'scom'; there are: none, scoam")
    assert "did you mean 'scoam'?" in message
    unknown = complaint(good + "aircraft: ufo\n")
    assert "aircraft: no aircraft 'ufo'; there are: " in unknown
    assert "`testbed --aircraft-path DIR` looks elsewhere too" in unknown


def test_two_axes_must_not_set_the_same_thing(complaint: Complaint, good: str) -> None:
    message = complaint(good.replace("plant.kind: jsbsim}", "method.kind: none}"))
    assert message.startswith("bad.yaml:25:44: sweep.flown: overwrites 'method.kind', which the axis 'method.kind' sets")


def test_a_fault_of_a_combination_names_its_first_cell_and_comes_once(complaint: Complaint, good: str) -> None:
    """Each rate is fine with the default of the others; 120 Hz does not divide 60 Hz."""
    axes = "sweep:\n  rates.plant_hz: [120, 60]\n  rates.guidance_hz: [60, 120]\n  rates.planner_hz: [20, 10]\n"
    assert complaint(good.partition("sweep:")[0] + axes) == (
        "bad.yaml:23:27: sweep.rates.guidance_hz[1]: rates: guidance_hz must divide plant_hz = 60 (in the cell '60/120/20')\n"
        "    23 |   rates.guidance_hz: [60, 120]\n"
        "       |                           ^"
    )


def test_a_grid_nobody_can_mean_is_refused(complaint: Complaint, good: str) -> None:
    speeds = ", ".join(str(1 + i / 10) for i in range(300))
    text = good.replace("replicates: 2", "replicates: 100000").replace("  method.kind:", f"  sensor.range_m: [{speeds}]\n  method.kind:")
    assert complaint(text).startswith("bad.yaml:21:1: sweep: makes 120,000,000 flights; at most 1,000,000")
    axes = "".join(f"  axis{i}: {{a: {{}}}}\n" for i in range(51))
    assert "sweep: has 53 axes; at most 50" in complaint(good + axes)


def test_a_fault_behind_an_alias_is_reported_once_at_the_anchor(complaint: Complaint, good: str) -> None:
    text = good.replace("[0, 0, 0]", "&p [0, true, 0]").replace("[254, 63.6, 60.7]", "*p")
    assert complaint(text).split("\n")[0] == "bad.yaml:7:23: route.start_enu_m[1]: must be a number, not true"
    assert len(complaint(text).split("\n")) == 3


MERGED = """\
obstacles:
  - &first
    name: O
    radius_m: 25
    position_enu_m: [254, 63.6, 60.7]
    speed_mps: 40
    direction_deg: [106, 12.4]
  - <<: *first
    name: P
    speed_mps: 30
"""


def test_merge_keys_take_what_is_not_given_and_keep_positions(write: Callable[[str], str], complaint: Complaint, good: str) -> None:
    head, tail = good.partition("obstacles:\n")[0], "method:" + good.partition("method:")[2]
    campaign = load_campaign(write(head + MERGED + tail))
    assert [(one.name, one.radius_m, one.speed_mps) for one in campaign.obstacles] == [("O", 25, 40), ("P", 25, 30)]
    assert complaint(head + MERGED.replace("25", "-25") + tail).split("\n")[0] == (
        "bad.yaml:14:15: obstacles.O.radius_m: must be more than 0 m, not -25 m"
    )
    assert (
        complaint(head + MERGED.replace("30", "x") + tail).split("\n")[0]
        == "bad.yaml:20:16: obstacles.P.speed_mps: must be a number, not the text 'x'"
    )
    nested = head + MERGED.replace("*first", "[*first, {radius_m: 1, when: {time_s: 5}}]") + tail
    second = load_campaign(write(nested)).obstacles[1]
    assert (second.radius_m, second.when.time_s) == (25, 5)


BOMB = "a: &a [x,x,x,x,x,x,x,x,x,x]\n" + "".join(f"{b}: &{b} [{','.join([f'*{a}'] * 10)}]\n" for a, b in pairwise("abcdefghi"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "bad.yaml: the file is empty (`testbed init DIR` writes one to begin with)"),
        ("# only a comment\n", "bad.yaml: the file is empty (`testbed init DIR` writes one to begin with)"),
        ("- a\n- b\n", "bad.yaml:1:1: must be a section: 'key: value' lines at the top, not a list or a text"),
        ("just text\n", "bad.yaml:1:1: must be a section: 'key: value' lines at the top, not a list or a text"),
        (b"name: \xff\n", "bad.yaml:1:7: byte 0xff is not UTF-8"),
        ("name: x\n".encode("utf-16"), "bad.yaml:1:1: byte 0xff is not UTF-8"),
        ("[" * 1000, "bad.yaml: nested too deeply"),
        ('name: "\\U99999999"\n', "bad.yaml:1:8: cannot be read as YAML"),
        (BOMB, "bad.yaml:5:4: more than 100,000 values, aliases written out"),
        ("#" * 300_001, "bad.yaml: larger than 300 kB: this is no campaign"),
    ],
)
def test_a_file_that_is_no_campaign(complaint: Complaint, text: str | bytes, message: str) -> None:
    assert complaint(text).split("\n")[0].startswith(message)


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("missing.yaml", "missing.yaml: no such file"),
        (".", ".: this is a directory; give the YAML file of a campaign"),
        (os.devnull, f"{os.devnull}: this is not a regular file"),
    ],
)
def test_a_path_that_is_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str, message: str) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SpecError) as caught:
        load_campaign(path)
    assert str(caught.value) == message


def test_a_file_that_cannot_be_read(complaint: Complaint, monkeypatch: pytest.MonkeyPatch) -> None:
    """Root may read anything, so the refusal of the system is played."""

    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(SpecError) as caught:
        load_campaign(Path(__file__))
    assert str(caught.value) == f"{__file__}: cannot be read: Permission denied"


@pytest.mark.parametrize("newline", ["\r\n", "\r"])
def test_line_ends_of_other_systems_and_a_byte_order_mark(
    write: Callable[[bytes], str], complaint: Complaint, good: str, newline: str
) -> None:
    foreign = "\ufeff" + good.replace("\n", newline)
    assert load_campaign(write(foreign.encode())).name == "demo"
    assert complaint(foreign.replace("radius_m: 25", "radius_m: 0")).startswith("bad.yaml:13:15: obstacles.O.radius_m")


def test_what_a_value_holds_cannot_reach_the_terminal(complaint: Complaint, good: str) -> None:
    assert "\x1b" not in complaint(good.replace("name: demo", 'name: "\\e[31m"'))


def test_what_a_part_says_on_two_lines_is_told_on_one() -> None:
    assert str(Problem(NOWHERE, "method.options", "no such side:\nuse left")) == "method.options: no such side: use left"


def test_a_long_line_is_shown_around_its_column(complaint: Complaint, good: str) -> None:
    lines = complaint(good.replace("speed_mps: 50", "speed_mps: " + " " * 300 + "true")).split("\n")
    assert lines[0].startswith("bad.yaml:5:312:")
    assert all(len(line) < 140 for line in lines)
    assert lines[1][lines[2].index("^") :] == "true"


def test_yaml_1_2_not_1_1(write: Callable[[str], str], good: str) -> None:
    """Texts that older YAML turns into booleans and sexagesimal numbers; an exponent without a dot is a number."""
    campaign = load_campaign(
        write(good.replace("Does it load?", "no").replace("speed_mps: 50", "speed_mps: 5e1").replace("name: demo", "name: on"))
    )
    assert (campaign.question, campaign.speed_mps, campaign.name) == ("no", 50.0, "on")


def test_the_error_survives_a_trip_between_processes(write: Callable[[str], str], good: str) -> None:
    with pytest.raises(SpecError) as caught:
        load_campaign(write(good.replace("50", "x")))
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
