"""Images that `yarpdatadumper` kept as files, as the messages that they came in: YARP 3's form, rows padded to 8 bytes.

`.ppm`, `.pgm`, `.float` and `.floatzip` are read here; `.png` and `.jpg` by Pillow (extra `images`), frames of videos by `videos`.
"""

from __future__ import annotations

import re
import struct
import zlib
from importlib import import_module
from typing import TYPE_CHECKING, Any

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.logs.limits import MAX_PIXELS
from rosetta_jit.logs.yarp.videos import FRAME, Frames

if TYPE_CHECKING:
    from pathlib import Path


HEAD = struct.Struct("<II i4s i4s ii iiiii ii")
NETPBM = re.compile(rb"P([56])\s(\d+)\s(\d+)\s255\s")
DEPTH = {b"mono": 1, b"rgb": 3, b"dec": 4}
CODES = {each.ljust(4, b"\0"): each for each in DEPTH}
QUANTUM = 8


class ImageError(ValueError):
    """A file that holds no image."""


def type_of_images(content: bytes) -> str:
    """The type of the message that `image_message` makes; YARP keeps pixels of all other codes as those of RGB."""
    name, _, code = content.partition(b" ")
    match name.rpartition(b".")[2]:
        case b"float" | b"floatzip":
            return "yarp.sig.ImageOfPixelFloat"
        case b"pgm":
            return "yarp.sig.ImageOfPixelMono"
        case _:
            return "yarp.sig.ImageOfPixelMono" if code == b"[mono]" else "yarp.sig.ImageOfPixelRgb"


def image_message(folder: Path, content: bytes, frames: Frames) -> bytes:
    """The message of an image: ``content`` names its file, and its pixels, or a frame of a video.

    Raises
    ------
    ValueError, OSError
        There is no such file, or it holds no image; a `VideoError` where no further frame can be read either.
    LogError
        The package is missing that reads it.
    """
    name, _, _ = content.partition(b" ")
    if frame := FRAME.fullmatch(name):
        return _message(b"rgb", *frames.pixels(int(frame[1])))
    file = name.decode("ascii", "replace")
    if not file or "/" in file or "\\" in file or file.startswith("."):
        raise ImageError(f"{file!r} is no name of a file in the folder")
    path = folder / file
    match path.suffix:
        case ".ppm" | ".pgm":
            return _message(*_netpbm(path.read_bytes()))
        case ".float" | ".floatzip":
            return _message(*_floats(path.read_bytes(), compressed=path.suffix == ".floatzip"))
        case ".png" | ".jpg" | ".jpeg":
            return _message(*_pillow(path))
        case suffix:
            raise ImageError(f"images of the kind {suffix or 'without a suffix'} are not read")


def _message(code: bytes, width: int, height: int, pixels: bytes) -> bytes:
    depth = DEPTH[code]
    row = width * depth
    if not width or not height or len(pixels) != row * height:
        raise ImageError(f"{width} by {height} pixels take {row * height} bytes, and there are {len(pixels)}")
    padded = -(-row // QUANTUM) * QUANTUM
    lines = (pixels[begin : begin + row].ljust(padded, b"\0") for begin in range(0, len(pixels), row))
    size = padded * height
    head = HEAD.pack(256, 4, 9, b"mat", 9, code, 257, 5, depth, size, QUANTUM | 1 << 16, width, height, 12, size)
    return head + b"".join(lines)


def image_file(message: bytes) -> tuple[str, str, bytes]:
    """The file that an image's message becomes: its suffix, the word for its pixels, and its content; the inverse of `image_message`.

    Raises
    ------
    ImageError
        The message is no image, or one of other pixels.
    """
    try:
        *_, code, _, tag, depth, size, quantum, width, height, blob, taken = HEAD.unpack_from(message)
    except struct.error:
        raise ImageError("the message is cut short") from None
    if (
        (tag, blob) != (5, 12)
        or code not in CODES
        or depth != DEPTH[CODES[code]]
        or not (width > 0 < height and width * height <= MAX_PIXELS)
    ):
        raise ImageError("it is no image of RGB, grey or floating pixels")
    row, quantum = width * depth, quantum & 0xFFFF or 1
    padded = -(-row // quantum) * quantum
    pixels = message[HEAD.size :]
    if not padded * height == size == taken == len(pixels):
        raise ImageError(f"{width} by {height} pixels take {padded * height} bytes, and there are {len(pixels)}")
    content = b"".join(pixels[begin : begin + row] for begin in range(0, size, padded))
    match CODES[code]:
        case b"dec":
            return ".float", "dec", struct.pack("<QQ", height, width) + content
        case b"rgb":
            return ".ppm", "rgb", b"P6\n%d %d\n255\n" % (width, height) + content
        case _:
            return ".pgm", "mono", b"P5\n%d %d\n255\n" % (width, height) + content


def _netpbm(data: bytes) -> tuple[bytes, int, int, bytes]:
    found = NETPBM.match(data)
    if found is None:
        raise ImageError("it is no PPM or PGM file of 255 steps")
    return b"rgb" if found[1] == b"6" else b"mono", int(found[2]), int(found[3]), data[found.end() :]


def _floats(data: bytes, *, compressed: bool) -> tuple[bytes, int, int, bytes]:
    if len(data) < 16:
        raise ImageError("it is cut short")
    height, width = struct.unpack_from("<QQ", data)
    if width * height > MAX_PIXELS:
        raise ImageError(f"{width} by {height} pixels are too many")
    pixels = data[16:]
    if compressed:
        try:
            pixels = zlib.decompressobj().decompress(pixels, width * height * 4 or 1)
        except zlib.error as error:
            raise ImageError(str(error)) from error
    return b"dec", width, height, pixels


def _pillow(path: Path) -> tuple[bytes, int, int, bytes]:
    try:
        image: Any = import_module("PIL.Image")
    except ImportError:
        raise LogError((words.needs(str(path), "pillow", "images"),)) from None
    try:
        with image.open(path) as opened:
            code = b"mono" if opened.mode == "L" else b"rgb"
            pixels = opened.convert("L" if code == b"mono" else "RGB")
            return code, pixels.width, pixels.height, pixels.tobytes()
    except (image.DecompressionBombError, SyntaxError, ValueError) as error:
        raise ImageError(str(error)) from error
