"""Whatever is done to a good file: a campaign, or a ``SpecError`` with something to read in it."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from testbed.campaign import SpecError, expand, load_campaign
from tests.campaign.conftest import PARTED

GOOD_FILES = sorted((Path(__file__).resolve().parents[2] / "campaigns").glob("*.yaml"))
NASTY = [
    *(
        "",
        "~",
        "true",
        "-1",
        "0",
        "1e400",
        ".nan",
        ".inf",
        "[]",
        "{}",
        "[1, 2, 3]",
        "{kind: x}",
        "'30 m'",
        "*a",
        "&a [*a]",
        "<<: *a",
        "!!set {a}",
    ),
    *(
        "99999999999999999999",
        "-",
        "?",
        "|",
        ">",
        "%",
        "@",
        "---",
        "...",
        "\t",
        "\0",
        "\x85",
        "\u2028",
        "\ufeff",
        '"\\uD800"',
        '"\\x1b[31m"',
        ": ",
        "#",
    ),
    *(
        "a.b",
        "obstacles",
        "obstacles.O",
        "obstacles.Q.radius_m",
        "sweep",
        "begin",
        "kind",
        "name",
        "O",
        "none",
        "{none: {}}",
        "{O: {name: P}}",
    ),
]

TEXTS = [*(file.read_text() for file in GOOD_FILES), PARTED]
texts = st.sampled_from(TEXTS)
small = st.sampled_from([text for text in TEXTS if len(text) < 3_000])  # trying all the cells of a larger one takes seconds
places = st.floats(0, 1, exclude_max=True)


@st.composite
def mutated(draw: st.DrawFn) -> bytes:
    """A good file after a few cuts, copies, swaps of words, and insertions."""
    data = draw(texts).encode()
    for _ in range(draw(st.integers(1, 4))):
        start = int(draw(places) * len(data))
        length = draw(st.integers(1, 60))
        piece = data[start : start + length]
        kind = draw(st.sampled_from(["delete", "duplicate", "truncate", "insert", "replace", "bytes", "move"]))
        nasty = draw(st.sampled_from(NASTY)).encode() if kind in ("insert", "replace") else b""
        if kind == "delete":
            data = data[:start] + data[start + length :]
        elif kind == "duplicate":
            data = data[:start] + piece + data[start:]
        elif kind == "truncate":
            data = data[:start]
        elif kind == "insert":
            data = data[:start] + nasty + data[start:]
        elif kind == "replace":
            words = data.split(b" ")
            words[int(draw(places) * len(words))] = nasty
            data = b" ".join(words)
        elif kind == "bytes":
            data = data[:start] + draw(st.binary(max_size=4)) + data[start:]
        else:
            rest = data[:start] + data[start + length :]
            at = int(draw(places) * (len(rest) + 1))
            data = rest[:at] + piece + rest[at:]
    return data


def check(path: Path, overrides: list[str]) -> None:
    campaign, refusal = None, None
    try:
        campaign = load_campaign(path, overrides)
    except SpecError as error:
        refusal = error
    if refusal:
        text = str(refusal)
        assert text
        assert "Input should" not in text
        assert all(line.isprintable() for line in text.replace("\t", " ").split("\n"))
    elif campaign and campaign.replicates <= 10:
        plans = expand(campaign)
        assert len({plan.flight_id for plan in plans}) == len(plans) > 0


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=mutated())
def test_a_mutated_file_loads_or_is_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "mutated.yaml"
    path.write_bytes(data)
    check(path, [])


@pytest.mark.slow
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    text=small,
    overrides=st.lists(
        st.one_of(
            st.text(max_size=20),
            st.builds(
                "{}={}".format,
                st.sampled_from(
                    [
                        "parts",
                        "parts.a",
                        "draw",
                        "draw.replan.k",
                        "encounters",
                        "skip",
                        "seed",
                        "begin",
                        "obstacles.O",
                        "sweep",
                        "sweep.x",
                        "air.wind",
                        "route.goal_enu_m",
                        "method.options.a.b",
                    ]
                ),
                st.sampled_from(NASTY),
            ),
        ),
        max_size=3,
    ),
)
def test_any_override_is_taken_or_refused(tmp_path: Path, text: str, overrides: list[str]) -> None:
    path = tmp_path / "small.yaml"
    path.write_text(text)
    check(path, overrides)


@pytest.mark.slow
@pytest.mark.parametrize("nasty", NASTY)
def test_nasty_values_in_every_place(tmp_path: Path, good: str, parted: str, nasty: str) -> None:
    """Not random: each nasty value in every eighth place, each place with every eighth value.

    The places of the one file that has parts, and of the other only the axes at its top level: the rest is the same in both.
    """
    path = tmp_path / "nasty.yaml"
    for text, first in ((parted, 0), (good, len(good.partition("sweep:")[0].split(" ")))):
        words = text.split(" ")
        for i in range(first + NASTY.index(nasty) % 8, len(words), 8):
            path.write_text(" ".join([*words[:i], nasty, *words[i + 1 :]]))
            check(path, [])
