"""Protobuf's integers and fields, as far as logs need them: where one message or field ends, and the next begins."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.logs.limits import MAX_VARINT_BYTES

if TYPE_CHECKING:
    from collections.abc import Iterator


def varint(data: bytes | memoryview, at: int) -> tuple[int, int]:
    """A varint, and the place behind it; ValueError if it does not end, or takes more than 64 bits."""
    value = 0
    for place in range(at, min(at + MAX_VARINT_BYTES, len(data))):
        byte = data[place]
        value |= (byte & 0x7F) << 7 * (place - at)
        if byte < 0x80:
            if value >> 64:
                break
            return value, place + 1
    raise ValueError("an integer without an end")


def fields(data: bytes | memoryview) -> Iterator[tuple[int, int | bytes]]:
    """The fields of a message: number and value; groups and numbers of fixed size are passed over. ValueError where it is damaged."""
    at = 0
    while at < len(data):
        key, at = varint(data, at)
        match key & 7:
            case 0:
                value, at = varint(data, at)
                yield key >> 3, value
            case 2:
                size, at = varint(data, at)
                if size > len(data) - at:
                    raise ValueError("a field is cut short")
                yield key >> 3, bytes(data[at : at + size])
                at += size
            case 1:
                at += 8
            case 5:
                at += 4
            case wire:
                raise ValueError(f"wire type {wire}")
