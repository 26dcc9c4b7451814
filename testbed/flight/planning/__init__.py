"""From what is seen to a new path, and back. A planner is a file here and a line in ``PLANNERS``."""

from testbed.flight.planning.context import Context, Step
from testbed.flight.planning.steering import Steer

__all__ = ["PLANNERS", "Context", "Steer", "Step"]

PLANNERS = {
    "replan": "testbed.flight.planning.replan:Replanner",
    "survivor": "testbed.flight.planning.survivor:Survivor",
}
