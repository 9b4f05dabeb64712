"""Images of YARP, drawn: pixel codes of yarp/sig/Image.h, rows padded as yarp/sig/ImageNetworkHeader.h says."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosetta_jit.runtime.looks.pixels import interleaved

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder import Holder

PIXELS: dict[bytes, tuple[int, str, tuple[int, ...]]] = {
    b"mono": (1, "u1", ()),
    b"rgb\0": (3, "u1", ()),
    b"bgr\0": (3, "u1", (2, 1, 0)),
    b"rgba": (4, "u1", ()),
    b"bgra": (4, "u1", (2, 1, 0, 3)),
    b"mo16": (1, "<u2", ()),
    b"int\0": (1, "<i4", ()),
    b"sign": (1, "i1", ()),
    b"dec\0": (1, "<f4", ()),
}
"""Channels, numpy's type of one, and the order in which they are red, green, blue and alpha, by the letters of the code."""


def picture(message: Holder) -> Any:
    """The pixels of an image; None of any other message, and of pixels that cannot be drawn."""
    record, getters = message.access_.record, message.access_.getters
    if not {"pixel_code", "geometry", "pixels"} <= record.entries.keys():
        return None
    code, geometry, data = (getters[name](message) for name in ("pixel_code", "geometry", "pixels"))
    found = PIXELS.get((int(code) & 0xFFFFFFFF).to_bytes(4, "little")) if isinstance(code, int) else None
    if found is None or not isinstance(data, bytes):
        return None
    quantum, width, height = (int(geometry.access_.getters[name](geometry)) for name in ("quantum", "width", "height"))
    channels, dtype, order = found
    row_bytes = width * channels * int(dtype[-1])
    return interleaved(data, (height, width, channels), -(-row_bytes // max(quantum, 1)) * max(quantum, 1), dtype, order)
