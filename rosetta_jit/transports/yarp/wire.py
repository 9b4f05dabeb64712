"""What YARP ports write on their connections: numbers, frames, commands, acknowledgements.

    int   = 'Y' 'A' i32 'R' 'P'
    hello = int (7777 + carrier, + 128 where acknowledgements are wanted), i32 length, name NUL, group where the carrier is mcast
    group = u8 * 4 address, u16 port, big-endian
    frame = int (bytes of the index), index, command, payload
    index = u8 blocks, u8 replies, ff * 8, i32 * (blocks + replies)
    command = i32 length of the text, '~', key, 0, 1, text

All else little-endian. The command is the first block, the payload the others. Key `D` is data, `d` data whose sender wants a reply, `q`
the end, 0 says that the text begins with the key, and an envelope follows it.
"""

from __future__ import annotations

import struct
from collections.abc import Generator
from typing import Any

from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.transports.feeding import Between, ProtocolError
from rosetta_jit.transports.limits import MAX_ENVELOPE_BYTES, MAX_YARP_NAME_BYTES

FIRST_CARRIER = 7777
UDP, MCAST, TCP = 0, 1, 3
WITH_ACKS = 128
CARRIERS = {"tcp": TCP + WITH_ACKS, "fast_tcp": TCP, "udp": UDP, "mcast": MCAST}
CONNECTIONLESS = ("udp", "mcast")
"""Carriers of which TCP carries no more than the hello; messages come in datagrams (`rosetta_jit.transports.yarp.pieces`)."""

_INT = struct.Struct("<2si2s")
_LENGTH = struct.Struct("<i")
_COMMAND = struct.Struct("<i4B")
_TILDE = ord("~")


def yarp_int(number: int) -> bytes:
    """A number as ports exchange it."""
    return _INT.pack(b"YA", number, b"RP")


def int_of(piece: memoryview) -> int:
    """The number of eight bytes.

    Raises
    ------
    ProtocolError
        They are none.
    """
    first, number, last = _INT.unpack(piece)
    if first != b"YA" or last != b"RP":
        raise ProtocolError("the stream is out of step: no YARP number where one belongs")
    return number


ACK = yarp_int(0)

_FRAME = yarp_int(10) + b"\2\1" + b"\xff" * 8
_SIZES = struct.Struct("<iii")
_GOODBYE = yarp_int(10) + b"\1\1" + b"\xff" * 8 + _SIZES.pack(10, 0, 2)[:8] + _COMMAND.pack(2, _TILDE, 0, 0, 1) + b"q\0"


def hello(carrier: str, name: str) -> bytes:
    """The first bytes of a connection: the carrier and the sender's name."""
    text = name.encode() + b"\0"
    return yarp_int(FIRST_CARRIER + CARRIERS[carrier]) + _LENGTH.pack(len(text)) + text


def goodbye() -> bytes:
    """The frame that ends a connection."""
    return _GOODBYE


def head_of(size: int, *, reply: bool = False, envelope: str | None = None) -> bytes:
    """All of a frame that stands before a payload of so many bytes."""
    key, text = ord("d" if reply else "D"), b""
    if envelope is not None:
        key, text = 0, (b"d " if reply else b"D ") + envelope.encode() + b"\0"
    return _FRAME + _SIZES.pack(8 + len(text), size, 0) + _COMMAND.pack(len(text), _TILDE, key, 0, 1) + text


@dataclass(frozen=True, slots=True)
class Frame:
    """One frame that came: its command, the envelope or empty, and the payload."""

    command: str
    envelope: str
    payload: memoryview


def frames(most: int) -> Generator[Any, memoryview, Frame]:
    """Read one frame; its payload is valid until the next read.

    Raises
    ------
    ProtocolError
        It is no frame, or larger than ``most`` bytes.
    """
    size = int_of((yield _START))
    if not 10 <= size <= 10 + 2 * 255:
        raise ProtocolError(f"an index of {size} bytes")
    index = yield size
    blocks, lengths = index[0], index[0] + index[1]
    if not blocks:
        raise ProtocolError("a frame without a command")
    sizes = struct.unpack(f"<{lengths}i", (yield 4 * lengths))[:blocks]
    total = sum(sizes[1:])
    if min(sizes) < 0 or not 8 <= sizes[0] <= 8 + MAX_ENVELOPE_BYTES:
        raise ProtocolError("a block of impossible length")
    if total > most:
        raise ProtocolError(f"a message of {total} bytes, more than max_message={most}")
    command, envelope = _command(bytes((yield sizes[0])))
    return Frame(command, envelope, (yield total))


_START = Between(8)


def _command(block: bytes) -> tuple[str, str]:
    _, tilde, key, _, _ = _COMMAND.unpack_from(block)
    if tilde != _TILDE:
        raise ProtocolError("a command without its mark")
    if key:
        return chr(key), ""
    text = block[8:].split(b"\0", 1)[0].decode("utf-8", "replace")
    return text[:1], text[2:]


def hello_rest() -> Generator[Any, memoryview, str]:
    """Read the sender's name behind the first number; without what may follow it about port monitors.

    Raises
    ------
    ProtocolError
        No name has such a length.
    """
    (size,) = _LENGTH.unpack((yield 4))
    if not 1 <= size <= MAX_YARP_NAME_BYTES:
        raise ProtocolError(f"a name of {size} bytes")
    return name_in(bytes((yield size)))


def name_in(text: bytes) -> str:
    """The name in the text by which a port introduces itself."""
    return text.split(b"\0", 1)[0].decode("utf-8", "replace").split(" (", 1)[0].strip()
