"""What a process keeps is bounded, and forgotten in the order of its last use."""

import pytest

from testbed.core.kept import Kept, forget_everything


def test_the_latest_answers_are_kept_and_asked_for_once() -> None:
    made: list[str] = []
    kept: Kept[str] = Kept(2)
    for key in ("a", "b", "a", "c", "a", "b"):
        assert kept.get(key, lambda key=key: made.append(key) or key) == key
    assert made == ["a", "b", "c", "b"], "b was the one that was not used for longest when c came"
    assert len(kept) == 2


def test_what_is_too_large_is_not_kept_and_sizes_are_added_up() -> None:
    kept: Kept[str] = Kept(10.0, len)
    for text in ("four", "seven..", "far too large to keep"):
        assert kept.get(text, lambda text=text: text) == text
    assert len(kept) == 1, "four and seven are more than ten"
    kept.get("two", lambda: "two")
    assert len(kept) == 2


def test_an_exception_is_no_answer() -> None:
    kept: Kept[float] = Kept(3)
    for _ in range(2):
        with pytest.raises(ZeroDivisionError):
            kept.get("key", lambda: 1 / 0)
    assert kept.get("key", lambda: 7.0) == 7.0


def test_everything_can_be_forgotten() -> None:
    kept: Kept[int] = Kept(3)
    kept.get("key", lambda: 1)
    forget_everything()
    assert len(kept) == 0
    assert kept.get("key", lambda: 2) == 2
