"""Write ``gtm_t2.xml`` and ``Engines/`` (JSBSim) from the numbers in ``gtm_t2.json``.

    python aircraft/gtm_t2/make_model.py           writes the files
    python aircraft/gtm_t2/make_model.py --check   exits 1 if the files differ from what would be written

The aerodynamics are a polynomial in the form of Grauer and Morelli, "Generic Global Aerodynamic Model for Aircraft",
J. Aircraft 2015 (doi 10.2514/1.C032888): one product per term, so that each number of the JSON can be found in the XML.
"""

import json
import sys
from pathlib import Path

HERE = Path(__file__).parent
RAD_PER_DEG = 0.017453292519943295
AXES = {  # coefficient -> JSBSim axis and the lengths that make it a force or a moment
    "CD": ("DRAG", ()),
    "CY": ("SIDE", ()),
    "CL": ("LIFT", ()),
    "Cl": ("ROLL", ("metrics/bw-ft",)),
    "Cm": ("PITCH", ("metrics/cbarw-ft",)),
    "Cn": ("YAW", ("metrics/bw-ft",)),
}
REGRESSORS = {
    "alpha": "aero/gtm/alpha-rad",
    "beta": "aero/gtm/beta-rad",
    "p": "aero/gtm/p-hat",
    "q": "aero/gtm/q-hat",
    "r": "aero/gtm/r-hat",
    "de": "fcs/elevator-pos-rad",
    "da": "fcs/aileron-pos-rad",
    "dr": "fcs/rudder-pos-rad",
}


def prop(name: str) -> str:
    return f"<property>{name}</property>"


def value(number: float) -> str:
    return f"<value>{number!r}</value>"


def powers_needed(coefficients: dict[str, dict[str, float]]) -> list[tuple[str, int]]:
    """(regressor, power >= 2) pairs that occur in any term, each to be computed once per step."""
    found = set()
    for terms in coefficients.values():
        for term in terms:
            for factor in term.split("*"):
                name, _, power = factor.partition("^")
                if power:
                    found.update((name, k) for k in range(2, int(power) + 1))
    return sorted(found)


def power_name(name: str, power: int) -> str:
    return REGRESSORS[name] if power == 1 else f"aero/gtm/{name}-{power}"


def term_xml(term: str, coefficient: float) -> str:
    if term == "1":
        return value(coefficient)
    factors = []
    for factor in term.split("*"):
        name, _, power = factor.partition("^")
        factors.append(prop(power_name(name, int(power or 1))))
    return f"<product>{value(coefficient)}{''.join(factors)}</product>"


def function(name: str, body: str) -> str:
    return f'  <function name="{name}">{body}</function>'


def regressors_xml(data: dict) -> list[str]:
    """Clamped angles, their excess, normalised rates and the powers."""
    clamp = data["extrapolation_guard"]["clamp_deg"]
    lines = []
    for angle in ("alpha", "beta"):
        low, high = (limit * RAD_PER_DEG for limit in clamp[angle])
        lines.append(function(REGRESSORS[angle], f"<max>{value(low)}<min>{value(high)}{prop(f'aero/{angle}-rad')}</min></max>"))
    low, high = (limit * RAD_PER_DEG for limit in clamp["alpha"])
    lines.append(function("aero/gtm/alpha-over", f"<max>{value(0.0)}<difference>{prop('aero/alpha-rad')}{value(high)}</difference></max>"))
    lines.append(function("aero/gtm/alpha-under", f"<min>{value(0.0)}<difference>{prop('aero/alpha-rad')}{value(low)}</difference></min>"))
    for rate, scale in (("p", "aero/bi2vel"), ("q", "aero/ci2vel"), ("r", "aero/bi2vel")):
        lines.append(function(REGRESSORS[rate], f"<product>{prop(scale)}{prop(f'velocities/{rate}-aero-rad_sec')}</product>"))
    for name, power in powers_needed(data["aero"]["coefficients"]):
        body = f"<product>{prop(power_name(name, 1))}{prop(power_name(name, power - 1))}</product>"
        lines.append(function(power_name(name, power), body))
    return lines


