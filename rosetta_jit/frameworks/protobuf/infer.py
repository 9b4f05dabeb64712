"""Drafts a `.proto` file from captured messages: their field numbers and wire types, and what the values suggest.

The bytes of protobuf (https://protobuf.dev/programming-guides/encoding) say of each field its number and one of four wire types. What a
length-delimited field is, a text, a message, packed numbers or bytes, is a guess that has to hold for all occurrences in all messages.
"""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Iterable, Iterator

from rosetta_jit.errors import DecodeError, SchemaError
from rosetta_jit.frameworks.protobuf import diagnostics as words
from rosetta_jit.frameworks.protobuf.limits import MAX_INFERRED_DEPTH, MAX_INFERRED_FIELDS
from rosetta_jit.startup.dataclass import dataclass, field

VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5
WIRE_TYPES = {VARINT: "varint", FIXED64: "64 bits", BYTES: "length-delimited", FIXED32: "32 bits"}

NAME = re.compile(r"([A-Za-z_]\w*\.)*[A-Za-z_]\w*")
VARINT_BYTES = 10


@dataclass(slots=True)
class Seen:
    """What all occurrences of a field have in common."""

    wire: int
    values: list[int | bytes] = field(default_factory=list["int | bytes"])
    most: int = 0
    messages: int = 0


def infer(messages: Iterable[bytes], *, name: str, encoding: str = "protobuf") -> str:
    """A `.proto` file with a message type that describes every one of the messages, as text.

    Parameters
    ----------
    messages
        One message each, of at least one message in all.
    name
        Of the message type, with its package.
    encoding
        ``protobuf``; it is one for all frameworks that draft schemas.

    Raises
    ------
    DecodeError
        Where one is no message of protobuf; the detail says which.
    SchemaError
        Where a field has several wire types, with the field, or there is no message, or too many fields.
    """
    del encoding
    if not NAME.fullmatch(name):
        raise SchemaError((words.invalid_name(name),))
    captured = list(messages)
    if not captured:
        raise SchemaError((words.no_messages(),))
    fields: dict[int, Seen] = {}
    for number, message in enumerate(captured, 1):
        try:
            _look(message, fields)
        except _NoMessageError as error:
            raise DecodeError(error.kind, "", f"message {number}: {error}", error.offset) from None
        except _UnlikeError as error:
            raise SchemaError((words.unlike(number, error.field, *error.wires),)) from None
    package, _, own = name.rpartition(".")
    count = f"{len(captured)} message{'' if len(captured) == 1 else 's'}"
    lines = [f"// Drafted from {count}. Names are numbers, and types are guesses: comments say what was seen."]
    lines += ['syntax = "proto2";', *([f"package {package};"] if package else []), "", *_declared(own, fields, len(captured), 0)]
    return "\n".join(lines) + "\n"


class _NoMessageError(Exception):
    """Bytes that are no message."""

    def __init__(self, kind: str, detail: str, offset: int) -> None:
        super().__init__(detail)
        self.kind: words.Kind = "tag" if kind == "tag" else "varint" if kind == "varint" else "truncated"
        self.offset = offset


class _UnlikeError(Exception):
    """A field of several wire types."""

    def __init__(self, number: int, wires: tuple[str, str]) -> None:
        super().__init__(number)
        self.field, self.wires = number, wires


def _look(message: bytes, fields: dict[int, Seen]) -> None:
    """Add what one message has to what is known of its type."""
    counts: dict[int, int] = {}
    for number, wire, value in _parts(bytes(message)):
        seen = fields.setdefault(number, Seen(wire))
        if seen.wire != wire:
            raise _UnlikeError(number, (WIRE_TYPES[seen.wire], WIRE_TYPES[wire]))
        if len(fields) > MAX_INFERRED_FIELDS:
            raise SchemaError((words.too_many_fields(MAX_INFERRED_FIELDS),))
        seen.values.append(value)
        counts[number] = counts.get(number, 0) + 1
    for number, count in counts.items():
        fields[number].most = max(fields[number].most, count)
        fields[number].messages += 1


def _parts(data: bytes) -> Iterator[tuple[int, int, int | bytes]]:
    """Number, wire type and value of each field of a message."""
    at = 0
    while at < len(data):
        begin = at
        tag, at = _varint(data, at)
        number, wire = tag >> 3, tag & 7
        if not 0 < number < 1 << 29:
            raise _NoMessageError("tag", f"a field has the number {number}", begin)
        if wire not in WIRE_TYPES:
            why = f"field {number} is a group" if wire in {3, 4} else f"field {number} has the wire type {wire}, which there is not"
            raise _NoMessageError("tag", why, begin)
        if wire == VARINT:
            value, at = _varint(data, at)
            yield number, wire, value
            continue
        size = {FIXED64: 8, FIXED32: 4}.get(wire)
        if size is None:
            size, at = _varint(data, at)
        if size > len(data) - at:
            raise _NoMessageError("truncated", f"field {number} has {size} bytes, of which {len(data) - at} are there", begin)
        part = data[at : at + size]
        yield number, wire, part if wire == BYTES else int.from_bytes(part, "little")
        at += size


