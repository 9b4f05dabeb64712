"""A bottle without a schema, as a tree of typed values.

    Bottle = List
    List   = unit or None, Item*      unit: the one scalar type of all items, said once in the list's code
    Dict   = List                     a complete bottle of (key value) lists
    Value  = tag, value
    Item   = Value | List | Dict

The tree says which of its two forms a list has, so that writing gives back the bytes that were read.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from math import isnan

from rosetta_jit.startup.dataclass import dataclass

Path = tuple[int, ...]
"""Where an item is: its index in the bottle, then its index in the list there, and so on."""


@dataclass(frozen=True, slots=True)
class Value:
    """A scalar. ``value`` is an int, a float, or the bytes of a string or blob.

    A NaN keeps its payload; a float32 is held as the float64 of equal value.
    """

    tag: str
    value: int | float | bytes


@dataclass(frozen=True, slots=True)
class List:
    """A list in its general form (``unit`` None, each item with its code) or specialised to one scalar type."""

    items: tuple[Item, ...]
    unit: str | None = None


@dataclass(frozen=True, slots=True)
class Dict:
    """An element that is a complete bottle; a well-formed one holds (key value) lists."""

    content: List


Item = Value | List | Dict


def specialised(items: Iterable[Item]) -> List:
    """The list as YARP writes it: specialised where all items are scalars of one type (`subCoder`, os/impl/Storable.h)."""
    items = tuple(items)
    tags = {item.tag if isinstance(item, Value) else None for item in items}
    return List(items, tags.pop() if len(tags) == 1 else None)


def path_text(path: Path) -> str:
    """A place in a tree as errors name it: ``[2][0]``."""
    return "".join(f"[{index}]" for index in path)


def widen(bits: int) -> float:
    """The float64 of a float32's bits; a NaN keeps its payload and stays signalling, which conversion does not promise."""
    if bits & 0x7FFFFFFF <= 0x7F800000:
        return struct.unpack("<f", struct.pack("<I", bits))[0]
    return struct.unpack("<d", struct.pack("<Q", (bits >> 31) << 63 | 0x7FF << 52 | (bits & 0x7FFFFF) << 29))[0]


def narrow(value: float) -> bytes:
    """A float32 as bytes; inverse of `widen`. Raises OverflowError where the value is too large."""
    if not isnan(value):
        return struct.pack("<f", value)
    bits = struct.unpack("<Q", struct.pack("<d", value))[0]
    payload = (bits >> 29) & 0x7FFFFF or 0x400000
    return struct.pack("<I", (bits >> 63) << 31 | 0xFF << 23 | payload)
