"""What two workers make of two cores, and what Dask costs: ``python tests/benchmarks/bench_engines.py [--rounds N]``, not a test.

The encounter of campaigns/smoke.yaml, many times, goes through an engine and into a journal, as in a run. Each round measures one
worker, two workers, and two Dask workers in processes of their own with a scheduler (all on loopback), one after the other; the ratios
are of a round, and their medians are told. A rate counts from the first tenth of the answers to the last one, so that starting the
workers is left out.

Efficiency: rate of two workers over twice the rate of one. On two cores the driver has no core of its own, so what it does for a flight
is lost to one of the workers: that is told too, in processor seconds of the driver, which another load of the machine changes little.
"""

import argparse
import contextlib
import os
import statistics
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from testbed import expand, load_campaign
from testbed.run import journal
from testbed.run.dask_engine import DaskEngine
from testbed.run.engines import Died, Engine, LocalEngine
from testbed.run.job import Job, run_job
from tests.kills.cluster import ROOT, Cluster

FLIGHTS = {"jsbsim": 300, "kinematic": 1500}


@dataclass(frozen=True)
class Rate:
    """Flights a second, and processor seconds of the driver for each."""

    per_s: float
    driver_s: float


def jobs(plant: str, count: int) -> Iterator[Job]:
    """The same flight so many times: what a worker remembers of one makes the next quicker, and the engines' share larger."""
    overrides = [f"sweep={{plant.kind: [{plant}], method.kind: [scoam]}}", "recordings=none", f"replicates={count}"]
    campaign = load_campaign(ROOT / "campaigns" / "smoke.yaml", overrides)
    return (Job(plan) for plan in expand(campaign))


def rate(engine: Engine, plant: str, count: int, folder: Path) -> Rate:
    """Fly them, and write the journal."""
    warm = max(1, count // 10)
    with journal.appending(folder / f"{time.monotonic_ns()}.jsonl") as rows:
        start, busy = 0.0, 0.0
        for done, (_, result) in enumerate(engine.imap(run_job, jobs(plant, count)), 1):
            if isinstance(result, Died):
                raise SystemExit(f"a flight died: {result.reason}")
            rows.append(result)
            if done == warm:
                start, busy = time.perf_counter(), time.process_time()
            if done == count:
                took, worked = time.perf_counter() - start, time.process_time() - busy
    return Rate((count - warm) / took, worked / (count - warm))


@contextlib.contextmanager
def cluster(folder: Path) -> Iterator[str]:
    """A scheduler and two workers, which are idle while others are measured."""
    started = Cluster(folder)
    started.start()
    try:
        yield started.file
    finally:
        started.kill()


def main() -> None:
    """Print a table a plant."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--scale", type=float, default=1.0, help="of the number of flights")
    asked = parser.parse_args()
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {asked.rounds} rounds")
    with tempfile.TemporaryDirectory() as name, cluster(Path(name)) as scheduler:
        for plant, flights in FLIGHTS.items():
            count = int(flights * asked.scale)
            engines = {"1 worker": LocalEngine(1), "2 workers": LocalEngine(2), "2 Dask workers": DaskEngine(2, scheduler)}
            rounds = [{what: rate(engine, plant, count, Path(name)) for what, engine in engines.items()} for _ in range(asked.rounds)]
            print(f"\n{plant}, {count} flights: median of {asked.rounds}")
            for what in engines:
                rates = [one[what] for one in rounds]
                per_s, driver_s = (statistics.median(r.per_s for r in rates), statistics.median(r.driver_s for r in rates))
                print(f"  {what:15} {per_s:8.1f} flights/s   driver {1e3 * driver_s:6.2f} ms of processor a flight")
            efficiency = [one["2 workers"].per_s / (2 * one["1 worker"].per_s) for one in rounds]
            dask = [one["2 workers"].per_s / one["2 Dask workers"].per_s for one in rounds]
            print(f"  efficiency of 2 workers   {statistics.median(efficiency):.3f}   {[round(x, 3) for x in sorted(efficiency)]}")
            print(f"  time on Dask over local   {statistics.median(dask):.3f}   {[round(x, 3) for x in sorted(dask)]}")


if __name__ == "__main__":
    main()
