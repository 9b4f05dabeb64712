"""Pixels out of the bytes of an image, as frameworks describe them: rows with padding, channels in some order, planes; and as PNG."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

from rosetta_jit.runtime.limits import MAX_SHOWN_SIDE

if TYPE_CHECKING:
    from numpy.typing import DTypeLike, NDArray


def interleaved(data: bytes, shape: tuple[int, int, int], row_bytes: int, dtype: DTypeLike, order: tuple[int, ...] = ()) -> Any:
    """Rows of so many bytes, of pixels whose channels are taken in an order; None where the bytes are too few, or the size makes no sense.

    Parameters
    ----------
    shape
        Height, width and channels.

    Returns
    -------
    ndarray of uint8 or None
        Shape (height, width) for one channel, (height, width, channels) otherwise; numbers of other types become grey values.
    """
    height, width, channels = shape
    type_ = np.dtype(dtype)
    used = width * channels * type_.itemsize
    if not (0 < height <= MAX_SHOWN_SIDE and 0 < width <= MAX_SHOWN_SIDE and 0 < channels <= 4 and used <= row_bytes):
        return None
    if len(data) < (height - 1) * row_bytes + used:
        return None
    rows = np.ndarray((height, used), np.uint8, data, strides=(row_bytes, 1))
    return shown(np.ascontiguousarray(rows).view(type_).reshape(height, width, channels), order)


def planar(data: bytes, shape: tuple[int, int, int], dtype: DTypeLike, order: tuple[int, ...] = ()) -> Any:
    """The same of planes, one for each channel, without padding."""
    height, width, channels = shape
    type_ = np.dtype(dtype)
    if not (0 < height <= MAX_SHOWN_SIDE and 0 < width <= MAX_SHOWN_SIDE and 0 < channels <= 4):
        return None
    if len(data) < height * width * channels * type_.itemsize:
        return None
    planes = np.frombuffer(data, type_, height * width * channels).reshape(channels, height, width)
    return shown(planes.transpose(1, 2, 0), order)


def shown(pixels: NDArray[Any], order: tuple[int, ...]) -> Any:
    """Channels in their order, 8 bits each; two channels are shown as the first of them."""
    taken = pixels[:, :, list(order)] if order else pixels
    if taken.shape[2] not in (1, 3, 4):
        taken = taken[:, :, :1]
    taken = taken if taken.dtype == np.uint8 else eight_bits(taken)
    return taken[:, :, 0] if taken.shape[2] == 1 else taken


SIGNATURE = b"\x89PNG\r\n\x1a\n"
COLOR_TYPES = {1: 0, 3: 2, 4: 6}
"""Grey, RGB and RGBA by the number of channels."""
FASTEST = 1


def png(pixels: NDArray[np.uint8]) -> bytes:
    """An image of shape (height, width) or (height, width, channels) with 1, 3 or 4 channels of 8 bits, as PNG.

    PNG specification, third edition: 5.3 chunks, 11.2 IHDR, IDAT and IEND.
    """
    height, width = pixels.shape[:2]
    channels = pixels.shape[2] if pixels.ndim == 3 else 1
    rows = np.zeros((height, 1 + width * channels), np.uint8)  # each row begins with its filter: 0, none
    rows[:, 1:] = pixels.reshape(height, -1)
    header = struct.pack(">2I5B", width, height, 8, COLOR_TYPES[channels], 0, 0, 0)
    return SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", zlib.compress(rows.tobytes(), FASTEST)) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def eight_bits(values: NDArray[Any]) -> NDArray[np.uint8]:
    """Numbers of any kind as grey values between their least and their greatest; what is no number is black."""
    numbers = np.where(np.isfinite(values), values, np.nan).astype(np.float64)
    known = numbers[~np.isnan(numbers)]
    if not known.size or known.min() == known.max():
        return np.zeros(values.shape, np.uint8)
    return np.nan_to_num((numbers - known.min()) * (255.0 / (known.max() - known.min()))).astype(np.uint8)
