"""Messages as text, as `str` of protobuf's Python messages prints them: fields by number, one a line, messages in braces.

https://protobuf.dev/reference/protobuf/textformat-spec/
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, assert_never

import numpy as np

from rosetta_jit.frameworks.protobuf.presence import set_entries
from rosetta_jit.model.types import Enum, Float
from rosetta_jit.runtime.holder.record import Blob, Child, Items, Node, Numbers, Pairs, Record, Scalar, ScalarType, Text

_ESCAPES = {"\n": "\\n", "\r": "\\r", "\t": "\\t", '"': '\\"', "'": "\\'", "\\": "\\\\"}


def text(record: Record, values: Mapping[str, Any]) -> str:
    """The text of a message, given its raw values."""
    return "".join(f"{line}\n" for line in _message(record, values))


def _message(record: Record, values: Mapping[str, Any]) -> Iterator[str]:
    for entry, value in set_entries(record, values):
        yield from _value(entry.name, entry.node, value)


def _value(label: str, node: Node, value: Any) -> Iterator[str]:
    match node:
        case Scalar(_, type_):
            yield f"{label}: {_scalar(type_, value)}"
        case Text() | Blob():
            yield f"{label}: {_quoted(value)}"
        case Numbers(_, _, type_, _):
            yield from (f"{label}: {_scalar(type_, each)}" for each in value.tolist())
        case Items(_, _, element, _):
            for each in value:
                yield from _value(label, element, each)
        case Pairs(_, _, _, key, entry):
            for each in sorted(value):
                yield from _braced(label, [*_value("key", key, each), *_value("value", entry.node, value[each])])
        case Record() | Child():
            yield from _braced(label, _message(node.record if isinstance(node, Child) else node, value))
        case _:
            assert_never(node)


def _braced(label: str, lines: Any) -> Iterator[str]:
    yield f"{label} {{"
    yield from (f"  {line}" for line in lines)
    yield "}"


def _scalar(type_: ScalarType, value: Any) -> str:
    match type_:
        case Enum(_, values, _):
            return next((name for name, number in values if number == value), str(value))
        case Float(bits, _):
            return _float(float(value), bits)
        case _:
            return str(value).lower()


def _float(value: float, bits: int) -> str:
    """As few digits as a C library prints to read the same value again: 6 or 9 of a float, 15 or 17 of a double."""
    few, enough = (6, 9) if bits == 32 else (15, 17)
    short = f"{value:.{few}g}"
    with np.errstate(over="ignore"):
        again = float(np.float32(short)) if bits == 32 else float(short)
    return short if again == value or math.isnan(value) else f"{value:.{enough}g}"


def _quoted(value: str | bytes) -> str:
    """In quotes; what is not printable ASCII in octal, but for the letters of a string."""
    letters = isinstance(value, str)
    chars = value if isinstance(value, str) else value.decode("latin-1")
    return '"' + "".join(_ESCAPES.get(char) or _printable(char, letters=letters) for char in chars) + '"'


def _printable(char: str, *, letters: bool) -> str:
    return char if " " <= char <= "~" or (letters and ord(char) >= 0x80) else f"\\{ord(char):03o}"
