"""What every test relies on."""
# ruff: noqa: E402

import os
import signal

from testbed.core import one_thread

one_thread.ask()  # before numpy is there

from hypothesis import settings

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
