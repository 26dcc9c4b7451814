"""From a lift demand to bank and load factor, within the limits of an aircraft that banks to turn."""

import math

from testbed.core.units import DEG, G0_MPS2
from testbed.flight.guidance.law import BANK_LIMITED, LIFT_LIMITED
from testbed.flight.plants.aircraft import Limits

LEAST_LIFT_MPS2 = 2.0  # below this the bank command would be singular (push-over through zero g)
UNLOAD = 8.0  # load factor given up per share of speed lost near the least speed


class BankToTurn:
    """From a lift demand to bank and load factor, within an aircraft's limits."""

    def __init__(self, limits: Limits) -> None:
        self._bank = limits.bank_deg * DEG
        self._n_min, self._n_max = limits.load_factor_min, limits.load_factor_max
        self._n_per_speed2 = 1.0 / limits.alpha_max_1g_mps**2
        self._per_slowest = UNLOAD / limits.speed_min_mps

    def solve(self, left: float, soon: float, up: float, bank_now: float, airspeed: float) -> tuple[float, float, float]:
        """Bank (rad), load factor, and which limits cut them; demands in m/s^2, gravity made up for in ``up``.

        ``left`` is what the bank will have to serve when it answers; ``soon``, to the left too, what the load factor will.
        """
        most = self._bank
        raw_bank = math.atan2(-left, up if up > LEAST_LIFT_MPS2 else LEAST_LIFT_MPS2)
        bank = -most if raw_bank < -most else most if raw_bank > most else raw_bank
        # the lift that serves the demand at the bank the aircraft has, not at the one it was told
        raw_n = (up * math.cos(bank_now) - soon * math.sin(bank_now)) / G0_MPS2
        n_max = self.most_load_factor(airspeed)
        load_factor = self._n_min if raw_n < self._n_min else n_max if raw_n > n_max else raw_n
        return bank, load_factor, (BANK_LIMITED if bank != raw_bank else 0.0) + (LIFT_LIMITED if load_factor != raw_n else 0.0)

    def most_load_factor(self, airspeed: float) -> float:
        """What may be asked for at an airspeed (m/s): the structural limit, or less where there is less lift."""
        available = self._n_per_speed2 * airspeed * airspeed
        n_max = available if available < self._n_max else self._n_max
        # speed before height: what flies as slowly as it may does not climb, and slower than that it unloads
        unloaded = 1.0 - UNLOAD + self._per_slowest * airspeed
        return unloaded if unloaded < n_max else n_max
