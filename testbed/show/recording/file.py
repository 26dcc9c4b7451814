"""A recording as a file: complete, or not there."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import rerun as rr
import rerun.blueprint as rrb
import rerun_bindings

APPLICATION = "vosc_testbed"


@contextmanager
def written(path: Path, name: str, recording_id: str, skin: rrb.Blueprint) -> Iterator[rr.RecordingStream]:
    """A stream into a file, which is there when the block has ended; a file of that name is replaced only then."""
    rr.set_strict_mode(True)  # otherwise data of a wrong shape is dropped with a warning
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    saved = path.with_name(f"{path.name}.{os.getpid()}.rbl")
    try:
        # The viewer keeps one layout for each application, that of the recording it saw first: so every recording is its own.
        application = f"{APPLICATION}_{recording_id}"
        skin.save(application, saved)
        stream = rr.RecordingStream(application, recording_id=recording_id, send_properties=False)
        stream.set_log_time_enabled(False)
        stream.set_log_tick_enabled(False)
        stream.save(part)
        stream.log_file_from_path(saved)
        stream.send_recording_name(readable(name))
        yield stream
        stream.flush()
        stream.disconnect()
        del stream
        # A stream leaves two threads and their memory behind until this is called; a thousand flights would not fit.
        rerun_bindings.flush_and_cleanup_orphaned_recordings()
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
        saved.unlink(missing_ok=True)


def readable(text: str) -> str:
    """With a question mark for what the viewer's font has not: it may end at once over such a letter."""
    return "".join(letter if letter in KNOWN or any(low <= ord(letter) <= high for low, high in LETTERS) else "?" for letter in text)


LETTERS = ((0x20, 0x7E), (0xA0, 0x17F), (0x391, 0x3C9), (0x410, 0x44F))  # Latin, Greek, Cyrillic
KNOWN = frozenset("\n\t\N{EN DASH}\N{MINUS SIGN}\N{PRIME}\N{MULTIPLICATION SIGN}\N{COMBINING CIRCUMFLEX ACCENT}")
