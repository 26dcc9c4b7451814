"""Guidance laws over time: from the first threat until the flight is clear each says at every step how to accelerate.

One file each, and a line in ``LAWS``: a campaign names them beside the directions (``method: {kind: proportional_navigation}``). What
they must do is in ``testbed.flight.planning.steering``. Unless a law says otherwise it looks at one obstacle, the most imminent threat,
and turns the relative velocity (own less obstacle, which no wind changes) by an acceleration across its own velocity through the air as
the planner knows it (``replan.vo_frame``, ``replan.wind_known``), so that in a steady wind the airspeed is kept.
"""

LAWS = {
    "geometric_guidance": "testbed.flight.laws.geometric_guidance:GeometricGuidance",
    "proportional_navigation": "testbed.flight.laws.proportional_navigation:ProportionalNavigation",
    "constant_curvature": "testbed.flight.laws.constant_curvature:ConstantCurvature",
    "extended_navigation": "testbed.flight.laws.extended_navigation:ExtendedNavigation",
    "minimum_effort": "testbed.flight.laws.minimum_effort:MinimumEffort",
    "field_guidance": "testbed.flight.laws.field_guidance:FieldGuidance",
}
