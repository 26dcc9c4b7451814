"""The rows of the audit: every result of section 5 and Tables 1-4, and how it is computed."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from testbed.studies.scoam.audit import geometry as geo
from testbed.studies.scoam.audit import manoeuvres as ma
from testbed.studies.scoam.audit.case import Case
from testbed.studies.scoam.audit.printed import PRINTED
from testbed.studies.scoam.audit.readings import CHAIN
from testbed.studies.scoam.audit.row import Row, relation, value
from vosc.vec import norm, sub

BASE = ("set_values_exact", "angles")
THREAT = (*BASE, "without_threat")
PH = ("route_tangents", "ph_magnitudes")
POINT_ASSUMPTIONS = (*BASE, "k_1_25", "arrival")
DROAM = ("droam", "nearest_branch")


def rows() -> tuple[Row, ...]:
    """All rows, in the order of the paper."""
    return (*_sentences(), *_route(), *_table_1(), *_section_5_1(), *_table_2(), *_table_3(), *_section_5_2(), *_table_4())


def _sentences() -> Iterator[Row]:
    """Where a formula and the words or formulas beside it say two things, put as numbers with the single case."""
    yield relation(
        "eq_23",
        "Section 3.2.1",
        "angle between the velocity of eq. 23 and that of eq. 21-22, with the direction of section 5.1",
        "0",
        "deg",
        geo.equation_23_off,
        (*THREAT, "planes_of_eq_23"),
        "check",
    )
    yield relation(
        "q_behind",
        "Section 4.3.1",
        "distance of Q_avo, behind the obstacle as the sentence above eq. 35 says, from the printed one",
        "0",
        "m",
        geo.behind_off,
        POINT_ASSUMPTIONS,
        "check",
    )


def _route() -> Iterator[Row]:
    yield relation(
        "route_flyable",
        "Section 5, Fig. 8",
        "least radius of the path P_s to P_f",
        "flyable",
        "m",
        lambda case: ma.route(case).min_radius_m,
        (*BASE, *PH),
        "claim",
    )


def _cap_rows(where: str, name: str) -> Iterator[Row]:
    g, sub_name = geo.CAP_OF[name], {"o": "", "o1": "_1", "o2": "_2"}[name]
    yield relation(
        f"threat_{name}",
        where,
        f"threat judgement of O{sub_name}: alpha_0 - alpha",
        "> 0",
        "deg",
        partial(geo.threat_margin, name=name),
        BASE if name == "o" else (*BASE, "same_own_state"),
        "judgement",
    )
    for which, symbol, unit in (("r", "r", "m/s"), ("az", "psi_r", "deg"), ("el", "theta_r", "deg"), ("gamma", "gamma", "deg")):
        assumptions = THREAT if name == "o" else (*THREAT, "same_own_state")
        yield value(
            f"{g}.{which}", where, f"{symbol} of the cap of O{sub_name}", unit, partial(geo.cap_value, name=name, which=which), assumptions
        )
    yield relation(
        f"speed_{g}",
        where,
        f"own speed r / cos(gamma) of the cap of O{sub_name}",
        "50",
        "m/s",
        partial(geo.implied_speed, g=g),
        BASE,
        "check",
    )


def _table_1() -> Iterator[Row]:
    yield from _cap_rows("Table 1", "o")


def _point_rows(where: str, name: str, q: str, assumptions: tuple[str, ...]) -> Iterator[Row]:
    for index, axis in enumerate("xyz"):

        def formula(case: Case, index: int = index) -> float:
            return geo.insertion(case, name)[0][index]

        yield value(f"{q}.{axis}", where, f"Q_avo {axis}", "m", formula, assumptions)


def _section_5_1() -> Iterator[Row]:
    where = "Section 5.1"
    yield from _point_rows(where, "o", "q", POINT_ASSUMPTIONS)
    for index, (axis, symbol) in enumerate((("az", "psi_u"), ("el", "theta_u"))):

        def formula(case: Case, index: int = index) -> float:
            return geo.degrees(geo.scoam_direction(case))[index]

        yield value(f"dir.{axis}", where, f"avoidance direction {symbol}", "deg", formula, THREAT)
    yield relation(
        "dir_on_cap",
        where,
        "angle between the printed direction and the printed cap's axis, minus gamma",
        "0",
        "deg",
        lambda case: geo.deflection(geo.heading(case, "g"), geo.heading(case, "dir")) / geo.DEG - case["g.gamma"],
        BASE,
        "check",
    )
    yield relation(
        "deflection_least",
        where,
        "deflection of SCOAM above the least that leaves the cone",
        "0",
        "deg",
        lambda case: geo.deflection(geo.heading(case, "own"), geo.critical_direction(case)) / geo.DEG - geo.least_turn(case),
        (*THREAT, "space_angle"),
        "claim",
    )
    yield relation(
        "path_safe",
        where,
        "clearance of the re-planned path from O",
        "> 0",
        "m",
        partial(ma.clearance, name="o"),
        (*BASE, *PH),
        "claim",
    )
    yield relation(
        "path_flyable",
        where,
        "least radius of the re-planned path, P_t to Q_avo",
        "flyable",
        "m",
        lambda case: ma.legs(case, "o", geo.direction_in_force(case))[0].min_radius_m,
        (*POINT_ASSUMPTIONS, "without_threat", *PH),
        "claim",
    )


def _comparison(where: str, table: str, name: str) -> Iterator[Row]:
    """The nine numbers of Table 2 or 4."""
    point = POINT_ASSUMPTIONS if name == "o" else (*POINT_ASSUMPTIONS, "same_own_state", "major_o1")
    for method, label in (("scoam", "SCOAM"), ("hp", "DROAM/HP"), ("vp", "DROAM/VP")):
        if method == "scoam":
            how: tuple[str, ...] = ("without_threat",) if name == "o" else ("without_threat", "k_by_y", "nearest_branch")
            common: tuple[str, ...] = ()
        else:
            how, common = DROAM, ("common_q",)
        state = () if name == "o" else ("same_own_state",)
        key = f"{table}.{method}_deflection"
        yield value(
            key,
            where,
            f"{label} deflection",
            "deg",
            partial(_table_turn, name=name, method=method, key=key),
            (*BASE, *state, "space_angle", *how),
        )
        key = f"{table}.{method}_length"
        yield value(
            key, where, f"{label} path length", "m", partial(_table_length, name=name, method=method, key=key), (*point, *how, *common, *PH)
        )
        key = f"{table}.{method}_time"
        yield value(key, where, f"{label} avoidance time", "s", partial(geo.time_to_point, name=name), (*point, "time_to_q", *common))


def _table_turn(case: Case, name: str, method: str, key: str) -> float:
    if name == "o1" and method == "scoam" and case.has(CHAIN):
        return geo.turn(case, geo.turned(case))
    return ma.nearest(ma.turns(case, name, method), PRINTED[key].value)


def _table_length(case: Case, name: str, method: str, key: str) -> float:
    return ma.nearest(ma.lengths(case, name, method), PRINTED[key].value)


def _least_droam(case: Case, name: str) -> float:
    return min(ma.turns(case, name, "hp") + ma.turns(case, name, "vp"))


def _table_2() -> Iterator[Row]:
    where = "Table 2"
    yield from _comparison(where, "t2", "o")
    yield relation(
        "t2_least_deflection",
        where,
        "least DROAM deflection (either plane, either side) minus SCOAM's",
        "> 0",
        "deg",
        lambda case: _least_droam(case, "o") - ma.turns(case, "o", "scoam")[0],
        (*THREAT, "space_angle", "droam"),
        "claim",
    )
    yield relation(
        "t2_shortest",
        where,
        "shortest DROAM path (either plane, either side) minus SCOAM's",
        "> 0",
        "m",
        lambda case: min(ma.lengths(case, "o", "hp") + ma.lengths(case, "o", "vp")) - ma.lengths(case, "o", "scoam")[0],
        (*POINT_ASSUMPTIONS, "without_threat", "droam", "common_q", *PH),
        "claim",
    )
    yield relation(
        "t2_fastest",
        where,
        "least DROAM time along the PH leg to Q_avo minus SCOAM's",
        "> 0",
        "s",
        lambda case: (
            min(ma.leg_time(case, "o", new) for plane in ("hp", "vp") for new in ma.droam(case, "o", plane))
            - ma.leg_time(case, "o", ma.scoam(case, "o"))
        ),
        (*POINT_ASSUMPTIONS, "without_threat", "droam", "common_q", *PH),
        "claim",
        decimals=2,
    )


def _table_3() -> Iterator[Row]:
    yield from _cap_rows("Table 3", "o1")
    yield from _cap_rows("Table 3", "o2")


def _section_5_2() -> Iterator[Row]:
    where = "Section 5.2"
    point = (*POINT_ASSUMPTIONS, "same_own_state", "major_o1")
    k_rule = (*THREAT, "same_own_state", "k_by_y", "nearest_branch")
    yield from _point_rows(where, "o1", "q2", point)
    for index, axis in enumerate("xyz"):

        def coordinate(case: Case, index: int = index) -> float:
            return geo.k_point(case)[index]

        row = value(f"k.{axis}", where, f"K {axis}", "m", coordinate, k_rule)
        yield replace(row, kind="choice") if axis == "y" else row
    yield relation(
        "k_norm",
        where,
        "|P_u K| (eq. 32)",
        "50",
        "m/s",
        lambda case: norm(sub(geo.position(case, "k"), geo.position(case, "own"))),
        (*BASE, "same_own_state"),
        "check",
    )
    for index, (axis, symbol) in enumerate((("az", "psi_u"), ("el", "theta_u"))):

        def angle(case: Case, index: int = index) -> float:
            return geo.degrees(geo.k_velocity(case))[index]

        yield value(f"dir2.{axis}", where, f"avoidance direction {symbol}", "deg", angle, k_rule)
    for index, (axis, symbol) in enumerate((("az", "delta psi_u"), ("el", "delta theta_u"))):

        def change(case: Case, index: int = index, axis: str = axis) -> float:
            return geo.degrees(geo.multi_direction(case))[index] - case[f"own.{axis}"]

        yield value(f"turn2.{axis}", where, f"deflection {symbol}", "deg", change, k_rule)
    for key, what, formula in (
        ("k_on_boundary", "K", lambda case: geo.union_margin(case, sub(geo.position(case, "k"), geo.position(case, "own")))),
        ("dir2_on_boundary", "the printed direction", lambda case: geo.union_margin(case, geo.heading(case, "dir2"))),
        ("turn2_on_boundary", "the direction of the printed deflection", lambda case: geo.union_margin(case, geo.turned(case))),
    ):
        yield relation(
            key, where, f"angle of {what} outside both printed caps (eq. 33)", "0", "deg", formula, (*BASE, "same_own_state"), "check"
        )
    yield relation(
        "path2_safe",
        where,
        "least clearance of the re-planned path from O_1 and O_2",
        "> 0",
        "m",
        partial(ma.clearance, name="o1"),
        (*BASE, "same_own_state", *PH),
        "claim",
    )


def _table_4() -> Iterator[Row]:
    yield from _comparison("Table 4", "t4", "o1")
    yield relation(
        "t4_least_deflection",
        "Table 4",
        "least DROAM deflection (either plane, either side) minus SCOAM's",
        "> 0",
        "deg",
        lambda case: _least_droam(case, "o1") - ma.turns(case, "o1", "scoam")[0],
        (*THREAT, "same_own_state", "space_angle", "droam", "k_by_y", "nearest_branch"),
        "claim",
    )
