"""What every test relies on."""
# ruff: noqa: E402

import signal
from collections.abc import Iterator

import pytest

from testbed.core import one_thread

one_thread.ask()  # before numpy is there

from testbed.core.kept import forget_everything
from tests.made import browser, make_metrics, make_record

__all__ = ["browser", "make_metrics", "make_record"]

# A shell that starts the suite in the background tells it, and all that it starts, to ignore Ctrl-C. Some tests are about Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def _nothing_kept_of_a_patched_testbed(request: pytest.FixtureRequest) -> Iterator[None]:
    """What a test has changed in the code must not be found again by the next test, nor what was kept before by this one."""
    patched = "monkeypatch" in request.fixturenames
    if patched:
        forget_everything()
    yield
    if patched:
        forget_everything()
