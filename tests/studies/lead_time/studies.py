"""Plans of searches that several tests use."""

from typing import Any

from testbed.campaign.words.settings import FlightPlan

STRAIGHT = {"start_enu_m": [0, 0, 0], "goal_enu_m": [900, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
STUDY = {"leads_s": [0.5, 1.0, 2.0, 3.0], "obstacle_speed_mps": [20, 50], "radius_m": [25, 30]}
RAILS: dict[str, Any] = {"plant": {"kind": "kinematic"}}
AT_ONCE: dict[str, Any] = {"replan": {"answer": "direct", "rejoin": {"when": "clear"}}}
HEAD_WIND: dict[str, Any] = {"air": {"wind": {"kind": "steady", "speed_mps": 10.0, "from_deg": 90.0}}}
SIDE_WIND: dict[str, Any] = {"air": {"wind": {"kind": "steady", "speed_mps": 10.0, "from_deg": 20.0}}}


def study(options: dict[str, Any] = STUDY, **changes: Any) -> FlightPlan:
    """A search on a straight level route, with changes."""
    who = {"flight_id": "test", "campaign": "test", "cell": "test", "labels": {}, "replicate": 0, "seed": 20210}
    settings: dict[str, Any] = {
        "route": STRAIGHT,
        "sensor": {"range_m": 10000},
        "traffic": {"in_wind": "anchored"},
        "replan": {"rejoin": {"when": "clear"}},
        "study": {"kind": "lead_time", "options": options},
    }
    return FlightPlan.model_validate(who | settings | changes)
