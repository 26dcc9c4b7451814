"""What a campaign of very many flights costs beside the flights: memory of the driver, the way back after a kill, the page.

    python tests/benchmarks/bench_scale.py --flights 200000 --workers 2 --out /somewhere/with/2/GB

Flies short flights of the kinematic point, kills the driver half way, goes on, and asks afterwards: was the driver's memory below 300 MB
and did it stay what it was at flight 20,000 (10 MB)? Was the first new row of the resumed run there within 15 s of its start? Was the
page written within 60 s, and below 5 MB? The exit code is 1 if not. The table of what was measured stays in OUT/scale.csv.

With --copy each worker flies a cell once and gives its row, a little changed, for every replicate. What the driver does is the same, and
takes minutes instead of an hour.
"""

import argparse
import csv
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

from testbed.run import runner
from testbed.run.engines import LocalEngine
from testbed.run.job import Job, JobResult, run_job

CAMPAIGN = """\
name: scale
question: What does a flight cost beside the flight?
seed: 1
replicates: {replicates}
speed_mps: 50
route: {{start_enu_m: [0, 0, 0], goal_enu_m: [100, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}}
obstacles: [{{name: O, radius_m: 5, position_enu_m: [50, 6, 0], speed_mps: 10, direction_deg: [90, 0], when: {{time_s: 1}}}}]
method: {{kind: none}}
plant: {{kind: kinematic}}
rates: {{plant_hz: 60, guidance_hz: 10, planner_hz: 1}}
recordings: none
sweep:
  speed_mps: [40, 50]
  obstacles.O.radius_m: [5, 10]
"""
CELLS = 4
EVERY_S = 1.0
EARLY = 20_000
MOST_MB, MOST_GROWTH_MB, MOST_RESUME_S, MOST_PAGE_S, MOST_PAGE_MB = 300.0, 10.0, 15.0, 60.0, 5.0


@dataclass
class Leg:
    """One start of the driver: what was seen of it, as (seconds, rows in the journal, resident MB)."""

    seen: list[tuple[float, int, float]] = field(default_factory=list)
    most_mb: float = 0.0
    first_row_s: float = float("nan")
    last_row_s: float = float("nan")
    ended_s: float = float("nan")
    code: int = 0


def copied(job: Job, flown: dict[str, JobResult] = {}) -> JobResult:  # noqa: B006 (a memory of the process)
    """The row of the first flight of the cell, for any of them: other digits, as many of them."""
    plan = job.plan
    if plan.cell not in flown:
        flown[plan.cell] = run_job(replace(job, want_series=True))
    one, change = flown[plan.cell], 1.0 + 1e-9 * int(plan.flight_id[:6], 16)
    row = {name: amount * change if isinstance(amount, float) else amount for name, amount in one.row.items()}
    row |= {"flight_id": plan.flight_id, "replicate": plan.replicate}
    return JobResult(row, one.series if job.want_series else None, one.timings)


def drive(file: Path, out: Path, workers: int, copy: bool) -> int:
    """What ``testbed run`` does, with the job that is asked for."""
    runner.run(runner.Order(file, LocalEngine(workers), out, job=copied if copy else run_job))
    return 0


def resident_mb(pid: int) -> tuple[float, float]:
    """Memory of a process now, and the most so far; zeros of one that ends."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0.0, 0.0
    now, most = (next((float(x.split()[1]) / 1024 for x in status.splitlines() if x.startswith(name)), 0.0) for name in ("VmRSS", "VmHWM"))
    return now, most


class Rows:
    """Counts the lines of a journal as it grows, reading only what is new."""

    def __init__(self, path: Path):
        self._path, self._at, self.count = path, 0, 0

    def look(self) -> int:
        if self._path.exists():
            with self._path.open("rb") as file:
                file.seek(self._at)
                while new := file.read(1 << 20):
                    self._at += len(new)
                    self.count += new.count(b"\n")
        return self.count


def fly(file: Path, out: Path, workers: int, copy: bool, kill_at: int | None = None) -> Leg:
    """Start the driver, watch it to its end, or kill it after so many rows."""
    leg, rows = Leg(), Rows(out / "rows.jsonl")
    already = rows.look()
    command = [sys.executable, __file__, "--drive", str(file), "--out", str(out), "--workers", str(workers), *(["--copy"] if copy else [])]
    begun = time.monotonic()
    driver = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    before = already
    while driver.poll() is None:
        now, count = time.monotonic() - begun, rows.look()
        mb, most = resident_mb(driver.pid)
        leg.seen.append((now, count, mb))
        leg.most_mb = max(leg.most_mb, most)
        if count > before:
            leg.last_row_s = now
            if before == already:
                leg.first_row_s = now
        before = count
        if kill_at is not None and count >= kill_at:
            driver.send_signal(signal.SIGKILL)
            break
        time.sleep(0.2 if count == already else EVERY_S)
    leg.code = driver.wait()
    leg.ended_s = time.monotonic() - begun
    return leg


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--flights", type=int, default=200_000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--copy", action="store_true")
    parser.add_argument("--drive", type=Path, metavar="CAMPAIGN", help="be the driver that is watched")
    given = parser.parse_args()
    if given.drive:
        return drive(given.drive, given.out, given.workers, given.copy)
    given.out.mkdir(parents=True, exist_ok=True)
    file, run = given.out / "scale.yaml", given.out / "run"
    shutil.rmtree(run, ignore_errors=True)
    file.write_text(CAMPAIGN.format(replicates=given.flights // CELLS))
    legs = [fly(file, run, given.workers, given.copy, given.flights // 2), fly(file, run, given.workers, given.copy)]
    with (given.out / "scale.csv").open("w", newline="") as table:
        writer = csv.writer(table)
        writer.writerow(["leg", "s", "rows", "driver_mb"])
        writer.writerows([number, f"{s:.1f}", rows, f"{mb:.1f}"] for number, leg in enumerate(legs, 1) for s, rows, mb in leg.seen)
    return told(legs, run, given.flights)


def told(legs: list[Leg], run: Path, flights: int) -> int:
    """Print what was measured, and hold it against what is asked."""
    killed, ended = legs
    early = max((mb for _, rows, mb in killed.seen if 0 < rows <= min(EARLY, flights // 10)), default=float("nan"))
    flying = max(mb for leg in legs for s, rows, mb in leg.seen if rows and not s > leg.last_row_s)
    most = max(leg.most_mb for leg in legs)
    page_s, page_mb = ended.ended_s - ended.last_row_s, (run / "index.html").stat().st_size / 1e6
    lines = [
        ("driver's memory at its most, MB", most, MOST_MB),
        (f"growth from flight {min(EARLY, flights // 10):,} on while flying, MB", flying - early, MOST_GROWTH_MB),
        ("resumed half way: first new row after, s", ended.first_row_s, MOST_RESUME_S),
        ("tables and page after the last row, s", page_s, MOST_PAGE_S),
        ("page, MB", page_mb, MOST_PAGE_MB),
    ]
    print(f"{flights:,} flights; first row after {killed.first_row_s:.1f} s; {killed.ended_s + ended.ended_s:.0f} s in all")
    print("bytes a flight: " + ", ".join(f"{f.name} {f.stat().st_size / flights:.0f}" for f in sorted(run.iterdir()) if f.is_file()))
    for what, found, most_allowed in lines:
        print(f"{what:60s} {found:8.1f}   at most {most_allowed:g}{'' if found <= most_allowed else '   MISSED'}")
    return int(ended.code != 0 or not all(found <= allowed for _, found, allowed in lines))


if __name__ == "__main__":
    sys.exit(main())
