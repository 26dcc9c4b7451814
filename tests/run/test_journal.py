import json
import math

import numpy as np
import pytest

from testbed.flight.record import ReplanEvent
from testbed.run import journal
from testbed.run.job import JobResult
from tests.run.fakes import metrics_row


def event(**changes):
    values = {
        name: (1.0, 2.0, 3.0) if "Vec3" in str(f.type) or "tuple" in str(f.type) else "none" if issubclass(f.type, str) else f.type()
        for name, f in ReplanEvent.__dataclass_fields__.items()
    }
    return values | changes


def result(n=0, **changes):
    return JobResult(metrics_row(f"f{n}") | changes, {"t": [0.0, 0.1]}, {"fly": 0.5})


def write(path, *results):
    with journal.appending(path) as rows:
        for item in results:
            rows.append(item)


def test_what_is_not_finite_comes_back_and_the_file_is_strict_json():
    odd = result(least_clearance_m=math.nan, max_load_factor=math.inf, min_load_factor=-math.inf)
    odd.row["events"] = [event(margin_rad=math.nan, insertion_enu_m=(math.nan, 0.0, math.inf))]
    line = journal.encode(odd)
    json.loads(line, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    row = journal.decode(line).row
    assert math.isnan(row["least_clearance_m"])
    assert (row["max_load_factor"], row["min_load_factor"]) == (math.inf, -math.inf)
    (back,) = row["events"]
    assert math.isnan(back["margin_rad"])
    assert math.isnan(back["insertion_enu_m"][0])
    assert back["insertion_enu_m"][1:] == [0.0, math.inf]
    assert back["own_pos_enu_m"] == [1.0, 2.0, 3.0]


def test_numpy_values_are_written_as_plain_ones():
    row = journal.decode(journal.encode(result(replans=np.int64(2), path_length_m=np.float64(0.1), least_clearance_m=np.float32(0.5)))).row
    assert (row["replans"], row["path_length_m"], row["least_clearance_m"]) == (2, 0.1, 0.5)


def test_rows_are_appended(tmp_path):
    path = tmp_path / "rows.jsonl"
    assert list(journal.read(path)) == []
    write(path, result(0))
    write(path, result(1), result(2))
    assert [r.row["flight_id"] for r in journal.read(path)] == ["f0", "f1", "f2"]


@pytest.mark.parametrize("torn", [b'{"row": {"fli', b'{"row":{}}\n', b"\x00\x00\x00\x00", b"{}\n", b"[1]\n"])
def test_a_torn_last_line_is_left_out_and_cut_off_before_more_is_written(tmp_path, torn):
    path = tmp_path / "rows.jsonl"
    write(path, result(0), result(1))
    whole = path.read_bytes()
    path.write_bytes(whole + torn)
    assert [r.row["flight_id"] for r in journal.read(path)] == ["f0", "f1"]
    assert path.read_bytes() == whole + torn, "reading changes nothing"
    write(path, result(2))
    assert path.read_bytes() == whole + journal.encode(result(2))


def test_every_place_to_tear_the_last_line_leaves_the_rows_before(tmp_path):
    path = tmp_path / "rows.jsonl"
    first, last = journal.encode(result(0)), journal.encode(result(1))
    for length in range(len(last)):
        path.write_bytes(first + last[:length])
        assert [r.row["flight_id"] for r in journal.read(path)] == ["f0"]


def test_damage_before_the_last_line_is_refused_with_its_place_and_nothing_is_lost(tmp_path):
    path = tmp_path / "rows.jsonl"
    damaged = journal.encode(result(0)) + b"not a row\n" + journal.encode(result(2))
    path.write_bytes(damaged)
    with pytest.raises(journal.JournalError, match=r"rows\.jsonl:2: not a row"):
        list(journal.read(path))
    with pytest.raises(journal.JournalError), journal.appending(path):
        pytest.fail("opened a damaged journal")
    assert path.read_bytes() == damaged


def test_a_row_from_before_an_event_said_so_much_is_read() -> None:
    line = journal.encode(result(events=[event()]))
    older = json.loads(line)
    for name in ("path_clearance_m", "path_turns_rad", "reason"):
        del older["row"]["events"][0][name]
    (read,) = journal.decode(json.dumps(older, separators=(",", ":")).encode()).row["events"]
    assert math.isnan(read["path_clearance_m"])
    assert read["reason"] == ""