def aerodynamics_xml(data: dict) -> str:
    lines = ["<aerodynamics>", *regressors_xml(data)]
    guard = data["extrapolation_guard"]
    for name, (_, _) in AXES.items():
        lines.append(f'  <function name="aero/gtm/{name}"><sum>')
        lines += [f"   {term_xml(term, c)} <!-- {term} -->" for term, c in data["aero"]["coefficients"][name].items()]
        for side, excess in (("over", "alpha-over"), ("under", "alpha-under")):
            if name in guard[side]:
                lines.append(f"   <product>{value(guard[side][name])}{prop(f'aero/gtm/{excess}')}</product> <!-- guard -->")
        lines.append("  </sum></function>")
    for name, (axis, lengths) in AXES.items():
        factors = "".join(prop(p) for p in ("aero/qbar-psf", "metrics/Sw-sqft", *lengths, f"aero/gtm/{name}"))
        lines.append(f'  <axis name="{axis}">\n  {function(f"aero/gtm/{axis.lower()}", f"<product>{factors}</product>")}\n  </axis>')
    return "\n".join([*lines, "</aerodynamics>"])


def surface_xml(channel: str, surface: str, trim: str, data: dict) -> str:
    """Command sum, unit command to degrees, first-order servo with rate and position limits."""
    servo = data["actuators"]
    low, high = servo["limits_deg"][surface]
    travel = servo["deg_per_unit_command"][surface]
    return f""" <channel name="{channel}">
  <summer name="fcs/{surface}-sum"><input>fcs/{surface}-cmd-norm</input><input>fcs/{trim}</input><clipto><min>-1</min><max>1</max></clipto></summer>
  <pure_gain name="fcs/{surface}-cmd-deg"><input>fcs/{surface}-sum</input><gain>{travel}</gain></pure_gain>
  <actuator name="fcs/{surface}-servo"><input>fcs/{surface}-cmd-deg</input><lag>{servo["bandwidth_rad_s"]}</lag>
   <rate_limit>{servo["rate_limit_deg_s"]}</rate_limit><clipto><min>{low}</min><max>{high}</max></clipto><output>fcs/{surface}-pos-deg</output></actuator>
  <pure_gain name="fcs/{surface}-rad"><input>fcs/{surface}-pos-deg</input><gain>{RAD_PER_DEG}</gain><output>fcs/{surface}-pos-rad</output></pure_gain>
 </channel>"""


def controls_xml(data: dict) -> str:
    lag = data["engine"]["two_equal_lags_rad_s"]
    clip = "<clipto><min>0</min><max>1</max></clipto>"
    spool = "\n".join(
        f"""  <actuator name="fcs/spool-a-{i}"><input>fcs/throttle-cmd-norm[{i}]</input><lag>{lag}</lag>{clip}</actuator>
  <actuator name="fcs/spool-b-{i}"><input>fcs/spool-a-{i}</input><lag>{lag}</lag>{clip}<output>fcs/power-norm[{i}]</output></actuator>"""
        for i in (0, 1)
    )
    surfaces = (
        ("Pitch", "elevator", "pitch-trim-cmd-norm"),
        ("Roll", "aileron", "roll-trim-cmd-norm"),
        ("Yaw", "rudder", "yaw-trim-cmd-norm"),
    )
    channels = "\n".join(surface_xml(*names, data) for names in surfaces)
    return f"""<flight_control name="fcs">
{channels}
 <channel name="Spool"> <!-- the lag sits here, not in the engine, because JSBSim's trim bypasses actuators -->
{spool}
 </channel>
</flight_control>"""


def location(xyz: list[float]) -> str:
    x, y, z = xyz
    return f'<location unit="IN"><x>{x}</x><y>{y}</y><z>{z}</z></location>'


