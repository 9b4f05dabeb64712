"""Recordings: captured messages in a file, each with the time at which it came.

    recording = message*
    message   = time in seconds (float64), length (u32), that many bytes

All little-endian; `.rec` as it is, `.rec.xz` compressed. Any other file is one message.
"""

from __future__ import annotations

import lzma
import struct
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, BinaryIO, cast

from rosetta_jit.catalogue import recording as words
from rosetta_jit.errors import ReportError
from rosetta_jit.file_errors import named
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from pathlib import Path

MAX_MESSAGE_BYTES = 256 * 1024 * 1024
"""A compressed recording of a few KB may promise, and hold, a message of 4 GiB."""

AT_ONCE = 1 << 20
"""Bytes of a message for which memory is taken before they are read."""

_HEAD = struct.Struct("<dI")


class RecordingError(ReportError):
    """A recording that cannot be read to its end."""


@dataclass(frozen=True, slots=True)
class Message:
    """The bytes of one message and when they came, in seconds."""

    time_s: float
    data: bytes


def is_recording(path: Path) -> bool:
    """Whether a file of that name holds several messages."""
    return path.name.endswith((".rec", ".rec.xz"))


def read_messages(path: Path) -> Iterator[Message]:
    """The messages of a recording, or the one message of any other file.

    Raises
    ------
    RecordingError
        The file cannot be read; or, after the last whole message, the recording is cut short or damaged.
    """
    if not is_recording(path):
        yield Message(0.0, read_file(path))
        return
    try:
        if path.exists() and not path.is_file():  # a device has no end, and this one is read to its end
            raise RecordingError((words.no_recording(str(path)),))
        with _open(path, "rb") as file:
            yield from _messages(file, str(path))
    except OSError as error:
        raise _unreadable(path, error) from error
    except (EOFError, lzma.LZMAError) as error:
        raise RecordingError((words.damaged(str(path), str(error)),)) from error


def read_file(path: Path) -> bytes:
    """All of a file, or of a pipe.

    Raises
    ------
    RecordingError
        It cannot be read, or has more than `MAX_MESSAGE_BYTES`: a device may have no end.
    """
    try:
        with path.open("rb") as file:
            data = file.read(MAX_MESSAGE_BYTES + 1)
    except (OSError, ValueError) as error:
        raise _unreadable(path, error) from error
    if len(data) > MAX_MESSAGE_BYTES:
        raise RecordingError((words.too_large(str(path), MAX_MESSAGE_BYTES),))
    return data


def write_recording(path: Path, messages: Iterable[Message]) -> None:
    """Write messages to `.rec` or `.rec.xz`."""
    with named(path), _open(path, "wb") as file:
        for message in messages:
            file.write(_HEAD.pack(message.time_s, len(message.data)) + message.data)


def _unreadable(path: Path, error: Exception) -> RecordingError:
    why = (error.strerror if isinstance(error, OSError) else None) or "its name cannot be that of a file"
    return RecordingError((words.unreadable(str(path), why),))


def _open(path: Path, mode: str) -> BinaryIO:
    return cast("BinaryIO", lzma.open(path, mode) if path.suffix == ".xz" else path.open(mode))


def _read(file: BinaryIO, size: int) -> bytes:
    """So many bytes, or those that there are: a file takes memory for what is asked for, not for what it has."""
    data = file.read(min(size, AT_ONCE))
    if len(data) in (size, 0):
        return data
    pieces, left = [data], size - len(data)
    while left and (piece := file.read(min(left, AT_ONCE))):
        pieces.append(piece)
        left -= len(piece)
    return b"".join(pieces)


def _messages(file: BinaryIO, name: str) -> Iterator[Message]:
    index = 0
    while head := file.read(_HEAD.size):
        if len(head) < _HEAD.size:
            raise RecordingError((words.cut(name, index),))
        time_s, size = cast("tuple[float, int]", _HEAD.unpack(head))
        if size > MAX_MESSAGE_BYTES:
            raise RecordingError((words.too_long(name, index, size, MAX_MESSAGE_BYTES),))
        data = _read(file, size)
        if len(data) < size:
            raise RecordingError((words.cut(name, index),))
        yield Message(time_s, data)
        index += 1
