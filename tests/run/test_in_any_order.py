"""What a process keeps from flight to flight shows in no flight: rows and columns are those of a fresh process, in any order."""

import hashlib
import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from testbed import fly
from testbed.campaign.words.settings import FlightPlan
from testbed.core.catalogue import AIRCRAFT_ROOT
from testbed.core.kept import forget_everything
from testbed.results.plain import plain
from testbed.run.job import Job, run_job
from tests.plans import C172P, GTM, paper_obstacle, plan

STEADY = {"kind": "steady", "speed_mps": 7, "from_deg": 250}
DRYDEN = {"wind": STEADY, "turbulence": {"kind": "dryden", "severity": "light"}}
RACETRACK = {"start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0], "shape": {"kind": "racetrack", "straight_m": 100, "radius_m": 140}}
MET: dict[str, Any] = {"obstacles": [paper_obstacle()]}
ANCHORED: dict[str, Any] = {"air": {"wind": STEADY}, "traffic": {"in_wind": "anchored"}}
POINT = {"plant": {"kind": "kinematic"}}
PLANS: dict[str, FlightPlan] = {
    "gtm": plan(**GTM, **MET),
    "gtm level": plan(**{**GTM, "begin": {"at_route_s_m": 0}, "geometry": "level"}, **MET),
    "gtm in turbulence": plan(**GTM, **MET, air=DRYDEN),
    "gtm, another seed": plan(**GTM, **MET, air=DRYDEN, seed=5),
    "gtm, varied": plan(**GTM, **MET, vary={"derivatives_share": 0.1}),
    "cessna": plan(**C172P, **MET),
    "point": plan(**POINT, **MET),
    "point, anchored": plan(**POINT, **MET, **ANCHORED),
    "point, anchored the other way": plan(**POINT, **MET, **{**ANCHORED, "air": {"wind": {**STEADY, "from_deg": 70}}}),
    "point in turbulence": plan(**POINT, **MET, air=DRYDEN),
    "point around": plan(**POINT, route=RACETRACK),
    "point mass": plan(plant={"kind": "point_mass"}, **MET, air=DRYDEN, method={"kind": "orca"}),
}


def told(a_plan: FlightPlan) -> str:
    """A hash of a flight's row and of every bit of its columns."""
    record = fly(a_plan)
    text = json.dumps(plain(run_job(Job(a_plan)).row), sort_keys=True)
    columns = b"".join(name.encode() + column.tobytes() for name, column in record.columns.items())
    return hashlib.sha256(text.encode() + columns).hexdigest()


def fresh(names: list[str]) -> list[str]:
    """The same, flown in this order by a process of its own."""
    code = f"from tests.run.test_in_any_order import PLANS, told\nfor name in {names!r}: print(told(PLANS[name]))"
    here = Path(__file__).parents[2]
    return subprocess.run([sys.executable, "-c", code], cwd=here, capture_output=True, text=True, check=True).stdout.split()


@pytest.mark.slow
def test_a_flight_is_that_of_a_fresh_process_whatever_was_flown_before() -> None:
    names = list(PLANS)
    alone = {}
    for name in names:
        forget_everything()
        alone[name] = told(PLANS[name])
    assert len(set(alone.values())) == len(names), "they differ"
    forget_everything()
    forth, back = ([(name, told(PLANS[name])) for name in order] for order in (names, names[::-1]))
    again = [(name, told(PLANS[name])) for name in ("gtm", "cessna", "gtm", "gtm in turbulence", "gtm")]
    for name, found in (*forth, *back, *again):
        assert found == alone[name], name
    sample = ["gtm in turbulence", "point, anchored", "gtm"]
    assert fresh(sample) == [alone[name] for name in sample]
    assert fresh(sample[::-1]) == [alone[name] for name in sample[::-1]]


def changed_aircraft(folder: Path, weight_lbs: float) -> None:
    """The same size of file, another aircraft: a weight of as many digits."""
    file = folder / "gtm_t2.xml"
    text = (AIRCRAFT_ROOT / "gtm_t2" / "gtm_t2.xml").read_text()
    before = text[text.index("<emptywt") :].partition("</emptywt>")[0]
    tag = before.partition(">")[0] + ">"
    width = len(before) - len(tag)
    file.write_text(text.replace(before, f"{tag}{weight_lbs:.10f}"[: len(tag) + width].ljust(len(tag) + width, "0")))


@pytest.mark.slow
def test_an_aircraft_that_is_changed_on_disk_is_another_one_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(AIRCRAFT_ROOT / "gtm_t2", folder)
    monkeypatch.setenv("TESTBED_AIRCRAFT_PATH", str(tmp_path))
    a_plan = plan(**{**GTM, "aircraft": "mine"})
    original = [told(a_plan) for _ in range(3)]  # the third is put into its trim
    changed_aircraft(folder, 52.0)
    heavier = [told(a_plan) for _ in range(3)]
    shutil.copy(AIRCRAFT_ROOT / "gtm_t2" / "gtm_t2.xml", folder)
    (folder / "gtm_t2.xml").touch()
    assert len(set(original)) == len(set(heavier)) == 1
    assert heavier[0] != original[0]
    assert told(a_plan) == original[0]
    forget_everything()
    changed_aircraft(folder, 52.0)
    assert told(a_plan) == heavier[0], "as in a process that never saw another"
