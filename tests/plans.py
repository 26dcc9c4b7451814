"""Plans that many tests fly."""

from typing import Any

from testbed.campaign.words.settings import FlightPlan

PAPER_ROUTE = {
    "start_enu_m": [0, 0, 0],
    "goal_enu_m": [500, 200, 100],
    "start_direction_deg": [40.87, 26.13],
    "goal_direction_deg": [10.00, 2.84],
}
READINGS = {"as_printed": [135, 12.4], "azimuth_106": [106, 12.4], "direction_106_10": [106.1, 10.4]}


def paper_obstacle(reading: str = "direction_106_10", **changes: Any) -> dict[str, Any]:
    """The obstacle of Table 1 under a reading of its direction."""
    return {
        "name": "O",
        "radius_m": 25,
        "position_enu_m": [254, 63.6, 60.7],
        "speed_mps": 40,
        "direction_deg": READINGS[reading],
        "when": {"own_reaches_enu_m": [162, 101, 64.3]},
    } | changes


def plan(**changes: Any) -> FlightPlan:
    """A flight on the paper's route, with changes."""
    who = {"flight_id": "test", "campaign": "test", "cell": "test", "labels": {}, "replicate": 0, "seed": 0}
    return FlightPlan.model_validate(who | {"route": PAPER_ROUTE} | changes)


KINEMATIC: dict[str, Any] = {"plant": {"kind": "kinematic"}}
GTM: dict[str, Any] = {"plant": {"kind": "jsbsim"}, "aircraft": "gtm_t2", "begin": {"climb_at_most_deg": 18}}
C172P: dict[str, Any] = {"plant": {"kind": "jsbsim"}, "aircraft": "c172p", "geometry": "level"}
