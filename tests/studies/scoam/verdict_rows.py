"""Rows made by hand: what each flight came to is known, so the word is too."""

from testbed.results.columns import nothing_measured

HARMLESS = {  # within the limits of either aircraft
    "max_bank_deg": 30.0,
    "max_load_factor": 1.3,
    "min_load_factor": 0.8,
    "max_roll_rate_dps": 20.0,
    "cross_track_max_m": 0.5,
}
AIRCRAFT = ("gtm_t2", "c172p")
SINGLE = ("single_106", "single_106_10")
RUNGS = (
    "vo_instant kinematic point_ideal point_roll point_load point_speed point_no_roll point_no_load point_no_speed point_mass jsbsim"
).split()


def row(clearance, part="calm", method="scoam", rung="kinematic", replicate=0, aircraft="gtm_t2", **more):
    """A row of a flight with that least clearance; ``more``: metrics by name, anything else is a label."""
    metrics = nothing_measured()
    labels = {"part": part, "method": method, "rung": rung, "flown_by": aircraft, "encounter": "single_106"}
    labels |= {name: value for name, value in more.items() if name not in metrics}
    metrics |= HARMLESS | {"outcome": "collided" if clearance < -1e-6 else "reached", "least_clearance_m": clearance}
    metrics |= {"path_length_m": 500.0, "begin_s_m": 0.0, "replans": int(method != "none")}
    metrics |= {name: value for name, value in more.items() if name in metrics}
    cell = "/".join([*labels.values(), str(replicate)])
    who = {"flight_id": cell, "cell": cell, "replicate": replicate, "seed": 1, "plant": rung, "aircraft": aircraft, "method": method}
    return who | metrics | {"labels": labels, "events": []}


def threat(**where):
    """The flight without planner that makes a place a threat."""
    return row(-17.0, method="none", **where)


def calm(rails, flown, encounters=SINGLE, aircraft=AIRCRAFT, **metrics):
    """Calm flights of SCOAM; ``rails`` and ``flown``: clearance, or one by aircraft."""
    out = []
    for encounter in encounters:
        for name in aircraft:
            for rung, value in (("kinematic", rails), ("jsbsim", flown)):
                where = {"encounter": encounter, "aircraft": name, "rung": rung}
                out += [threat(**where), row(value[name] if isinstance(value, dict) else value, **where, **metrics)]
    return out


def windy(clearances, mps="10", design="anchored", rails=2.0, **where):
    """Flights in wind from as many directions as there are clearances, on rails and flown."""
    out = []
    for n, value in enumerate(clearances):
        air = where | {"part": "wind", "design": design, "wind_mps": mps, "wind_from": str(n)}
        for rung, one in (("kinematic", rails), ("jsbsim", value)):
            out += [threat(rung=rung, **air), row(one, rung=rung, **air)]
    return out


def rough(clearances, severity="light", **where):
    """Flights in turbulence, one a seed."""
    air = where | {"part": "turbulence", "severity": severity, "rung": "jsbsim"}
    return [made for n, value in enumerate(clearances) for made in (threat(replicate=n, **air), row(value, replicate=n, **air))]


def drawn(pairs, encounter="single_106", method="scoam", **metrics):
    """Robustness flights: (on rails, flown) by replicate, the first one nominal."""
    out = []
    for n, (rails, flown) in enumerate(pairs):
        for rung, value in (("kinematic", rails), ("jsbsim", flown)):
            out.append(row(value, part="robustness", method=method, rung=rung, replicate=n, encounter=encounter, **metrics))
    return out


def population(figures, metric, rung="kinematic", clearance=1.0):
    """Encounters, each a dict of method -> figure of one metric; clearances 1 m unless the metric is the clearance."""
    out = []
    for n, methods in enumerate(figures):
        where = {"part": "population", "rung": rung, "replicate": n, "encounter": "paper"}
        out.append(threat(**where))
        for method, value in methods.items():
            least = value if metric == "least_clearance_m" else clearance
            out.append(row(least, method=method, **where, **({} if metric == "least_clearance_m" else {metric: value})))
    return out
