"""Integers of protobuf of several bytes, for generated modules that read some: part of those."""

from __future__ import annotations


def _several_bytes(data: bytes, at: int) -> tuple[int, int]:  # pyright: ignore[reportUnusedFunction]
    """An integer of up to ten bytes and the place behind it, which is 0 where none ends."""
    number = shift = 0
    for byte in data[at : at + 10] if at >= 0 else b"":
        if byte < 128:
            return (number | byte << shift) & 18446744073709551615, at + shift // 7 + 1
        number |= (byte & 127) << shift
        shift += 7
    return 0, 0
