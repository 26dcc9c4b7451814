"""Whatever a flight does to its process: it is one row that says so, and every other flight is flown."""

import importlib.util
import multiprocessing

import pytest

from testbed.run.dask_engine import DaskEngine
from testbed.run.engines import Died, LocalEngine
from tests.run import poison

pytestmark = pytest.mark.slow

BETWEEN = 3
"""Sound calls before each poisoned one."""


def meal():
    """Poison of every kind, with sound calls all round."""
    items = []
    for kind in poison.KINDS:
        items += [*range(len(items), len(items) + BETWEEN), kind]
    return [*items, *range(5)]


@pytest.fixture(scope="module")
def served():
    items = meal()
    return items, dict(LocalEngine(2, wall_limit_s=2.0).imap(poison.fly, iter(items)))


@pytest.mark.parametrize("kind", poison.KINDS)
def test_poison_of_every_kind_is_one_row_that_says_so(served, kind):
    items, out = served
    answer = out[items.index(kind)]
    assert isinstance(answer, Died)
    assert poison.KINDS[kind] in answer.reason


def test_all_else_is_answered_rightly_and_no_worker_is_left(served):
    items, out = served
    assert {number: out[number] for number, item in enumerate(items) if not isinstance(item, str)} == {
        number: item * item for number, item in enumerate(items) if not isinstance(item, str)
    }
    assert len(out) == len(items)
    assert multiprocessing.active_children() == []


@pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="the extra 'dask' is not installed")
def test_poison_is_the_same_row_on_dask():
    kinds = ["segfault", "spin_in_c", "stop_in_the_middle_of_a_message", "close_all", "giant"]
    items = [0, 1, *kinds, 2, 3]
    out = dict(DaskEngine(2, wall_limit_s=2.0, chunk=3).imap(poison.fly, iter(items)))
    assert [out.get(number) for number in (0, 1, 7, 8)] == [0, 1, 4, 9]
    assert [out[2 + place] for place in range(len(kinds))] == [Died(poison.KINDS[kind]) for kind in kinds]
