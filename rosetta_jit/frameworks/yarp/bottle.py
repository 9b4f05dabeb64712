"""Bottles without a schema, read from and written to the bytes of one dialect.

    bottle  = code body               code = 256 + the unit's code, 0 for a general list
    body    = count, { code value }   in a general list
            | count, { value }        in a specialised one
    value   = a fixed number of bytes | length, bytes | body | bottle (of a dict)

This is os/impl/BottleImpl.cpp's format. Reading is strict where YARP is not: exact consumption, known codes alone, no
negative count, and bounded nesting.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from typing import assert_never

from rosetta_jit.errors import DecodeError, EncodeError, Kind
from rosetta_jit.frameworks.yarp.limits import MAX_NESTING
from rosetta_jit.frameworks.yarp.tags import DICT, FIXED_FORMATS, Dialect, list_code, list_units
from rosetta_jit.frameworks.yarp.tree import Dict, Item, List, Path, Value, narrow, path_text, widen
from rosetta_jit.startup.dataclass import dataclass

MIN_ITEM_BYTES = 5
"""The least that an item of a general list takes: a code and one byte."""


def read(data: bytes, dialect: Dialect) -> List:
    """The bottle that ``data`` is, all of it.

    Takes time and memory linear in ``len(data)``, whatever the counts in it say.

    Raises
    ------
    DecodeError
        With ``path`` as indices (``[2][0]``) and the byte offset.
    """
    message = _Message(data, dialect, {code: tag for tag, code in dialect.tags.items()}, list_units(dialect))
    bottle, end = _read_bottle(message, 0, ())
    if end != len(data):
        raise _malformed("trailing", (), f"{len(data) - end} bytes are left over", end)
    return bottle


def write(bottle: List, dialect: Dialect) -> bytes:
    """The bytes of a bottle; each list in the form that the tree says.

    Raises
    ------
    EncodeError
        For a type that the dialect does not have, a value out of range, an item that is not of its list's unit, or
        nesting beyond the limit.
    """
    chunks: list[bytes] = []
    _write_bottle(bottle, dialect, chunks, ())
    return b"".join(chunks)


@dataclass(frozen=True, slots=True)
class _Message:
    data: bytes
    dialect: Dialect
    tags: Mapping[int, str]
    units: Mapping[int, str | None]

    def require(self, size: int, at: int, path: Path) -> None:
        if size > len(self.data) - at:
            raise _malformed("truncated", path, f"{size} bytes are needed, {len(self.data) - at} are left", at)

    def int32(self, at: int, path: Path) -> int:
        self.require(4, at, path)
        return int.from_bytes(self.data[at : at + 4], "little", signed=True)


def _malformed(kind: Kind, path: Path, detail: str, at: int) -> DecodeError:
    return DecodeError(kind, path_text(path), detail, at)


def _read_bottle(message: _Message, at: int, path: Path) -> tuple[List, int]:
    code = message.int32(at, path)
    if code not in message.units:
        raise _malformed("tag", path, f"{code} is not the code of a bottle", at)
    return _read_body(message, message.units[code], at + 4, path)


def _read_body(message: _Message, unit: str | None, at: int, path: Path) -> tuple[List, int]:
    count = message.int32(at, path)
    if count < 0:
        raise _malformed("count", path, f"a list cannot have {count} elements", at)
    at += 4
    if unit is not None and unit in FIXED_FORMATS:
        return _read_fixed(message, unit, count, at, path)
    message.require(count * (MIN_ITEM_BYTES if unit is None else 4), at, path)
    items: list[Item] = []
    for index in range(count):
        if unit is None:
            item, at = _read_item(message, at, (*path, index))
        else:
            item, at = _read_octets(message, unit, at, (*path, index))
        items.append(item)
    return List(tuple(items), unit), at


def _read_item(message: _Message, at: int, path: Path) -> tuple[Item, int]:
    code = message.int32(at, path)
    tag = message.tags.get(code)
    if tag is not None and tag in FIXED_FORMATS:
        values, end = _read_fixed(message, tag, 1, at + 4, path)
        return values.items[0], end
    if tag is not None:
        return _read_octets(message, tag, at + 4, path)
    if code not in message.units and code != DICT:
        raise _malformed("tag", path, f"{code} is the code of no type in {message.dialect.name}", at)
    if len(path) > MAX_NESTING:
        raise _malformed("nesting", path, f"lists are nested deeper than {MAX_NESTING}", at)
    if code == DICT:
        content, end = _read_bottle(message, at + 4, path)
        return Dict(content), end
    return _read_body(message, message.units[code], at + 4, path)


def _read_fixed(message: _Message, unit: str, count: int, at: int, path: Path) -> tuple[List, int]:
    layout = FIXED_FORMATS[unit]
    size = count * struct.calcsize(layout)
    message.require(size, at, path)
    numbers: Sequence[int | float]
    if unit == "float32":
        numbers = [widen(bits) for bits in struct.unpack_from(f"<{count}I", message.data, at)]
    else:
        numbers = struct.unpack_from(f"<{count}{layout}", message.data, at)
    return List(tuple(Value(unit, number) for number in numbers), unit), at + size


def _read_octets(message: _Message, tag: str, at: int, path: Path) -> tuple[Value, int]:
    size = message.int32(at, path)
    terminated = tag == "string" and message.dialect.nul_terminated
    if size < int(terminated):
        raise _malformed("length", path, f"a {tag} cannot have a length of {size}", at)
    message.require(size, at + 4, path)
    octets = message.data[at + 4 : at + 4 + size]
    if terminated and octets[-1]:
        raise _malformed("constant", path, "the string does not end with a NUL", at + 3 + size)
    return Value(tag, octets[:-1] if terminated else octets), at + 4 + size


def _write_bottle(bottle: List, dialect: Dialect, chunks: list[bytes], path: Path) -> None:
    chunks.append(_list_head(bottle, dialect, path))
    _write_body(bottle, dialect, chunks, path)


def _write_body(bottle: List, dialect: Dialect, chunks: list[bytes], path: Path) -> None:
    if len(path) > MAX_NESTING:
        raise EncodeError("nesting", path_text(path), f"lists are nested deeper than {MAX_NESTING}")
    chunks.append(struct.pack("<i", len(bottle.items)))
    for index, item in enumerate(bottle.items):
        _write_item(item, bottle.unit, dialect, chunks, (*path, index))


def _write_item(item: Item, unit: str | None, dialect: Dialect, chunks: list[bytes], path: Path) -> None:
    if unit is not None and not (isinstance(item, Value) and item.tag == unit):
        raise EncodeError("tag", path_text(path), f"the list is specialised to {unit}")
    match item:
        case Value(tag):
            if tag not in dialect.tags:
                raise EncodeError("tag", path_text(path), f"{dialect.name} has no {tag}")
            if unit is None:
                chunks.append(struct.pack("<i", dialect.tags[tag]))
            chunks.append(_value_bytes(item, dialect, path))
        case List():
            chunks.append(_list_head(item, dialect, path))
            _write_body(item, dialect, chunks, path)
        case Dict(content):
            chunks.append(struct.pack("<i", DICT))
            _write_bottle(content, dialect, chunks, path)
        case _:
            assert_never(item)


def _list_head(bottle: List, dialect: Dialect, path: Path) -> bytes:
    if bottle.unit is not None and bottle.unit not in dialect.tags:
        raise EncodeError("tag", path_text(path), f"{dialect.name} has no {bottle.unit}")
    return struct.pack("<i", list_code(dialect, bottle.unit))


def _value_bytes(item: Value, dialect: Dialect, path: Path) -> bytes:
    layout = FIXED_FORMATS.get(item.tag)
    match item.value:
        case bytes(octets) if layout is None:
            stored = octets + b"\0" if item.tag == "string" and dialect.nul_terminated else octets
            return struct.pack("<i", len(stored)) + stored
        case int() | float() if layout is not None:
            try:
                return narrow(item.value) if item.tag == "float32" else struct.pack(f"<{layout}", item.value)
            except (struct.error, OverflowError):
                raise EncodeError("range", path_text(path), f"{item.value!r} is no value of {item.tag}") from None
        case _:
            raise EncodeError("tag", path_text(path), f"{type(item.value).__name__} is no value of {item.tag}")