def _varint(data: bytes, at: int) -> tuple[int, int]:
    value = 0
    for count in range(VARINT_BYTES):
        if at + count >= len(data):
            raise _NoMessageError("truncated", "the message ends within a varint", at)
        byte = data[at + count]
        value |= (byte & 0x7F) << 7 * count
        if byte < 0x80:
            if value >= 1 << 64:
                break
            return value, at + count + 1
    raise _NoMessageError("varint", "a varint has more than 64 bits", at)


def _declared(name: str, fields: dict[int, Seen], messages: int, depth: int) -> list[str]:
    """A message type as text."""
    margin = "  " * depth
    lines = [f"{margin}message {name} {{"]
    for number, seen in sorted(fields.items()):
        label = "repeated" if seen.most > 1 else "optional"
        type_, option, comment = _type(seen, depth)
        if isinstance(type_, dict):
            lines += _declared(f"F{number}", type_, len(seen.values), depth + 1)
            type_ = f"F{number}"
        where = "" if seen.messages == messages else f"; in {seen.messages} of {messages}"
        packed = "repeated" if option else label
        lines.append(f"{margin}  {packed} {type_} f{number} = {number}{option};  // {comment}{where}")
    return [*lines, f"{margin}}}"]


def _type(seen: Seen, depth: int) -> tuple[str | dict[int, Seen], str, str]:
    """The type of a field, its options, and what was seen of it."""
    numbers = [each for each in seen.values if isinstance(each, int)]
    match seen.wire:
        case 0:
            return _of_varints(numbers)
        case 1:
            return _of_fixed(numbers, "double", "<d", "fixed64")
        case 5:
            return _of_fixed(numbers, "float", "<f", "fixed32")
        case _:
            return _of_bytes([each for each in seen.values if isinstance(each, bytes)], seen.most, depth)


def _of_varints(values: list[int]) -> tuple[str, str, str]:
    low, high = min(values), max(values)
    if high >= 1 << 63:
        return "int64", "", _range(min(map(_signed, values)), max(map(_signed, values)))
    if high <= 1:
        return "bool", "", f"{_range(low, high)}: a bool, an enum or an integer"
    return "int64", "", f"{_range(low, high)}: an integer or an enum"


def _range(low: float, high: float) -> str:
    """What was seen, from the least to the greatest."""
    least, most = (f"{each:g}" if isinstance(each, float) else str(each) for each in (low, high))
    return least if least == most else f"{least} to {most}"


def _signed(value: int) -> int:
    return value - (1 << 64) if value >= 1 << 63 else value


def _of_fixed(values: list[int], name: str, format_: str, otherwise: str) -> tuple[str, str, str]:
    size = struct.calcsize(format_)
    floats = [struct.unpack(format_, each.to_bytes(size, "little"))[0] for each in values]
    if all(map(_is_likely, floats)):
        return name, "", _range(min(floats), max(floats))
    return otherwise, "", f"{_range(min(values), max(values))}: no likely {name}"


def _is_likely(value: float) -> bool:
    """Whether a number is one that somebody measures."""
    return value == 0 or (math.isfinite(value) and 1e-12 < abs(value) < 1e15)


def _of_bytes(values: list[bytes], most: int, depth: int) -> tuple[str | dict[int, Seen], str, str]:
    """A text, a message, packed numbers, or bytes: the first that all occurrences can be."""
    sizes = f"{_range(min(map(len, values)), max(map(len, values)))} bytes"
    full = [each for each in values if each]
    if not full:
        return "bytes", "", "always empty: a text, a message, or bytes"
    if all(map(_is_text, full)):
        return "string", "", sizes
    inner = _message(values) if depth < MAX_INFERRED_DEPTH else None
    if inner:
        return inner, "", sizes
    if most == 1:
        for name, size in (("double", 8), ("float", 4)):
            if all(len(each) % size == 0 for each in full) and any(len(each) > size for each in full) and _are_likely(full, size):
                return name, " [packed = true]", f"{sizes}, as packed numbers"
    return "bytes", "", sizes


def _is_text(data: bytes) -> bool:
    try:
        text = data.decode()
    except UnicodeDecodeError:
        return False
    return all(each.isprintable() or each in "\n\r\t" for each in text)


def _message(values: list[bytes]) -> dict[int, Seen]:
    """What the values are as messages of one type; nothing where they are none."""
    fields: dict[int, Seen] = {}
    try:
        for each in values:
            _look(each, fields)
    except (_NoMessageError, _UnlikeError, SchemaError):
        return {}
    return fields


def _are_likely(values: list[bytes], size: int) -> bool:
    format_ = "d" if size == 8 else "f"
    return all(_is_likely(number) for each in values for (number,) in struct.iter_unpack(f"<{format_}", each))
