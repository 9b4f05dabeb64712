"""A sealed file: bytes that prove, when read again, that they are whole and are what their name says.

    file    = magic, length of payload (u64), SHA-256 of name and payload, payload
    payload = length of header (u32), header (a dict of plain values, as `marshal` writes it), image

All integers are little-endian. The digest covers the name, so that a file copied over another one is as damaged as a cut one; nothing is
read of a file whose digest is another one. `marshal` makes plain values and runs nothing; JSON would have to be imported by each process.
"""

from __future__ import annotations

import marshal
import struct
from collections.abc import Mapping
from typing import cast

from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.sha import sha256

MAGIC = b"rosetta\x02"
"""The last byte is the version of this format."""

VALUES_ALONE = 2
"""The version of `marshal` that writes no references: equal headers are the same bytes, whatever objects they share."""

_PREFIX = struct.Struct("<8sQ32s")
_HEADER_SIZE = struct.Struct("<I")


class DamagedError(ValueError):
    """Bytes that are not a whole sealed file of the expected name; never leaves the cache."""


@dataclass(frozen=True, slots=True)
class Entry:
    """What the cache keeps of one program: a header of plain values and the object code."""

    header: dict[str, object]
    image: bytes


def seal(name: str, header: Mapping[str, object], image: bytes) -> bytes:
    """The bytes of a file; ``header`` holds None, bools, numbers, texts, and lists, tuples and dicts of these, and keeps its order."""
    text = marshal.dumps(dict(header), VALUES_ALONE)
    payload = _HEADER_SIZE.pack(len(text)) + text + image
    return _PREFIX.pack(MAGIC, len(payload), _digest(name, payload)) + payload


def unseal(name: str, data: bytes) -> Entry:
    """The content of a file, or `DamagedError` with the reason."""
    if len(data) < _PREFIX.size:
        raise DamagedError("it is cut short")
    magic, size, digest = cast("tuple[bytes, int, bytes]", _PREFIX.unpack_from(data))
    payload = data[_PREFIX.size :]
    if magic != MAGIC:
        raise DamagedError("it is not a cache file of this version")
    if size != len(payload):
        raise DamagedError(f"it has {len(payload)} bytes of {size}")
    if digest != _digest(name, payload):
        raise DamagedError("its digest does not match")
    return _open(payload)


def _open(payload: bytes) -> Entry:
    if len(payload) < _HEADER_SIZE.size:
        raise DamagedError("it has no header")
    (size,) = cast("tuple[int]", _HEADER_SIZE.unpack_from(payload))
    text, image = payload[_HEADER_SIZE.size :][:size], payload[_HEADER_SIZE.size + size :]
    try:
        header = cast("object", marshal.loads(text))  # noqa: S302 - its digest is the one that was written with it
    except (EOFError, ValueError, TypeError) as error:
        raise DamagedError("its header cannot be read") from error
    if not isinstance(header, dict):
        raise DamagedError("its header is no dict")
    return Entry(cast("dict[str, object]", header), image)


def _digest(name: str, payload: bytes) -> bytes:
    digest = sha256(name.encode() + b"\0")
    digest.update(payload)
    return digest.digest()
