"""What every test relies on."""
# ruff: noqa: E402

import signal

from testbed.core import one_thread

one_thread.ask()  # before numpy is there

from tests.made import browser, make_metrics, make_record

__all__ = ["browser", "make_metrics", "make_record"]

# A shell that starts the suite in the background tells it, and all that it starts, to ignore Ctrl-C. Some tests are about Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
