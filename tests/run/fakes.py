"""Calls that spawned workers can import at once, because this file imports nothing heavy: well-behaved ones, and some that misbehave."""

import hashlib
import json
import math
import os
import signal
import threading
import time


def square(x):
    return x * x


def slow_square(x):
    time.sleep(0.05)
    return x * x


def pid(_):
    return os.getpid()


def threads(_):
    import numpy  # noqa: F401

    return os.environ["OPENBLAS_NUM_THREADS"], os.environ["OMP_NUM_THREADS"]


def chatter(x):
    os.write(1, b"noise from below\n")
    return x


def raises_on_3(x):
    if x == 3:
        raise ValueError("three is too much")
    return x


def unpicklable_on_3(x):
    return (lambda: x) if x == 3 else x


def dies_on_3(x):
    if x == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return x


def exits_on_3(x):
    if x == 3:
        os._exit(7)
    return x


def dies_once(marker_and_x):
    marker, x = marker_and_x
    if x == 3 and not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGSEGV)
    return x


def sleeps(marker_folder_and_x):
    folder, _ = marker_folder_and_x
    (folder / str(os.getpid())).touch()
    time.sleep(90)


def metrics_row(flight_id):
    """A row such as job.py makes, with numbers that depend on the flight."""
    from testbed.results.columns import METRICS, Kind

    n = float(int(hashlib.sha256(flight_id.encode()).hexdigest()[:6], 16))
    numbers = {c.name: {Kind.TEXT: "", Kind.WHOLE: 1, Kind.NUMBER: math.sqrt(n), Kind.FLAG: None}[c.kind] for c in METRICS} | {
        "outcome": "reached",
        "deflection_deg": math.nan,
    }
    who = {
        "flight_id": flight_id,
        "cell": "c",
        "labels": {},
        "replicate": 0,
        "seed": 1,
        "plant": "kinematic",
        "aircraft": "gtm_t2",
        "method": "none",
    }
    return who | numbers | {"events": [], "message": "", "traceback": "", "recording": None}


def fly(job):
    """A job that costs nothing and leaves a mark for each flight, if FLOWN names a file."""
    from testbed.run.job import JobResult

    if "FLOWN" in os.environ:
        with open(os.environ["FLOWN"], "a") as marks:
            marks.write(job.plan.flight_id + "\n")
    if job.recording_path:
        job.recording_path.parent.mkdir(exist_ok=True)
        job.recording_path.write_text("a recording")
    if job.columns_path:
        job.columns_path.parent.mkdir(exist_ok=True)
        job.columns_path.write_text("raw columns")
    row = metrics_row(job.plan.flight_id) | {
        "cell": job.plan.cell,
        "labels": job.plan.labels,
        "replicate": job.plan.replicate,
        "seed": job.plan.seed,
        "recording": f"recordings/{job.plan.flight_id}.rrd" if job.recording_path else None,
    }
    return JobResult(row, {"z_m": [0.0, math.pi]} if job.want_series else None, {"fly": time.perf_counter()})


def fly_slowly(job):
    time.sleep(0.1)
    return fly(job)


def fly_badly(job):
    """The third replicate kills its worker, the fourth has a bug."""
    if job.plan.replicate == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    if job.plan.replicate == 3:
        raise ZeroDivisionError("a bug")
    return fly(job)


def fly_wrongly(job):
    """The third and the fourth replicate have bugs, which cost no process."""
    if job.plan.replicate >= 2:
        raise ZeroDivisionError("a bug")
    return fly(job)


def page(campaign, rows, series, provenance, checks, head, files, risk=None):
    """A page that shows all it is given."""
    told = [campaign.name, list(rows), series, provenance, [str(line) for line in checks], head, files, repr(risk)]
    return json.dumps(told, sort_keys=True)


def ignores_ctrl_c(_item):
    return signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def deaf_to_ctrl_c(_):
    return signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, [])


def leaves_threads(count):
    """As a recording does: they stay, with what they hold."""
    for _ in range(count):
        threading.Thread(target=time.sleep, args=(600,), daemon=True).start()
    return os.getpid()
