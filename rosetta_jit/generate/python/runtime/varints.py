"""Integers of protobuf for generated modules that have some: part of those."""

_SHORT = tuple(bytes([number]) for number in range(128))


def _varint(number: int) -> bytes:  # pyright: ignore[reportUnusedFunction]
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
