"""A fixed-wing flight-dynamics co-simulation testbed: JSBSim flies what a velocity-obstacle planner plans.

from testbed import load_campaign, expand, fly, measure
for plan in expand(load_campaign("campaigns/smoke.yaml")):
print(plan.cell, measure(fly(plan)).least_clearance_m)

from testbed import open_run
open_run("reports/runs/smoke").results  # one row a flight, a pandas table

from testbed import make_env
env = make_env("campaigns/smoke.yaml", cell="jsbsim/scoam")  # reset(seed), step(command): docs/stepping.md
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from testbed.campaign import expand, load_campaign
    from testbed.flight.fly import fly
    from testbed.results.metrics import measure
    from testbed.run.opened import open_run
    from testbed.run.stepping import make_env

__all__ = ["expand", "fly", "load_campaign", "make_env", "measure", "open_run"]
_HOME = {
    "fly": "testbed.flight.fly",
    "measure": "testbed.results.metrics",
    "expand": "testbed.campaign",
    "load_campaign": "testbed.campaign",
    "make_env": "testbed.run.stepping",
    "open_run": "testbed.run.opened",
}


def __getattr__(name: str) -> Any:
    """Import on first use, so that ``testbed --help`` need not load the physics."""
    if name not in _HOME:
        raise AttributeError(f"module 'testbed' has no attribute '{name}'")
    from importlib import import_module

    return getattr(import_module(_HOME[name]), name)
