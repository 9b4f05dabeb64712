"""Where a message ends in a stream of bytes: its length before it, in one of several forms, or a newline behind it."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.feeding import Between, Frames, ProtocolError, Until, too_large

if TYPE_CHECKING:
    from rosetta_jit.transports.feeding import Machine

    Bytes = bytes | bytearray | memoryview

LENGTHS = {
    name: struct.Struct(code) for name, code in {"u32": "<I", "u32be": ">I", "u16": "<H", "u16be": ">H", "u64": "<Q", "u64be": ">Q"}.items()
}

CR = 13
VARINT_BYTES = 10


def messages(frame: str, take: Callable[[memoryview], object], most: int) -> Machine:
    """Read messages of a kind of frame, for ever; those above ``most`` bytes end the stream."""
    if frame == "line":
        return _lines(take, most)
    if frame == "varint":
        return _varints(take, most)
    return _lengths(LENGTHS[frame], take, most)


def framed(frame: str, data: Bytes, most: int, address: str) -> tuple[Bytes, ...]:
    """The parts of a message in its frame.

    Raises
    ------
    TransportError
        It is larger than ``most`` bytes, or the frame cannot hold it.
    """
    if len(data) > most:
        raise TransportError("too large", address, f"{len(data)} bytes are more than max_message={most}")
    length = LENGTHS.get(frame)
    if length is not None:
        try:
            return length.pack(len(data)), data
        except struct.error:
            raise TransportError("too large", address, f"{len(data)} bytes are more than a length of `{frame}` can say") from None
    if frame == "none":
        return (data,)
    if frame == "varint":
        return varint(len(data)), data
    if b"\n" in bytes(data):
        raise TransportError("protocol", address, "a message that is a line has no newline within")
    return data, b"\n"


def varint(number: int) -> bytes:
    """A number as protobuf's base 128 varint."""
    out = bytearray()
    while number > 127:
        out.append(number & 127 | 128)
        number >>= 7
    out.append(number)
    return bytes(out)


def _lengths(length: struct.Struct, take: Callable[[memoryview], object], most: int) -> Machine:
    yield Frames(length, take, most)


def _varints(take: Callable[[memoryview], object], most: int) -> Machine:
    while True:
        size, shift = 0, 0
        byte = (yield Between(1))[0]
        while True:
            size |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
            if shift == 7 * VARINT_BYTES:
                raise ProtocolError("a length of more than ten bytes")
            byte = (yield 1)[0]
        if size > most:
            raise too_large(size, most)
        take((yield size))


def _lines(take: Callable[[memoryview], object], most: int) -> Machine:
    line = Until(b"\n", most + 2, between=True)
    while True:
        text = yield line
        take(text[: -2 if len(text) > 1 and text[-2] == CR else -1])
