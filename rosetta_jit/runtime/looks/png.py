"""Pixels as PNG, by the standard library alone (PNG specification, third edition: 5.3 chunks, 11.2 IHDR, IDAT and IEND)."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

SIGNATURE = b"\x89PNG\r\n\x1a\n"
COLOR_TYPES = {1: 0, 3: 2, 4: 6}
"""Grey, RGB and RGBA by the number of channels."""
FASTEST = 1


def png(pixels: NDArray[np.uint8]) -> bytes:
    """An image of shape (height, width) or (height, width, channels) with 1, 3 or 4 channels of 8 bits."""
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
