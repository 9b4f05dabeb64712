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


def yuv(pixels: np.ndarray, encoding: str) -> bytes:
    """RGB as YUV, by the formulas of the reference."""
    red, green, blue = (pixels[..., number].astype(np.int64) for number in range(3))

    def weighted(colours: tuple[np.ndarray, ...], weights: tuple[int, int, int], halves: int, shift: int) -> np.ndarray:
        total = sum(weight * colour for weight, colour in zip(weights, colours, strict=True)) + (halves << 19)
        return (total >> shift).astype(np.uint8)

    luma = weighted((red, green, blue), (269484, 528482, 102760), 33, 20)
    weights = (-155188, -305135, 460324), (460324, -385875, -74448)
    if encoding.startswith("nv"):
        corner = tuple(colour[::2, ::2] for colour in (red, green, blue))
        chroma = [weighted(corner, each, 257, 20) for each in weights]
        return luma.tobytes() + np.stack(chroma if encoding == "nv12" else chroma[::-1], -1).tobytes()
    pair = tuple(colour[:, ::2] + colour[:, 1::2] for colour in (red, green, blue))
    u, v = (weighted(pair, each, 514, 21) for each in weights)
    parts = [luma[:, ::2], u, luma[:, 1::2], v] if encoding.endswith("yuy2") else [u, luma[:, ::2], v, luma[:, 1::2]]
    return np.stack(parts, -1).tobytes()


@pytest.mark.parametrize("backend", BACKENDS)
def test_rgb_as_yuv(backend):
    encodings = ("nv12", "nv21", "yuv422", "yuv422_yuy2")
    orders = dict.fromkeys(encodings, ".data") | {"nv21": "permuted(permuted(.data, [2, 1, 0]), [2, 1, 0])"}
    rules = "".join(f'  .{each} = yuv_of({orders[each]}, "{each}", .width, .height)\n' for each in encodings)
    files = {
        **FILES,
        "cam/msg/All.msg": "".join(f"uint8[] {each}\n" for each in encodings),
        "m.mapping": 'import "cam/msg/Image.msg"\nimport "cam/msg/All.msg"\ndata-holder: cam/msg/All\nwire-schema: cam/msg/Image\n'
        f"unpack-rules:\n{rules}  ignore .step\n",
    }
    decode = rj.Decoder("m.mapping", schema=files, backend=backend)
    write = rj.Encoder.of("cam/msg/Image", schema=files, imports=["cam/msg/Image.msg"], backend="interpreter")
    for height, width in ((2, 2), (4, 6)):
        pixels = np.random.default_rng(2).integers(0, 256, (height, width, 3), np.uint8)
        given = {"height": height, "width": width, "data": pixels.reshape(-1)}
        found = decode(write(write.holder_type.from_dict(given)))
        assert {each: bytes(getattr(found, each)) for each in encodings} == {each: yuv(pixels, each) for each in encodings}
    for wrong in ({"height": 3}, {"width": 5}, {"data": pixels.reshape(-1)[:-1]}):
        with pytest.raises(rj.DecodeError) as error:
            decode(write(write.holder_type.from_dict({**given, **wrong})))
        assert error.value.kind in ("image", "range")
