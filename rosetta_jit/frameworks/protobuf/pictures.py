"""Images of RST's type, drawn (rst/vision/Image.proto)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosetta_jit.runtime.looks.pixels import interleaved, planar

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder import Holder

DEPTHS = {8: "u1", 16: "<u2", 32: "<f4"}
GRAY, RGB, BGR, YUV = 0, 1, 2, 4
ORDERS: dict[int, tuple[int, ...]] = {GRAY: (), RGB: (), BGR: (2, 1, 0), YUV: (0,)}
"""The channels to show; of YUV the first, the brightness."""


def picture(message: Holder) -> Any:
    """The pixels of an ``rst.vision.Image``; None of any other message, and of colours that cannot be drawn."""
    if message.access_.record.struct != "rst.vision.Image":
        return None
    names = ("data", "height", "width", "channels", "depth", "color_mode", "data_order")
    data, height, width, channels, depth, mode, order = (message.access_.getters[name](message) for name in names)
    if depth not in DEPTHS or mode not in ORDERS or max(ORDERS[mode], default=0) >= channels:
        return None
    shape, dtype = (height, width, channels), DEPTHS[depth]
    if order == 0:
        return planar(data, shape, dtype, ORDERS[mode])
    return interleaved(data, shape, width * channels * int(dtype[-1]), dtype, ORDERS[mode])
