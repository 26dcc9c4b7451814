import pytest

from testbed.run.progress import PlainLines


@pytest.mark.parametrize(
    ("total", "seconds_each", "expected"),
    [
        (1000, 0.001, [0]),  # over at once: it has begun; how it ended is told with the answer
        (100, 1.0, [0, 30, 60, 90]),  # every half minute
        (3, 60.0, [0, 1, 2]),
    ],
)
def test_a_line_comes_at_once_and_every_half_minute(capsys, total, seconds_each, expected):
    now = [0.0]
    show = PlainLines(clock=lambda: now[0])
    for done in range(total + 1):
        show(done, total, {})
        now[0] += seconds_each
    out, err = capsys.readouterr()
    assert out == ""
    assert [int(line.split()[0]) for line in err.splitlines()] == expected


def test_a_line_says_how_flights_ended_and_what_time_is_left(capsys):
    now = [0.0]
    show = PlainLines(clock=lambda: now[0])
    show(100, 1000, {"reached": 90, "collided": 10})  # it goes on where it stopped: these took no time
    now[0] = 60.0
    show(200, 1000, {"reached": 150, "collided": 49, "crashed": 1})  # 100 in a minute, 800 left
    show.writing()
    assert capsys.readouterr().err.splitlines() == [
        "100 of 1000 flights: 90 reached the goal, 10 collided",
        "200 of 1000 flights: 150 reached the goal, 49 collided, 1 failed to run; about 8.0 min left",
        "writing the page...",
    ]
