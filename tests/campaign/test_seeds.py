"""Random streams: one per purpose and replicate, and blind to what is compared."""

import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from testbed.campaign import Campaign, expand
from testbed.core.seeds import stream

seeds, replicates, purposes = st.integers(0, 2**63 - 1), st.integers(0, 100_000), st.sampled_from(["wind", "traffic", "sensor"])


def draws(seed: int, replicate: int, purpose: str) -> list[float]:
    return stream(seed, replicate, purpose).normal(size=4).tolist()


def test_the_key_is_the_one_that_is_documented() -> None:
    root = np.random.SeedSequence(7, spawn_key=(3, zlib.crc32(b"wind")))
    assert draws(7, 3, "wind") == np.random.default_rng(root).normal(size=4).tolist()


@settings(max_examples=50)
@given(seeds, replicates, purposes)
def test_asking_again_gives_the_same_numbers_whatever_was_drawn_before(seed: int, replicate: int, purpose: str) -> None:
    first = draws(seed, replicate, purpose)
    stream(seed, replicate + 1, purpose).normal(size=100)
    assert draws(seed, replicate, purpose) == first


@settings(max_examples=50)
@given(seeds, replicates)
def test_another_seed_replicate_or_purpose_gives_other_numbers(seed: int, replicate: int) -> None:
    streams = [
        draws(seed, replicate, "wind"),
        draws(seed + 1, replicate, "wind"),
        draws(seed, replicate + 1, "wind"),
        draws(seed, replicate, "traffic"),
    ]
    assert len({tuple(one) for one in streams}) == 4


def test_streams_of_neighbouring_replicates_are_not_correlated() -> None:
    table = np.array([stream(1, replicate, purpose).normal(size=4000) for replicate in range(4) for purpose in ("wind", "traffic")])
    correlation = np.corrcoef(table) - np.eye(len(table))
    assert np.abs(correlation).max() < 5 / np.sqrt(4000)  # five standard deviations


def test_method_plant_and_aircraft_meet_the_same_gusts() -> None:
    route = {"start_enu_m": (0, 0, 0), "goal_enu_m": (500, 0, 0), "start_direction_deg": (0, 0), "goal_direction_deg": (0, 0)}
    sweep = {"method.kind": ["none", "scoam"], "plant.kind": ["kinematic", "jsbsim"], "aircraft": ["gtm_t2", "c172p"]}
    plans = expand(Campaign.model_validate({"name": "x", "question": "?", "seed": 5, "replicates": 2, "route": route, "sweep": sweep}))
    met = {plan.replicate: set() for plan in plans}
    for plan in plans:
        met[plan.replicate].add(tuple(draws(plan.seed, plan.replicate, "wind")))
    assert len(plans) == 16
    assert [len(gusts) for gusts in met.values()] == [1, 1]
    assert met[0] != met[1]


def test_a_negative_seed_is_refused() -> None:
    with pytest.raises(ValueError, match="negative"):
        stream(-1, 0, "wind")
