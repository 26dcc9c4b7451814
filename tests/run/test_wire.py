import pickle
import socket

import pytest

from testbed.run.wire import NoMessageError, Wire
from testbed.run.worker import LENGTH, MOST_BYTES, receive


@pytest.fixture
def line():
    ours, theirs = socket.socketpair()
    yield Wire(ours), theirs
    ours.close()
    theirs.close()


def framed(message):
    return LENGTH.pack(len(message)) + message


def test_a_message_is_there_when_it_is_whole(line):
    wire, worker = line
    data = framed(b"one") + framed(b"") + framed(b"three")
    taken = []
    for byte in data:
        worker.send(bytes([byte]))
        taken += wire.receive()
    assert taken == [b"one", b"", b"three"]
    assert wire.receive() == []


def test_the_end_and_rubbish_come_after_what_was_whole(line):
    wire, worker = line
    worker.send(framed(b"last") + LENGTH.pack(MOST_BYTES + 1) + b"rubbish")
    assert wire.receive() == [b"last"]
    with pytest.raises(NoMessageError):
        wire.receive()


def test_the_end_of_the_line_is_told_after_the_last_message_and_a_torn_one_is_none(line):
    wire, worker = line
    worker.send(framed(b"last") + framed(b"torn")[:-1])
    worker.close()
    assert wire.receive() == [b"last"]
    with pytest.raises(EOFError):
        wire.receive()


def test_a_worker_that_does_not_read_keeps_nobody_waiting(line):
    wire, worker = line
    large = pickle.dumps(bytes(4 * 2**20))
    wire.send(large)
    wire.send(b"after it")
    assert wire.is_waiting
    worker.setblocking(True)
    got = b""
    while len(got) < len(large) + len(b"after it") + 2 * LENGTH.size:
        got += worker.recv(2**16)
        wire.flush()
    assert not wire.is_waiting
    assert got == framed(large) + framed(b"after it")


def test_a_worker_that_is_gone_takes_what_is_sent_in_silence(line):
    wire, worker = line
    worker.close()
    wire.send(bytes(2**20))
    assert not wire.is_waiting
    with pytest.raises(EOFError):
        wire.receive()


def test_the_workers_end_waits_for_whole_messages(line):
    wire, worker = line
    wire.send(b"a call")
    assert receive(worker) == b"a call"
