"""The functions of images that kernels call, by Pillow.

Bytes are hostile: what an image claims of its size is bounded before anything is allocated for it, and whatever Pillow raises says that
they are no image. The last answers are kept, a set for each thread: a kernel that ran out of room, and one that measured before it
wrote, ask again.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from io import BytesIO
from typing import Any, cast

from rosetta_jit.errors import MappingError
from rosetta_jit.runtime.limits import MAX_IMAGE_SIDE, MAX_PIXEL_BYTES
from rosetta_jit.startup.dataclass import dataclass

DEFLATE_RATIO = 1032
"""How much shorter deflate makes bytes at most (RFC 1951, 3.2.5: 258 bytes by two bits); a PNG that claims more is none."""

BROKEN, LARGE, UNUSUAL, UNFIT, UNKNOWN = -1, -2, -3, -4, -5
CHANNELS = {"L": 1, "LA": 2, "RGB": 3, "RGBA": 4, "I;16": 1}
PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
DEPTH_AT, COLOUR_AT = 24, 25
"""In a PNG (ISO 15948, 11.2.2 behind 5.2)."""

FORMATS = ("PNG", "PNG", "JPEG")
MODES = (
    {1: "L", 2: "LA", 3: "RGB", 4: "RGBA"},
    {1: "I;16"},
    {1: "L", 3: "RGB"},
)
"""Of "png", "png16" and "jpeg": the kind of pixels by the number of channels."""

QUALITIES = ((0, 9), (0, 9), (1, 100))


@dataclass(frozen=True, slots=True)
class Answer:
    """The bytes that a question had for an answer, or a problem."""

    question: tuple[object, ...]
    data: bytes
    problem: int = 0


@dataclass(frozen=True, slots=True)
class Measures:
    """What is known of an image before its pixels are."""

    width: int
    height: int
    channels: int
    depth: int

    @property
    def size(self) -> int:
        return self.width * self.height * self.channels * self.depth // 8


def image_functions() -> Mapping[str, Callable[..., int]]:
    """The functions by name, with a memory of their own; raises MappingError where pillow is not installed."""
    if find_spec("PIL") is None:
        from rosetta_jit.catalogue.images import no_library

        raise MappingError((no_library(),))
    images = Images()
    return {
        "image.measure": images.measure,
        "image.decompress": images.decompress,
        "image.compressed": images.compressed,
        "image.compress": images.compress,
    }


class Images:
    """Answers questions, and remembers the last."""

    def __init__(self) -> None:
        self._kept = threading.local()

    def measure(self, what: int, image: memoryview) -> int:
        """Width, height, channels, depth, or the bytes of all pixels."""
        found = _measures(bytes(image))
        if isinstance(found, int):
            return found
        return (found.width, found.height, found.channels, found.depth, found.size)[what]

    def decompress(self, image: memoryview, pixels: memoryview) -> int:
        """Fill in the pixels; their bytes are as many as was measured."""
        return _written(self._answer("decompressed", _decompressed, (bytes(image),)), pixels)

    def compressed(self, format_: int, width: int, height: int, channels: int, quality: int, pixels: memoryview) -> int:
        """The size of the pixels as an image."""
        answer = self._answer("compressed", _compressed, (format_, width, height, channels, quality, bytes(pixels)))
        return answer.problem or len(answer.data)

    def compress(self, format_: int, width: int, height: int, channels: int, quality: int, pixels: memoryview, image: memoryview) -> int:
        """Fill in the image."""
        return _written(self._answer("compressed", _compressed, (format_, width, height, channels, quality, bytes(pixels))), image)

    def _answer(self, name: str, answer: Callable[..., bytes | int], question: tuple[object, ...]) -> Answer:
        kept = cast("Answer | None", getattr(self._kept, name, None))
        if kept is not None and kept.question == question:
            return kept
        found = answer(*question)
        new = Answer(question, b"", found) if isinstance(found, int) else Answer(question, found)
        setattr(self._kept, name, new)
        return new


def _written(answer: Answer, target: memoryview) -> int:
    if answer.problem or len(answer.data) != len(target):
        return answer.problem or BROKEN
    target[:] = answer.data
    return len(target)


def _opened(image: bytes) -> Any:
    """The image, of which nothing but its head was read, or a problem."""
    from PIL import Image

    try:
        return Image.open(BytesIO(image), formats=("PNG", "JPEG"))
    except Image.DecompressionBombError:
        return LARGE
    except Exception:  # noqa: BLE001 - Pillow has no base for what it raises on bytes that are no image
        return BROKEN


def _measures(data: bytes) -> Measures | int:
    image = _opened(data)
    return image if isinstance(image, int) else _measured(image, data)


def _measured(image: Any, data: bytes) -> Measures | int:
    mode = _mode(image, data)
    if mode not in CHANNELS:
        return UNUSUAL
    measures = Measures(image.width, image.height, CHANNELS[mode], 16 if mode == "I;16" else 8)
    claims_too_much = data.startswith(PNG_SIGNATURE) and image.width * image.height * _bits(data) // 8 > DEFLATE_RATIO * len(data)
    return LARGE if measures.size > MAX_PIXEL_BYTES or claims_too_much else measures


def _bits(png: bytes) -> int:
    """Bits of a pixel, as they are compressed, at least."""
    return png[DEPTH_AT]


def _mode(image: Any, data: bytes) -> str:
    """What the pixels are given as: palettes as colours, single bits as grey. Pillow would halve colours of 16 bits without a word."""
    if data.startswith(PNG_SIGNATURE) and data[DEPTH_AT] == 16 and data[COLOUR_AT]:
        return ""
    if image.mode == "P":
        return "RGBA" if "transparency" in image.info else "RGB"
    return "L" if image.mode == "1" else image.mode


def _decompressed(data: bytes) -> bytes | int:
    image = _opened(data)
    if isinstance(image, int):
        return image
    measures = _measured(image, data)
    if isinstance(measures, int):
        return measures
    mode = _mode(image, data)
    try:
        shown: Any = image if image.mode == mode else image.convert(mode)
        return shown.tobytes()
    except Exception:  # noqa: BLE001 - as in `_opened`
        return BROKEN


def _compressed(format_: int, width: int, height: int, channels: int, quality: int, pixels: bytes) -> bytes | int:
    mode = MODES[format_].get(channels)
    low, high = QUALITIES[format_]
    if mode is None or not (0 < width <= MAX_IMAGE_SIDE and 0 < height <= MAX_IMAGE_SIDE and low <= quality <= high):
        return UNKNOWN
    if width * height * channels * (2 if mode == "I;16" else 1) != len(pixels):
        return UNFIT
    from PIL import Image

    image = Image.frombuffer(mode, (width, height), pixels, "raw", mode, 0, 1)
    written = BytesIO()
    options = {"quality": quality} if FORMATS[format_] == "JPEG" else {"compress_level": quality}
    image.save(written, FORMATS[format_], **options)
    return written.getvalue()
