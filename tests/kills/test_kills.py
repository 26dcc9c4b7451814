"""A few kills of each kind; `make kills` has the many."""

import importlib.util

import pytest

from tests.kills.kills import kill

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(("kind", "count"), [("drivers", 3), ("workers", 5), ("schedulers", 2)])
def test_kills_change_no_byte_leave_no_process_and_hang_nothing(tmp_path, kind, count):
    if kind == "schedulers" and importlib.util.find_spec("distributed") is None:
        pytest.skip("the extra 'dask' is not installed")
    told = kill(kind, count, 20211, tmp_path / kind)
    assert (told.kills, told.faults) == (count, [])
