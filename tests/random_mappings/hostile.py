"""What hostile hands and other writers make of messages: cut and altered bytes; protobuf in another order, with unknown fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import random
    from collections.abc import Iterator

UNKNOWN = (
    b"\x80\xfa\x01\x96\x01",  # field 4000, a varint
    b"\x81\xfa\x01" + bytes(range(8)),
    b"\x82\xfa\x01\x03abc",
    b"\x85\xfa\x01\x01\x02\x03\x04",
    b"\x83\xfa\x01\x08\x01\x84\xfa\x01",  # a group with a field
)


def altered(rng: random.Random, message: bytes) -> bytes:
    """A message that is cut, has other bytes, or both."""
    data = bytearray(message[: rng.choice([len(message), len(message), rng.randrange(len(message) + 1)])])
    for _ in range(rng.randrange(3) if data else 0):
        at = rng.randrange(len(data))
        data[at] = rng.choice([0, 1, 127, 128, 255, rng.randrange(256), data[at] ^ 1 << rng.randrange(8)])
    if rng.random() < 0.1:
        data += rng.randbytes(rng.randrange(1, 9))
    return bytes(data)


def records(message: bytes) -> Iterator[tuple[int, bytes]]:
    """The fields of a protobuf message: their numbers, and their bytes with tags."""
    at = 0
    while at < len(message):
        begin = at
        tag, at = varint(message, at)
        match tag & 7:
            case 0:
                _, at = varint(message, at)
            case 1:
                at += 8
            case 2:
                size, at = varint(message, at)
                at += size
            case 5:
                at += 4
            case other:
                raise AssertionError(other)
        yield tag >> 3, message[begin:at]


def varint(data: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        value |= (data[at] & 127) << shift
        shift += 7
        at += 1
        if data[at - 1] < 128:
            return value, at


def mixed(rng: random.Random, message: bytes, other: bytes, scalars: set[int]) -> bytes:
    """The same message: fields in another order, those of one number in theirs; unknown ones among them; others' scalars before its own."""
    own = list(records(message))
    pending: dict[int, list[bytes]] = {}
    for number, data in own:
        pending.setdefault(number, []).append(data)
    order = [number for number, _ in own]
    rng.shuffle(order)
    pieces = [pending[number].pop(0) for number in order]
    there = {number for number, _ in own}
    for number, data in records(other):
        if number in there & scalars and rng.random() < 0.5:
            pieces.insert(0, data)
    for _ in range(rng.randrange(3)):
        pieces.insert(rng.randrange(len(pieces) + 1), rng.choice(UNKNOWN))
    return b"".join(pieces)
