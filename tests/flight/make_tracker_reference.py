"""Writes tracker_reference.json: what another program makes of the same measurements. Needs the package filterpy (2.0.0), which nothing
else here does: `python tests/flight/make_tracker_reference.py`.
"""

import json
from pathlib import Path

import numpy as np
from filterpy.kalman import IMMEstimator, KalmanFilter

STEP_S, STAYS, NOISE = 0.2, 0.96, np.diag([9.0, 9.0, 9.0, 1.0, 1.0, 1.0])


def model(acceleration_mps2: float, first: np.ndarray) -> KalmanFilter:
    made = KalmanFilter(6, 6)
    made.x, made.P, made.H, made.R = first.copy(), NOISE.copy(), np.eye(6), NOISE
    made.F = np.eye(6)
    made.F[:3, 3:] = STEP_S * np.eye(3)
    made.Q = acceleration_mps2**2 * np.kron([[STEP_S**4 / 4, STEP_S**3 / 2], [STEP_S**3 / 2, STEP_S**2]], np.eye(3))
    return made


random = np.random.default_rng(7)
time_s = STEP_S * np.arange(30)
turn = np.where(time_s > 3.0, time_s - 3.0, 0.0)  # straight on, then 8 m/s^2 to the north
true = np.column_stack([300 - 40 * time_s, 4.0 * turn**2, 0 * time_s, np.full(30, -40.0), 8.0 * turn, 0 * time_s])
measured = true + random.normal(size=(30, 6)) * np.sqrt(np.diag(NOISE))
one, models = model(2.0, measured[0]), [model(0.5, measured[0]), model(10.0, measured[0])]
both = IMMEstimator(models, np.array([0.5, 0.5]), np.array([[STAYS, 1 - STAYS], [1 - STAYS, STAYS]]))
told = []
for z in measured[1:]:
    one.predict()
    one.update(z)
    both.predict()
    both.update(z)
    told.append(both.mu.tolist())
found = {
    "made_by": "make_tracker_reference.py",
    "with": "filterpy 2.0.0",
    "step_s": STEP_S,
    "stays": STAYS,
    "measured": measured.tolist(),
    "kalman": {"values": one.x.tolist(), "covariance": one.P.tolist()},
    "imm": {"values": both.x.tolist(), "covariance": both.P.tolist(), "shares": told},
}
Path(__file__).with_name("tracker_reference.json").write_text(json.dumps(found, indent=1) + "\n")
