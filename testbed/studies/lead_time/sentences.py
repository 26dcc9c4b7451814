"""What a study says in sentences, made from its numbers; and the names of what was compared."""

import math
from collections.abc import Mapping, Sequence

from testbed.show.words import named, number, percent
from testbed.studies.lead_time.compare import Priced, Shares, Who, limits, summary, winds
from testbed.studies.lead_time.line import Line

Groups = Mapping[Who, Sequence[Line]]
RUNG_NAMES = {
    "vo_instant": "point on rails",
    "kinematic": "point on rails",
    "point_mass": "point mass",
    "jsbsim": "six degrees of freedom",
}
ANSWER_NAMES = {
    "insertion_point": "through the insertion point",
    "direct": "direction at once",
    "flyable": "on a path within the aircraft's limits",
}


def rung(key: Who) -> str:
    """Which plant flies."""
    return named(RUNG_NAMES, key.rung)


def answer(name: str) -> str:
    """How the direction is applied."""
    return ANSWER_NAMES[name]


def sentences(by_who: Groups, calm: Groups, plain: Groups, turbulent: Mapping[Who, Shares]) -> list[str]:
    """The study's answer."""
    return [*_existence(plain), *_oncoming(plain), *_leads(plain), *_again(plain), *_limits(calm), *_winds(by_who), *_turbulence(turbulent)]


def _flown(plain: Groups, answered: str, swell: float) -> list[Who]:
    return [key for key in plain if key.aircraft and key.answer == answered and key.swell_m == swell and key.method == "scoam"]


def _existence(plain: Groups) -> list[str]:
    """Does a least lead exist, without a margin and with the largest?"""
    said = []
    swells = sorted({key.swell_m for key in plain if key.aircraft})
    for swell in dict.fromkeys([*swells[:1], *swells[-1:]]):
        parts = []
        for answered, words in ANSWER_NAMES.items():
            rails = [key for key in plain if not key.aircraft and key.answer == answered and key.swell_m == swell and key.method == "scoam"]
            for key in [*rails, *_flown(plain, answered, swell)]:
                of = summary(plain[key])
                parts.append(f"{of.n - of.never} of {of.n} for {key.aircraft or 'the point on rails'} ({words})")
        if parts:
            how = f"With a margin of {swell:g} m" if swell else "Without a margin"
            said.append(f"{how}, some lead lets SCOAM keep the radius in these encounters: {', '.join(parts)}.")
    return said


def _oncoming(plain: Groups) -> list[str]:
    """Who comes towards the aircraft, and who does not, for the point that flies through the insertion point."""
    keys = [key for key in plain if (key.rung, key.answer, key.method) == ("kinematic", "insertion_point", "scoam")]
    if not keys:
        return []
    key = max(keys, key=lambda key: key.swell_m)
    towards = [line for line in plain[key] if line.found.crossing_deg > 90.0]
    others = [line for line in plain[key] if line.found.crossing_deg <= 90.0]
    never = [sum(math.isinf(line.found.lead_s) for line in lines) for lines in (towards, others)]
    return [
        f"Through the insertion point and on rails, with a margin of {key.swell_m:g} m, no lead suffices in {never[0]} of {len(towards)} "
        f"encounters whose courses cross at more than 90 deg, and in {never[1]} of {len(others)} of the others."
    ]


def _leads(plain: Groups) -> list[str]:
    most = max((key.swell_m for key in plain if key.aircraft), default=0.0)
    said = []
    for key in (key for answered in ANSWER_NAMES for key in _flown(plain, answered, most)):
        of = summary(plain[key])
        if math.isinf(of.lead.value):
            continue
        seen = f" (the obstacle known from {number(of.range_m.value, 0)} m on)" if math.isfinite(of.range_m.value) else ""
        said.append(
            f"{key.aircraft}, {answer(key.answer)}, margin {most:g} m: the median encounter needs a lead of {number(of.lead.value, 2)} s"
            f"{seen}; the best open-loop manoeuvre needs {number(of.best.value, 2)} s, "
            f"so the method wastes {number(of.waste.value, 2)} s in the median."
        )
    return said


def _again(plain: Groups) -> list[str]:
    searched = [line for key, lines in plain.items() if key.aircraft for line in lines]
    if not searched:
        return []
    again = sum(line.found.fails_again for line in searched)
    share = percent(again / len(searched))
    return [f"More time is not always safer: in {again} of {len(searched)} searches ({share}) a method fails at a longer lead again."]


def _limits(calm: Groups) -> list[str]:
    """The dearest limit of each aircraft, alone and last, for the best manoeuvre and for the method."""
    costs = [one for one in limits({key: list(lines) for key, lines in calm.items()}) if one.answer == "direct"]
    said = []
    for aircraft in dict.fromkeys(one.aircraft for one in costs):
        mine = [one for one in costs if one.aircraft == aircraft]
        for who, median in (("the best manoeuvre", _best_median), ("SCOAM with its direction at once", _method_median)):
            dear = [max((one for one in mine if one.what.endswith(how)), key=median, default=None) for how in ("alone", "last")]
            if dear[0] and dear[1]:
                alone, last = (f"{one.what.split(',')[0]} ({number(median(one), 2)} s)" for one in dear if one)
                said.append(f"{aircraft}: the limit that costs {who} most is {alone} when it is the only one, {last} when it is the last.")
    return said


def _best_median(one: Priced) -> float:
    return one.best.difference_s.value


def _method_median(one: Priced) -> float:
    return one.method.difference_s.value


def _winds(by_who: Groups) -> list[str]:
    """Least and greatest median cost of a wind, over its directions."""
    costs = winds({key: list(lines) for key, lines in by_who.items()})
    said = []
    for group in dict.fromkeys((key.aircraft, key.answer, key.wind_mps) for key, _ in costs):
        aircraft, answered, speed = group
        mine = [one.method.difference_s.value for key, one in costs if (key.aircraft, key.answer, key.wind_mps) == group]
        low, high = number(min(mine), 2), number(max(mine), 2)
        said.append(
            f"{aircraft}, {answer(answered)}: a wind of {speed:g} m/s costs {low} to {high} s in the median, by where it comes from "
            f"({len(mine)} directions)."
        )
    return said


def _turbulence(turbulent: Mapping[Who, Shares]) -> list[str]:
    said = []
    for key, of in turbulent.items():
        best = max(range(len(of.kept)), key=lambda k: of.kept[k])
        shown = f"99 % is shown from {of.shown_from_s:g} s on" if math.isfinite(of.shown_from_s) else "99 % is not shown at any lead"
        said.append(
            f"{key.aircraft} in {key.turbulence} turbulence, {answer(key.answer)}: at most {of.kept[best]} of {of.n} flights keep "
            f"the radius (lead {of.leads_s[best]:g} s); {shown}."
        )
    return said
