"""From what is seen to a new path, and back. A planner is a file here and a line in ``PLANNERS``."""

PLANNERS = {"replan": "testbed.flight.planning.replan:Planner"}
