import pytest

from testbed.run.progress import PlainLines


@pytest.mark.parametrize(
    ("total", "seconds_each", "expected"),
    [
        (1000, 0.001, [0, 1000]),  # over at once: the first and the last line
        (100, 0.3, [0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 75, 80, 85, 90, 95, 100]),  # every 5 %
        (1000, 1.0, [0, *range(10, 1001, 10)]),  # every 10 s
        (3, 60.0, [0, 1, 2, 3]),
    ],
)
def test_lines_come_seldom_but_the_last_always(capsys, total, seconds_each, expected):
    now = [0.0]
    show = PlainLines(clock=lambda: now[0])
    for done in range(total + 1):
        show(done, total, 0)
        now[0] += seconds_each
    out, err = capsys.readouterr()
    assert out == ""
    assert [int(line.split()[0]) for line in err.splitlines()] == expected


def test_crashes_are_told(capsys):
    PlainLines()(4, 4, 2)
    PlainLines()(0, 1, 0)
    assert capsys.readouterr().err == "4 of 4 flights, 2 crashed\n0 of 1 flight\n"
