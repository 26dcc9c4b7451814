"""An engine without processes, for tests that are about something else: a process takes a second to import what flies."""

from testbed.run.engines import attempt


class Here:
    """Calls, one after the other, as they are pulled."""

    name, workers = "here", 1

    def imap(self, fn, items):
        for number, item in enumerate(items):
            yield number, attempt(fn, item)
