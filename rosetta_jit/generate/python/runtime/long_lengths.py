"""Lengths of protobuf of several bytes, for generated modules that read some: part of those."""

from __future__ import annotations


def _long_length(data: bytes, at: int) -> tuple[int, int]:  # pyright: ignore[reportUnusedFunction]
    """A length of up to five bytes and the place behind it, which is 0 where there is none, or one of more than 2 GiB."""
    number = shift = 0
    for byte in data[at : at + 5] if at >= 0 else b"":
        if byte < 128:
            number |= byte << shift
            return (number, at + shift // 7 + 1) if number < 2147483648 else (0, 0)
        number |= (byte & 127) << shift
        shift += 7
    return 0, 0
