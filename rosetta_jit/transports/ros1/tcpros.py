"""TCPROS: a header of fields each way, then messages with their length before them.

    header = u32 length, (u32 length, "name=value")*
    messages = (u32 length, message)*
    answer of a service = u8 whether it worked, u32 length, the answer or why not

All little-endian.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Generator, Mapping
from typing import TYPE_CHECKING, Any

from rosetta_jit.transports.feeding import Frames, ProtocolError
from rosetta_jit.transports.limits import MAX_HEADER_BYTES

if TYPE_CHECKING:
    from rosetta_jit.transports.feeding import Machine

LENGTH = struct.Struct("<I")


def header(fields: Mapping[str, str]) -> bytes:
    """A header with these fields."""
    parts = [f"{name}={value}".encode() for name, value in fields.items()]
    body = b"".join(LENGTH.pack(len(each)) + each for each in parts)
    return LENGTH.pack(len(body)) + body


def read_header() -> Generator[Any, memoryview, dict[str, str]]:
    """Read a header.

    Raises
    ------
    ProtocolError
        It is none.
    """
    (size,) = LENGTH.unpack((yield 4))
    if size > MAX_HEADER_BYTES:
        raise ProtocolError(f"a header of {size} bytes: is that a node of ROS 1?")
    body, at, fields = bytes((yield size)), 0, dict[str, str]()
    while at < size:
        if at + 4 > size or at + 4 + LENGTH.unpack_from(body, at)[0] > size:
            raise ProtocolError("a header whose fields go beyond its end")
        (length,) = LENGTH.unpack_from(body, at)
        name, equals, value = body[at + 4 : at + 4 + length].partition(b"=")
        if not equals:
            raise ProtocolError("a header with a field without a value")
        fields[name.decode("utf-8", "replace")] = value.decode("utf-8", "replace")
        at += 4 + length
    return fields


def messages(take: Callable[[memoryview], object], most: int) -> Machine:
    """Read messages, for ever.

    Raises
    ------
    ProtocolError
        One is larger than ``most`` bytes.
    """
    yield Frames(LENGTH, take, most)


def disagreement(wanted: Mapping[str, str], found: Mapping[str, str]) -> str:
    """How two headers disagree on the type; empty where they agree, or one of them takes any."""
    for field, words in (("md5sum", "md5 sum"), ("type", "type")):
        one, two = wanted.get(field, "*"), found.get(field, "*")
        if one != two and "*" not in (one, two):
            return f"another {words}: {found.get('type', '?')} with md5 sum {found.get('md5sum', '?')}"[:300]
    return ""
