"""The rules of the verdict as ``reports/verify/paper`` has them."""

import pytest

from reports.verify.paper.intervals import median_bounds, share_bounds
from reports.verify.paper.promises import promise_word
from reports.verify.paper.words import settled


def test_its_statistics_are_those_of_the_textbook() -> None:
    low, high = share_bounds(7, 10)  # Clopper-Pearson tables: 0.348 to 0.933
    assert (low, high) == pytest.approx((0.3475, 0.9333), abs=1e-4)
    assert share_bounds(0, 4) == pytest.approx((0.0, 1.0 - 0.025**0.25))
    assert median_bounds(range(1, 21)) == (10.5, 6.0, 15.0)  # sign test of 20: ranks 6 and 15, 95.86 % (Conover, table A3)
    assert median_bounds(range(1, 7))[1:] == (1.0, 6.0)


@pytest.mark.parametrize(
    ("rails", "still", "air", "word"),
    [
        ([], [], [], "not determined"),
        ([False, False], [], [], "fails kinematically"),
        ([True, True], [False, False], [True] * 99, "fails when flown"),
        ([True, False], [True], [True] * 99, "holds only if"),
        ([True, True], [True, True], [], "holds only if"),
        ([True, True], [True, True], [True] * 98, "holds"),
        ([True, True], [True, True], [True] * 9, "too few to say"),
        ([True, True], [True, True], [True] * 9 + [False], "holds only if"),
    ],
)
def test_the_word_of_a_promise_follows_the_page(rails, still, air, word) -> None:
    assert promise_word(rails, still, air) == word


@pytest.mark.parametrize(
    ("word", "draws", "after"),
    [
        ("holds", {}, "not determined"),
        ("holds", dict.fromkeys(range(73), "holds"), "holds"),
        ("holds", dict.fromkeys(range(72), "holds"), "too few to say"),  # 0.025 ** (1 / 71) = 0.9494
        ("holds", {n: "holds" if n < 10 else "fails when flown" for n in range(21)}, "holds only if"),
        ("fails when flown", {n: "holds" if n < 16 else "fails when flown" for n in range(21)}, "not determined"),
        ("fails when flown", {n: "holds" if n < 15 else "fails when flown" for n in range(21)}, "too few to say"),  # at most 49.1, 54.3 %
        ("fails kinematically", {}, "fails kinematically"),
    ],
)
def test_draws_that_disagree_weaken_a_word(word, draws, after) -> None:
    assert settled(word, draws).word == after
