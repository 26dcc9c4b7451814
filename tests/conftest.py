"""What every test relies on."""
# ruff: noqa: E402

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from testbed.core import one_thread

one_thread.ask()  # before numpy is there

from testbed.core.kept import forget_everything
from tests.made import browser, make_metrics, make_record

__all__ = ["browser", "make_metrics", "make_record"]

# A test passes or fails by what the code is, not by the hour: every run draws the same examples, and no example has a time limit, which a
# busy machine would break. `make fuzz` looks for others (HYPOTHESIS_PROFILE=random); what it finds is kept as an example of the test.
settings.register_profile("same", derandomize=True, deadline=None)
settings.register_profile("random", derandomize=False, deadline=None, max_examples=1000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))

# A shell that starts the suite in the background tells it, and all that it starts, to ignore Ctrl-C. Some tests are about Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


# Files that take longest, in seconds or in waiting, begin: a long one that began last would leave the other core idle. What waits most
# comes first, while types are checked beside it (Makefile).
LONGEST = [
    *("kills/test_kills", "run/test_dask_engine", "run/test_poison", "run/test_trial", "run/test_engines", "package/test_wheel"),
    *("cli/test_cli", "run/test_plugins", "fuzz/test_fuzz_runs", "results/test_checks", "airframe/test_tune", "airframe/test_new"),
    *("vosc/test_insertion_reach", "vosc/test_methods", "campaign/test_fuzz", "run/test_verdict_run", "studies/scoam/test_audit"),
]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The order of files, for ``--no-loadscope-reorder``: otherwise those with the most tests begin, however short these are."""
    rank = {(Path(__file__).parent / f"{name}.py"): k for k, name in enumerate(LONGEST)}
    items.sort(key=lambda item: rank.get(item.path, len(rank)))


@pytest.fixture(autouse=True)
def _nothing_kept_of_a_patched_testbed(request: pytest.FixtureRequest) -> Iterator[None]:
    """What a test has changed in the code must not be found again by the next test, nor what was kept before by this one."""
    patched = "monkeypatch" in request.fixturenames
    if patched:
        forget_everything()
    yield
    if patched:
        forget_everything()
