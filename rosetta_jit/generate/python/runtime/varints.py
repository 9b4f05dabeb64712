"""Integers and lengths of protobuf."""

# pyright: reportUnusedFunction=false

from __future__ import annotations

_SHORT = tuple(bytes([number]) for number in range(128))


def _varint(number: int) -> bytes:
    """Seven bits a byte, the low ones first; all bytes but the last have the eighth bit."""
    if number < 128:
        return _SHORT[number]
    if number < 16384:
        return bytes((number & 127 | 128, number >> 7))
    if number < 2097152:
        return bytes((number & 127 | 128, number >> 7 & 127 | 128, number >> 14))
    written = bytearray()
    while number > 127:
        written.append(number & 127 | 128)
        number >>= 7
    written.append(number)
    return bytes(written)


def _several_bytes(data: bytes, at: int) -> tuple[int, int]:
    """An integer of up to ten bytes and the place behind it, which is 0 where none ends."""
    number = shift = 0
    for byte in data[at : at + 10] if at >= 0 else b"":
        if byte < 128:
            return (number | byte << shift) & 18446744073709551615, at + shift // 7 + 1
        number |= (byte & 127) << shift
        shift += 7
    return 0, 0


def _long_length(data: bytes, at: int) -> tuple[int, int]:
    """A length of up to five bytes and the place behind it, which is 0 where there is none, or one of more than 2 GiB."""
    number = shift = 0
    for byte in data[at : at + 5] if at >= 0 else b"":
        if byte < 128:
            number |= byte << shift
            return (number, at + shift // 7 + 1) if number < 2147483648 else (0, 0)
        number |= (byte & 127) << shift
        shift += 7
    return 0, 0
