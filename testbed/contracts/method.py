"""The contract of a method that answers with a direction: ``avoid(own, obstacles, **options) -> Choice`` (``vosc.methods``).

It is tried on seeded encounters, two thirds of whose obstacles are aimed at the aircraft, and on the odd ones that a campaign meets
sooner or later. Whether its answers are safe is no promise: how often one leads into a cone is told as a note.
"""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from time import perf_counter
from typing import Any

import numpy as np

from testbed.campaign.words.planning import completed
from testbed.contracts.promise import Promise, first_broken
from testbed.core.frames import vec3
from testbed.core.seeds import stream
from testbed.core.utf8 import reason
from vosc import Obstacle, Own
from vosc.methods import CHOICES, Choice, avoid, checked_choice

Scene = tuple[Own, tuple[Obstacle, ...]]
SCENES = 200
SPEED_MPS = 50.0


def promises(_kind: str, method: Callable[..., Choice], options: Mapping[str, Any]) -> list[Promise]:
    """Everything that a direction method promises, tried in turn."""
    options = completed(options, goal=lambda: (1.0, 0.0, 0.0))
    scenes = [(f"encounter {number}", drawn(number)) for number in range(SCENES)]
    every = [*scenes, *odd_scenes()]

    def ask(scene: Scene) -> Choice:
        return method(*copied(*scene), **options)

    def given(scene: Scene) -> Choice:
        return method(scene[0], scene[1], **options)

    return [
        first_broken("answers with a Choice: three finite numbers, m/s, and one of " + ", ".join(CHOICES), _cases(every, _shape, ask)),
        first_broken("gives the same answer to the same question", _cases(every, _same, ask)),
        first_broken("leaves what it is given alone", _cases(every, _alone, given)),
        first_broken("keeps the speed, or says that there is no answer", _cases(scenes, _speed, ask)),
        _safety(method, options, scenes),
    ]


def _cases(
    scenes: Sequence[tuple[str, Scene]], judge: Callable[[Callable[[Scene], Choice], Scene], str], ask: Callable[[Scene], Choice]
) -> list[tuple[str, Callable[[], str]]]:
    return [(name, lambda scene=scene: judge(ask, scene)) for name, scene in scenes]  # type: ignore[misc]


def _shape(ask: Callable[[Scene], Choice], scene: Scene) -> str:
    try:
        checked_choice(ask(scene))
    except ValueError as error:
        return str(error)
    return ""


def _same(ask: Callable[[Scene], Choice], scene: Scene) -> str:
    first, second = ask(scene), ask(scene)
    return "" if _plain(first) == _plain(second) else f"first {_plain(first)}, then {_plain(second)}"


def _plain(answer: Choice) -> tuple[float, ...]:
    return tuple(float(x) for x in answer.velocity_mps)


def _alone(given: Callable[[Scene], Choice], scene: Scene) -> str:
    """A copy is given away, and compared: the statistic is of the encounter as it was."""
    handed = copied(*scene)
    given(handed)
    return "" if handed == scene else "own or obstacles are others after the call"


def _speed(ask: Callable[[Scene], Choice], scene: Scene) -> str:
    answer = ask(scene)
    speed, wanted = math.hypot(*_plain(answer)), math.hypot(*scene[0].vel_mps)
    if answer.status != "avoided" or abs(speed - wanted) <= 1e-6 * wanted:
        return ""
    return f"commands {speed:.2f} m/s where the aircraft flies {wanted:.2f} m/s (an option that changes the speed may do so)"


def _safety(method: Callable[..., Choice], options: Mapping[str, Any], scenes: Sequence[tuple[str, Scene]]) -> Promise:
    """How its answers fare against the exact cones, and what one costs: facts, not promises."""

    def apart(own: Own, obstacles: Sequence[Obstacle]) -> Choice:
        return method(*copied(own, obstacles), **options)

    began = perf_counter()
    try:
        found = Counter(str(avoid(apart, own, obstacles).status) for _, (own, obstacles) in scenes)
    except KeyboardInterrupt:
        raise
    except BaseException as bug:
        return Promise("can be asked through vosc.methods.avoid", f"raises {reason(bug)}")
    cost = (perf_counter() - began) / len(scenes)
    told = (
        ", ".join(f"{count} {status}" for status, count in found.most_common()) + f"; {1e6 * cost:.0f} microseconds each on this computer"
    )
    return Promise("can be asked through vosc.methods.avoid", note=f"of {len(scenes)} encounters: {told}")


def copied(own: Own, obstacles: Sequence[Obstacle]) -> Scene:
    """The encounter for one that may change what it is given: what comes after must meet it as it was. Their fields are tuples."""
    return copy(own), tuple(map(copy, obstacles))


def drawn(number: int) -> Scene:
    """One to four obstacles about an aircraft at 50 m/s, two thirds aimed to pass near it in 1 to 4 s; all begin outside."""
    rng = stream(0, number, "contract")
    own = Own(vec3(rng.normal(size=3) * 100.0), vec3(_arrow(rng, SPEED_MPS)))
    obstacles: list[Obstacle] = []
    while len(obstacles) < 1 + number % 4:
        velocity = _arrow(rng, rng.uniform(0.0, 80.0))
        aimed = (np.array(own.vel_mps) - velocity) * rng.uniform(1.0, 4.0) + 15.0 * rng.normal(size=3)
        offset = aimed if rng.random() < 2.0 / 3.0 else _arrow(rng, rng.uniform(40.0, 150.0))
        radius = rng.uniform(5.0, 35.0)
        if np.linalg.norm(offset) > 1.02 * radius:
            obstacles.append(Obstacle(vec3(np.array(own.pos_m) + offset), vec3(velocity), radius))
    return own, tuple(obstacles)


def _arrow(rng: np.random.Generator, size: float) -> np.ndarray:
    """A vector (3,) of that length in any direction."""
    vector = rng.normal(size=3)
    return np.asarray(size * vector / np.linalg.norm(vector))


def odd_scenes() -> list[tuple[str, Scene]]:
    """Encounters in which constructions degenerate."""
    ahead, still = Own((0, 0, 0), (50, 0, 0)), (0.0, 0.0, 0.0)
    around = ((40, 0, 0), (0, 40, 0), (0, -40, 0), (0, 0, 40), (0, 0, -40))
    return [
        ("a standing obstacle straight ahead", (ahead, (Obstacle((100, 0, 0), still, 25),))),
        ("head-on", (ahead, (Obstacle((200, 0, 0), (-50, 0, 0), 25),))),
        ("overtaken from behind", (ahead, (Obstacle((-100, 0, 0), (80, 0, 0), 25),))),
        ("the same velocity", (ahead, (Obstacle((100, 0, 0), (50, 0, 0), 25),))),
        ("straight up", (Own((0, 0, 0), (0, 0, 50)), (Obstacle((0, 5, 100), still, 25),))),
        ("standing still", (Own((0, 0, 0), still), (Obstacle((100, 0, 0), (-40, 0, 0), 25),))),
        ("on the surface", (ahead, (Obstacle((25, 0, 0), still, 25),))),
        ("the same obstacle twice", (ahead, (Obstacle((100, 3, 0), still, 25),) * 2)),
        ("walled in", (ahead, tuple(Obstacle(place, still, 39.9) for place in around))),
        ("thirty obstacles", (ahead, tuple(Obstacle((120, 8 * k - 120, 3 * k - 45), (-10, 0, 0), 5) for k in range(30)))),
    ]
