"""What stands between the sensor and the planner. A tracker is a file here and a line in ``TRACKERS``."""

from testbed.flight.tracking.base import Tracker

__all__ = ["TRACKERS", "Tracker"]

TRACKERS = {
    "none": "testbed.flight.tracking.base:Untracked",
    "alpha_beta": "testbed.flight.tracking.alpha_beta:AlphaBeta",
    "kalman": "testbed.flight.tracking.kalman:Kalman",
    "imm": "testbed.flight.tracking.imm:InteractingModels",
}
