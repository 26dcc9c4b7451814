"""Whole messages between a driver and a worker, on the driver's side: nothing here ever waits.

A worker can stop in the middle of a message, and one that is busy does not read. So what does not go out at once is kept, and what has
not come in whole is not there yet.
"""

import socket

from testbed.run.worker import LENGTH, MOST_BYTES

_AT_A_TIME = 2**20


class NoMessageError(Exception):
    """What came in is no message of a worker."""


class Wire:
    """The driver's end of the line to one worker."""

    def __init__(self, line: socket.socket):
        line.setblocking(False)
        self.line = line
        self._out = bytearray()
        self._in = bytearray()

    @property
    def is_waiting(self) -> bool:
        """Whether something has still to go out."""
        return bool(self._out)

    def send(self, message: bytes) -> None:
        self._out += LENGTH.pack(len(message)) + message
        self.flush()

    def flush(self) -> None:
        """Send what can be sent now. A worker that is gone shows itself when it is next heard."""
        try:
            while self._out:
                del self._out[: self.line.send(bytes(self._out[:_AT_A_TIME]))]
        except BlockingIOError:
            pass
        except OSError:
            self._out.clear()

    def receive(self) -> list[bytes]:
        """The messages that are there whole. Once they are taken, raises ``NoMessageError`` for rubbish, ``EOFError`` at the end."""
        ended = self._fill()
        messages = []
        while (message := self._first()) is not None:
            messages.append(message)
        if not messages and self._is_rubbish():
            raise NoMessageError
        if not messages and ended:
            raise EOFError
        return messages

    def _fill(self) -> bool:
        """Take in what has come; True at the end of the line. Not more than a largest message at once: others speak too."""
        most = len(self._in) + MOST_BYTES
        while len(self._in) < most:
            try:
                part = self.line.recv(_AT_A_TIME)
            except BlockingIOError:
                return False
            except OSError:
                return True
            if not part:
                return True
            self._in += part
        return False

    def _first(self) -> bytes | None:
        if len(self._in) < LENGTH.size or self._is_rubbish():
            return None
        end = LENGTH.size + self._length()
        if len(self._in) < end:
            return None
        message = bytes(self._in[LENGTH.size : end])
        del self._in[:end]
        return message

    def _is_rubbish(self) -> bool:
        return len(self._in) >= LENGTH.size and self._length() > MOST_BYTES

    def _length(self) -> int:
        (length,) = LENGTH.unpack_from(self._in)
        return int(length)

    def close(self) -> None:
        self.line.close()
