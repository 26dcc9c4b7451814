"""The readings under which every row is computed, and the assumptions a row may need: each defined once, here."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from testbed.studies.scoam.audit.printed import Number


@dataclass(frozen=True)
class Reading:
    """One way to read the paper: printed inputs replaced by others, or a choice between definitions made differently (``switches``)."""

    name: str
    what: str
    why: str
    replaced: Mapping[str, Number] = field(default_factory=dict)
    switches: frozenset[str] = frozenset()


DETECTION, CHAIN, COMPONENTS = "detection distance", "from printed results", "angle by components"

AS_PRINTED: Final = Reading(
    "as_printed",
    "The printed initial conditions put through the printed equations.",
    "What the paper says.",
)

READINGS: Final = (
    Reading(
        "azimuth_106",
        "Table 1: the obstacle flies towards azimuth 106 deg instead of 135 deg.",
        "Table 3 prints (106, 11.4) for an obstacle at almost the same place; with 135 deg there is no threat by the paper's own test.",
        {"o.az": Number("106")},
    ),
    Reading(
        "direction_106_10",
        "Table 1: the obstacle flies towards (106.1, 10.4) deg instead of (135, 12.4) deg.",
        "Eq. 35 puts Q_avo straight ahead of the obstacle, and the printed Q_avo - P_o points there. The direction of Q_avo is then no "
        "test any more, its distance still is.",
        {"o.az": Number("106.1"), "o.el": Number("10.4")},
    ),
    Reading(
        "o2_elevation_plus",
        "Table 3: O_2 climbs at +15.4 deg instead of descending at -15.4 deg.",
        "As printed O_2 is no threat; it starts 22 m below the UAV, and a minus too many is the smallest slip that explains it.",
        {"o2.el": Number("15.4")},
    ),
    Reading(
        "detection_distance",
        "d_0 is the detection distance, 100 m, wherever the text writes it: alpha_0 = arcsin(R / d_0), t = (d_0 - R) / |v_o| in eq. 34.",
        "The letter of step 1 of section 2 and of section 4.3.2. Otherwise alpha_0 takes the present distance and t is as in arrival.",
        switches=frozenset({DETECTION}),
    ),
    Reading(
        "printed_results",
        "A result is computed from the printed results before it: directions from the printed cap or K, deflections from the printed "
        "direction, lengths and times from the printed Q_avo.",
        "Separates what does not follow from the inputs from what does not follow from the paper's own numbers.",
        switches=frozenset({CHAIN}),
    ),
    Reading(
        "component_angle",
        "As printed_results, with a deflection taken as sqrt(dpsi^2 + dtheta^2) instead of the angle in space.",
        "Section 5.2 prints a deflection as the pair (dpsi, dtheta), and this is how a pair becomes the one number of Tables 2 and 4.",
        switches=frozenset({CHAIN, COMPONENTS}),
    ),
)

ASSUMPTIONS: Final[Mapping[str, str]] = {
    "set_values_exact": "Own speed 50 m/s, detection distance 100 m, radii 25 and 30 m, P_s and P_f are supposed by the text, not rounded. "
    "All other printed inputs carry half a unit in the last place.",
    "angles": "Azimuth counter-clockwise from +x, elevation up from the x-y plane (eq. 16); atan2 where eq. 19 and 26 lose the sign of y.",
    "without_threat": "Eq. 5-28 are evaluated whether or not the threat test asks for an avoidance.",
    "same_own_state": "Section 5.2 prints no state of the UAV; it is that of Table 1.",
    "k_1_25": "k = 1.25 in eq. 35 (the paper prints only k >= 1): the one value that serves both cases.",
    "arrival": "t in eq. 34 is the time the UAV needs to fly straight to Q_avo (the paper leaves t open for one obstacle).",
    "major_o1": "In section 5.2 Q_avo is built from O_1, which has the smaller t_c by 4.3.2.",
    "time_to_q": "The obstacle avoidance time is that of the straight line P_t to Q_avo at 50 m/s: the least any path can need.",
    "space_angle": "A deflection is the angle in space between old and new velocity, unless the reading says otherwise.",
    "planes_of_eq_23": "A matrix of two rows cannot multiply a vector of three components: of eq. 23 the right one is taken for (x, y) and "
    "the left one for (horizontal, z).",
    "k_by_y": "Of K the coordinate y_k is chosen, as printed; x_k and z_k follow from eq. 32-33, K on the rim of either cap.",
    "nearest_branch": "Where an equation or a method has several solutions and the paper does not say which it takes, the one "
    "nearest to the print is shown.",
    "droam": "Reference [19] is read as: constant speed, turn in azimuth only (HP) or in elevation only (VP), to either side, until the "
    "velocity has left every cone; in the readings with printed results, every printed cap.",
    "route_tangents": "The path P_s to P_f is the canonical PH quintic with end tangents (40.87, 26.13) and (10.00, 2.84) deg, which "
    "passes P_t with the printed direction; the paper prints none.",
    "ph_magnitudes": "End derivatives of the PH curves are as long as the chord; the paper prints none.",
    "common_q": "Eq. 34-35 do not depend on the method, so DROAM has the insertion point of SCOAM; the paper prints none for it.",
}

UNPRINTED: Final = frozenset({"route_tangents", "ph_magnitudes", "common_q"})
"""Assumptions for something the paper would have to print: under them neither agreement nor disagreement decides anything."""

UNREAD: Final = frozenset({"droam"})
"""Assumptions for a method the paper only cites: agreement counts, disagreement decides nothing."""
