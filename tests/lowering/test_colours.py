"""Mosaics and YUV as RGB, against the formulas in numpy, and against OpenCV where it is installed; in every backend."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.lowering.colours.conversion import ENCODINGS, MOSAICS

OTHER_BACKENDS = ["python", "interpreter"]
SOME = ("bayer_gbrg8", "yuv422", "nv21")
SIZES = ((2, 2, 0), (6, 4, 3), (10, 8, 0))
FILES = {
    "rgb.proto": 'syntax = "proto2"; message Rgb { required uint32 width = 1; required uint32 height = 2; required bytes data = 3; }',
    "some.mapping": """import "ros1/sensor_msgs/Image.msg"
import "rgb.proto"
data-holder: Rgb
wire-schema: sensor_msgs/Image
unpack-rules:
  .width = .width
  .height = .height
  .data = table(.encoding) {
    "bayer_gbrg8" = rgb_of(.data, "bayer_gbrg8", .width, .height, .step),
    "yuv422" = rgb_of(.data, "yuv422", .width, .height, .step),
    "nv21" = rgb_of(.data, "nv21", .width, .height, .step),
    otherwise reject "another encoding"
  }
  ignore rest
""",
}


def rows_of(encoding, width, height):
    """How many rows an image has, and how many bytes each."""
    return (height * 3 // 2 if encoding.startswith("nv") else height), (width * 2 if encoding.startswith("yuv422") else width)


def message(encoding, width, height, padding=0, seed=0):
    """A message of ROS 1, and its rows without what pads them."""
    rows, size = rows_of(encoding, width, height)
    pixels = np.random.default_rng(seed).integers(0, 256, (rows, size), np.uint8)
    return wire(encoding, width, height, size + padding, np.pad(pixels, ((0, 0), (0, padding)), constant_values=77).tobytes()), pixels


def wire(encoding, width, height, step, data):
    numbers = (np.uint32(each).tobytes() for each in (height, width, len(encoding)))
    return b"".join((bytes(16), *numbers, encoding.encode(), b"\0", np.uint32(step).tobytes(), np.uint32(len(data)).tobytes(), data))


@cache
def decoder(backend):
    """The shipped mapping, or of the slower backends one of the same rules, but fewer."""
    if backend == "llvm":
        return rj.Decoder("ros1/image_rgb.mapping", encoding="ros1")
    return rj.Decoder("some.mapping", schema=FILES, encoding="ros1", backend=backend)


def rgb_of(sent, backend="llvm"):
    image = decoder(backend)(sent)
    return np.frombuffer(bytes(image.data), np.uint8).reshape(image.height, image.width, 3)


def of_yuv(y, u, v):
    """BT.601 of limited range, in 20 bits behind the point."""
    y, u, v = np.maximum(y.astype(int) - 16, 0) * 1220542 + (1 << 19), u.astype(int) - 128, v.astype(int) - 128
    sums = (y + 1673527 * v, y - 852492 * v - 409993 * u, y + 2116026 * u)
    return np.stack([np.clip(each >> 20, 0, 255) for each in sums], axis=-1)


def of_mosaic(pixels, pattern):
    """Each colour as the mean of the nearest pixels that have it, by the weights of a square of nine."""
    height, width = pixels.shape
    wide = np.pad(pixels.astype(int), 1, mode="reflect")
    found = np.empty((height, width, 3), int)
    for y in range(height):
        for x in range(width):
            near = {"r": [], "g": [], "b": []}
            for down, right in ((0, 0), (-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (-1, 1), (1, -1), (1, 1)):
                near[pattern[(y + down) % 2 * 2 + (x + right) % 2]].append(wide[y + down + 1, x + right + 1])
            own = pattern[y % 2 * 2 + x % 2]
            near[own] = near[own][:1]
            found[y, x] = [(sum(near[each]) + len(near[each]) // 2) // len(near[each]) for each in "rgb"]
    return found


def wanted(encoding, pixels, width, height):
    if encoding in MOSAICS:
        return of_mosaic(pixels, MOSAICS[encoding])
    if encoding.startswith("yuv422"):
        pairs = pixels.reshape(height, width, 2)
        luma, chroma = (pairs[..., 0], pairs[..., 1]) if encoding == "yuv422_yuy2" else (pairs[..., 1], pairs[..., 0])
        return of_yuv(luma, *(np.repeat(chroma[:, which::2], 2, axis=1) for which in range(2)))
    chroma = pixels[height:].reshape(height // 2, width // 2, 2).repeat(2, axis=0).repeat(2, axis=1)
    first = int(encoding == "nv21")
    return of_yuv(pixels[:height], chroma[..., first], chroma[..., 1 - first])


@pytest.mark.parametrize("backend", ["llvm", *OTHER_BACKENDS])
def test_by_the_formulas(backend):
    for encoding in ENCODINGS if backend == "llvm" else SOME:
        for width, height, padding in SIZES:
            sent, pixels = message(encoding, width, height, padding, seed=width)
            assert np.array_equal(rgb_of(sent, backend), wanted(encoding, pixels, width, height)), (encoding, width, height)


def test_the_image_says_that_it_is_rgb():
    image = decoder("llvm")(message("nv12", 4, 2)[0])
    assert (image.channels, image.color_mode, image.data_order, image.depth) == (3, 1, 1, 8)


def test_rows_end_to_end():
    rules = FILES["some.mapping"].replace("bayer_gbrg8", "bayer_bggr8").replace(", .step)", ")")
    decode = rj.Decoder("some.mapping", schema={**FILES, "some.mapping": rules}, encoding="ros1", backend="python")
    for encoding in ("bayer_bggr8", "yuv422"):
        sent, pixels = message(encoding, 6, 4)
        found = np.frombuffer(bytes(decode(sent).data), np.uint8).reshape(4, 6, 3)
        assert np.array_equal(found, wanted(encoding, pixels, 6, 4))


@pytest.mark.skipif(find_spec("cv2") is None, reason="opencv-python-headless is not installed")
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_as_opencv(encoding):
    """YUV in each pixel; mosaics in all but the outermost, where OpenCV repeats what is beside them."""
    import cv2

    name = f"Bayer{MOSAICS[encoding].upper()}2RGB" if encoding in MOSAICS else ""
    name = name or f"YUV2RGB_{ {'yuv422': 'UYVY', 'yuv422_yuy2': 'YUY2'}.get(encoding, encoding.upper()) }"
    sent, pixels = message(encoding, 64, 48)
    theirs = cv2.cvtColor(pixels.reshape(48, 64, 2) if encoding.startswith("yuv422") else pixels, getattr(cv2, f"COLOR_{name}"))
    inner = slice(1, -1) if encoding in MOSAICS else slice(None)
    assert np.array_equal(rgb_of(sent)[inner, inner], theirs[inner, inner])


def test_pictures_that_are_not_as_they_say():
    data = bytes(24)
    for encoding, width, height, step, reason in (
        ("bayer_rggb8", 4, 4, 4, "not as many"),
        ("bayer_rggb8", 5, 4, 6, "odd number of columns"),
        ("bayer_rggb8", 8, 3, 8, "odd number of rows"),
        ("bayer_rggb8", 0, 4, 6, "width below 2"),
        ("bayer_rggb8", 6, 2**31, 6, "height above 65500"),
        ("yuv422", 4, 4, 6, "overlap"),
        ("yuv422", 8, 2, 2**32 - 1, "fewer bytes"),
        ("nv12", 4, 6, 4, "not as many"),
    ):
        with pytest.raises(rj.DecodeError) as error:
            decoder("llvm")(wire(encoding, width, height, step, data))
        assert error.value.kind == "image", (encoding, width, height)
        assert reason in str(error.value)
    with pytest.raises(rj.DecodeError) as unknown:
        decoder("llvm")(wire("rgb8", 4, 2, 12, data))
    assert unknown.value.kind == "rejected"
