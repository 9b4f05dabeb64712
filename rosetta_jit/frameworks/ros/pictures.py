"""Images of sensor_msgs, drawn: encodings as sensor_msgs/image_encodings.h names them, those that are colours or numbers."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from rosetta_jit.runtime.looks.pixels import interleaved

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder import Holder

COLORS: dict[str, tuple[int, str, tuple[int, ...]]] = {
    "rgb8": (3, "u1", ()),
    "bgr8": (3, "u1", (2, 1, 0)),
    "rgba8": (4, "u1", ()),
    "bgra8": (4, "u1", (2, 1, 0, 3)),
    "mono8": (1, "u1", ()),
    "mono16": (1, "u2", ()),
}
"""Channels, numpy's type of one, and the order in which they are red, green, blue and alpha."""
NUMBERS = re.compile(r"(8|16|32|64)(U|S|F)C([1-4])?")
BAYER = re.compile(r"bayer_(?:rggb|bggr|gbrg|grbg)(8|16)")


def picture(message: Holder) -> Any:
    """The pixels of an image, the bytes of a compressed one; None of any other message."""
    name = message.access_.record.struct.replace("/msg/", "/")
    if name == "sensor_msgs/CompressedImage":
        return bytes(_field(message, "data"))
    if name != "sensor_msgs/Image":
        return None
    found = _format(str(_field(message, "encoding")))
    if found is None:
        return None
    channels, dtype, order = found
    dtype = (">" if _field(message, "is_bigendian") else "<") + dtype
    shape = (int(_field(message, "height")), int(_field(message, "width")), channels)
    return interleaved(bytes(_field(message, "data")), shape, int(_field(message, "step")), dtype, order)


def _field(message: Holder, name: str) -> Any:
    return message.access_.getters[name](message)


def _format(encoding: str) -> tuple[int, str, tuple[int, ...]] | None:
    numbers, bayer = NUMBERS.fullmatch(encoding), BAYER.fullmatch(encoding)
    if numbers is not None and not (numbers[2] == "F" and numbers[1] in ("8", "16")):
        return int(numbers[3] or 1), f"{ {'U': 'u', 'S': 'i', 'F': 'f'}[numbers[2]] }{int(numbers[1]) // 8}", ()
    if bayer is not None:
        return 1, f"u{int(bayer[1]) // 8}", ()
    return COLORS.get(encoding)
