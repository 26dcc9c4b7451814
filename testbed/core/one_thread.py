"""One thread for linear algebra: our matrices are small, and threads that wait for each other cost more than they save.

Tuning an aircraft takes a third of the processor time with it. It must be said before numpy is imported.
"""

import os

SETTINGS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def ask() -> None:
    """For this process and those that it starts; what the user has set stays."""
    for name, value in SETTINGS.items():
        os.environ.setdefault(name, value)
