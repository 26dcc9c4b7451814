"""The one source of randomness: a stream per purpose, the same for every method, plant and aircraft.

What is compared must meet the same gusts and the same traffic, so nothing that is compared is in the key.
"""

import zlib

import numpy as np


def stream(campaign_seed: int, replicate: int, purpose: str) -> np.random.Generator:
    """Random numbers of one purpose (``"wind"``, ``"traffic"``, ``"sensor"``) in one replicate of a campaign."""
    key = (replicate, zlib.crc32(purpose.encode()))  # hash() is salted per process
    return np.random.default_rng(np.random.SeedSequence(campaign_seed, spawn_key=key))
