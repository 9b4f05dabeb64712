"""Orders of pixels around compression and colours, against numpy."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

import rosetta_jit as rj

pillow = pytest.importorskip("PIL.Image", reason="needs Pillow")

BACKENDS = ["llvm", "python", "interpreter"]
FILES = {
    "cam/msg/Image.msg": "uint32 height\nuint32 width\nuint32 step\nuint8[] data\n",
    "cam/msg/Compressed.msg": "string format\nuint8[] data\n",
}
HEAD = 'import "cam/msg/Image.msg"\nimport "cam/msg/Compressed.msg"\ndata-holder: cam/msg/Image\nwire-schema: cam/msg/Compressed\n'
UNPACK = """unpack-rules:
  .height = uint32(image_height(.data))
  .width = uint32(image_width(.data))
  .step = uint32({step})
  .data = {data}
  ignore .format
"""
PACK = """pack-rules:
  .format = "png"
  .data = compress({data}, "png", .width, .height, 3)
  ignore .step
"""
W, H = "image_width(.data)", "image_height(.data)"
ORDERS = {
    "bgr": (f"3 * {W}", "permuted(decompress(.data), [2, 1, 0])", "permuted(.data, [2, 1, 0])"),
    "planar": (f"{W}", "planar(decompress(.data), 3)", "interleaved(.data, 3)"),
    "padded": (f"3 * {W} + 5", f"padded_rows(decompress(.data), {H}, {W} * 3, {W} * 3 + 5)", "rows(.data, .height, .width * 3, .step)"),
    "padded bgr": (
        f"align(3 * {W}, 4)",
        f"padded_rows(permuted(decompress(.data), [2, 1, 0]), {H}, {W} * 3, align({W} * 3, 4))",
        "permuted(rows(.data, .height, .width * 3, .step), [2, 1, 0])",
    ),
    "upside down": (f"3 * {W}", "reversed(reversed(decompress(.data)), 3)", "reversed(reversed(.data, 3))"),
    "columns": (f"3 * {W}", f"transposed(decompress(.data), {H}, {W}, 3)", "transposed(.data, .width, .height, 3)"),
}


def ordered(pixels: np.ndarray, order: str) -> np.ndarray:
    """The rows of a picture in an order."""
    height, width, _ = pixels.shape
    match order:
        case "bgr":
            return pixels[:, :, ::-1]
        case "planar":
            return pixels.transpose(2, 0, 1)
        case "padded":
            return np.pad(pixels.reshape(height, -1), ((0, 0), (0, 5)))
        case "padded bgr":
            return np.pad(pixels[:, :, ::-1].reshape(height, -1), ((0, 0), (0, -3 * width % 4)))
        case "upside down":
            return pixels[::-1, ::-1]
        case _:
            return pixels.transpose(1, 0, 2)


def programs(order: str, backend: str) -> tuple[rj.Decoder, rj.Encoder, rj.Encoder]:
    step, unpacked, packed = ORDERS[order]
    files = {**FILES, "m.mapping": HEAD + UNPACK.format(step=step, data=unpacked) + PACK.format(data=packed)}
    options: dict[str, Any] = {"schema": files, "backend": backend}
    write = rj.Encoder.of("cam/msg/Compressed", schema=files, imports=["cam/msg/Compressed.msg"], backend="interpreter")
    return rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options), write


def compressed(pixels: np.ndarray) -> bytes:
    out = io.BytesIO()
    pillow.fromarray(pixels).save(out, "png")
    return out.getvalue()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("order", ORDERS)
def test_pixels_in_another_order(order, backend):
    decode, encode, write = programs(order, backend)
    for height, width in ((3, 5), (1, 1), (2, 4)):
        pixels = np.random.default_rng(1).integers(0, 256, (height, width, 3), np.uint8)
        image = decode(write(write.holder_type.from_dict({"format": "png", "data": compressed(pixels)})))
        assert (image.height, image.width) == (height, width)
        assert bytes(image.data) == ordered(pixels, order).tobytes()
        assert decode(encode(image)) == image
