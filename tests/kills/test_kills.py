"""A worker and a scheduler are killed; `make kills` kills many, and drivers at any moment. One driver: tests/cli/test_cli.py."""

import importlib.util

import pytest

from tests.kills.kills import one_of_each


@pytest.mark.slow
def test_kills_change_no_byte_leave_no_process_and_hang_nothing(tmp_path):
    has_dask = importlib.util.find_spec("distributed") is not None
    kinds = ("workers", "schedulers")[: 2 if has_dask else 1]
    told = one_of_each(20211, tmp_path, kinds)
    assert {kind: (one.kills, one.faults) for kind, one in told.items()} == dict.fromkeys(kinds, (1, []))