def body_xml(data: dict) -> str:
    geometry, mass, engine = data["geometry"], data["mass"], data["engine"]
    cg, ref = mass["cg_in"], geometry["aero_ref_in"]
    named = lambda name, xyz: location(xyz).replace("<location", f'<location name="{name}"', 1)  # noqa: E731
    engines = "\n".join(
        f"""  <engine file="p70"><feed>0</feed><thruster file="direct">{location(place)}
   <orient unit="DEG"><roll>0</roll><pitch>{engine["tilt_up_deg"]}</pitch><yaw>{toe}</yaw></orient></thruster></engine>"""
        for place, toe in zip(engine["location_in"], (engine["toe_in_deg"], -engine["toe_in_deg"]), strict=True)
    )
    inertia = "".join(f'<{k.lower()} unit="SLUG*FT2">{mass[f"{k}_slug_ft2"]}</{k.lower()}>' for k in ("Ixx", "Iyy", "Izz", "Ixz"))
    return f"""<metrics>
 <wingarea unit="FT2">{geometry["S_ft2"]}</wingarea><wingspan unit="FT">{geometry["b_ft"]}</wingspan><chord unit="FT">{geometry["cbar_ft"]}</chord>
 <htailarea unit="FT2">0</htailarea><htailarm unit="FT">0</htailarm><vtailarea unit="FT2">0</vtailarea><vtailarm unit="FT">0</vtailarm>
 {named("AERORP", ref)}{named("EYEPOINT", cg)}{named("VRP", cg)}
</metrics>
<mass_balance negated_crossproduct_inertia="false">
 {inertia}
 <emptywt unit="LBS">{mass["empty_lb"]}</emptywt>{named("CG", cg)}
</mass_balance>
<ground_reactions> <!-- never meant to be touched: contact ends a flight -->
 <contact type="STRUCTURE" name="BELLY">{location([cg[0], 0, 2])}<static_friction>0.8</static_friction><dynamic_friction>0.5</dynamic_friction>
  <spring_coeff unit="LBS/FT">500</spring_coeff><damping_coeff unit="LBS/FT/SEC">50</damping_coeff></contact>
</ground_reactions>
<propulsion>
{engines}
  <tank type="FUEL">{location(cg)}<capacity unit="LBS">{mass["fuel_lb"]}</capacity><contents unit="LBS">{mass["fuel_lb"]}</contents></tank>
</propulsion>"""


def aircraft_xml(data: dict) -> str:
    return f"""<?xml version="1.0"?>
<!-- Written by make_model.py from gtm_t2.json; do not edit. -->
<fdm_config name="gtm_t2" version="2.0" release="ALPHA">
<fileheader><author>vosc-testbed</author><description>GTM-T2 class 5.5 % transport: {data["aero"]["fit"]}</description></fileheader>
{body_xml(data)}
{controls_xml(data)}
{aerodynamics_xml(data)}
</fdm_config>
"""


def horner(coefficients: list[float], x: str) -> str:
    """XML of a polynomial, highest power first."""
    body = value(coefficients[0])
    for c in coefficients[1:]:
        body = f"<sum><product>{body}{x}</product>{value(c)}</sum>"
    return body


def engine_xml(data: dict) -> str:
    engine = data["engine"]
    percent = f"<product>{value(100.0)}{prop('fcs/power-norm[#]')}</product>"
    rpm = horner(engine["rpm_pct_poly_of_throttle_pct"], percent)
    cubic, _, _, constant = engine["thrust_poly_lb_of_rpm_pct"]
    static = f"<sum><product>{value(cubic)}<pow>{rpm}{value(3.0)}</pow></product>{value(constant)}</sum>"
    ram = f"<product>{value(engine['ram_drag_coef'])}{prop('aero/qbar-psf')}{prop('metrics/Sw-sqft')}</product>"
    net = f"<max>{value(0.0)}<difference><product>{prop('atmosphere/delta')}{static}</product>{ram}</difference></max>"
    full = engine["static_thrust_lb"]
    return f"""<?xml version="1.0"?>
<!-- Written by make_model.py from gtm_t2.json; do not edit.
 Net thrust = max(0, T(rpm) p/p0 - {engine["ram_drag_coef"]} qbar S). JSBSim's own spool law is bypassed: the whole thrust is carried by IdleThrust,
 a factor of milthrust. tsfc 0: fuel flow is not modelled, freeze the fuel. -->
<turbine_engine name="p70">
 <milthrust unit="LBS">{full}</milthrust><bypassratio>0</bypassratio><tsfc>0</tsfc><bleed>0</bleed>
 <idlen1>31.5</idlen1><idlen2>31.5</idlen2><maxn1>100</maxn1><maxn2>100</maxn2><augmented>0</augmented><injected>0</injected>
 <function name="IdleThrust"><quotient>{net}{value(full)}</quotient></function>
 <function name="MilThrust">{value(0.0)}</function>
</turbine_engine>
"""


def main() -> int:
    data = json.loads((HERE / "gtm_t2.json").read_text())
    files = {
        HERE / "gtm_t2.xml": aircraft_xml(data),
        HERE / "Engines" / "p70.xml": engine_xml(data),
        HERE / "Engines" / "direct.xml": '<?xml version="1.0"?>\n<direct name="Direct"></direct>\n',
    }
    if "--check" in sys.argv:
        return int(any(not path.exists() or path.read_text() != text for path, text in files.items()))
    for path, text in files.items():
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
