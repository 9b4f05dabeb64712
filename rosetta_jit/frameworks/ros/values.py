"""The values of constants and defaults: how they are written, and what they are."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros.dialect import Dialect
from rosetta_jit.frameworks.ros.limits import MAX_DIGITS
from rosetta_jit.frameworks.ros.tree import TypeName, Values
from rosetta_jit.model.types import Bool, Float, Int, String

if TYPE_CHECKING:
    from rosetta_jit.frameworks.ros.dialect import Scalar

    Value = bool | int | float | str

FLOAT = re.compile(r"[+-]?(?:(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|inf|infinity|nan)", re.IGNORECASE)
PYTHON_INTEGER, ZERO = re.compile(r"[+-]?(?:0+|[1-9][0-9]*)"), re.compile(r"[+-]?0+")
ELEMENT = re.compile(r""" *("(?:\\"|[^"])*"|'(?:\\'|[^'])*'|[^,"' ][^,]*) *(?:,|$)""")
"""An element of an array of strings, and the comma behind it."""


def scalar_value(text: str, type_: Scalar, dialect: Dialect) -> Value | None:
    """The value that a text is of a scalar type, None if it is none."""
    match type_:
        case Bool():
            return _truth(text, dialect)
        case Int(bits, signed):
            number = int(text, 0 if _prefixed(text) else 10) if len(text) <= MAX_DIGITS and dialect.integers.fullmatch(text) else None
            low, high = _range(bits, signed=signed)
            return number if number is not None and low <= number <= high else None
        case Float():
            return float(text) if FLOAT.fullmatch(text) else None
        case String(_, _, maximum):
            value = _unquoted(text) if dialect.extended else text
            return value if value is None or maximum is None or len(value) <= maximum else None


def wanted(type_: TypeName, element: Scalar, dialect: Dialect) -> str:
    """The values of a type, in words, for errors."""
    if type_.array:
        number = type_.length if type_.maximum is None else f"at most {type_.maximum}"
        return f"{'values' if number is None else f'{number} of them'} in brackets, each {_wanted(element, dialect)}"
    return _wanted(element, dialect)


def _wanted(type_: Scalar, dialect: Dialect) -> str:
    match type_:
        case Bool():
            return "true or false" if dialect.extended else "True, False or a number"
        case Int(bits, signed):
            low, high = _range(bits, signed=signed)
            return f"a whole number from {low} to {high}"
        case Float():
            return "a number"
        case String(_, _, maximum):
            return "text whose quotes match" if maximum is None else f"text of at most {maximum} characters"


def array_values(text: str, type_: TypeName, element: Scalar, dialect: Dialect) -> Values | None:
    """The values that a text lists for an array, None if it does not list such or not so many."""
    if not (len(text) > 1 and text.startswith("[") and text.endswith("]")):
        return None
    texts = _strings(text[1:-1]) if isinstance(element, String) else [each.strip() for each in text[1:-1].split(",")] if text[1:-1] else []
    if texts is None or (type_.length is not None and len(texts) != type_.length):
        return None
    if type_.maximum is not None and len(texts) > type_.maximum:
        return None
    values = [scalar_value(each, element, dialect) for each in texts]
    return tuple(each for each in values if each is not None) if None not in values else None


def _range(bits: int, *, signed: bool) -> tuple[int, int]:
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)


def _truth(text: str, dialect: Dialect) -> bool | None:
    """ROS 2 has two words for either, ROS 1 Python's and every integer."""
    if dialect.extended:
        return {"true": True, "1": True, "false": False, "0": False}.get(text.lower())
    if text in ("True", "False"):
        return text == "True"
    return not ZERO.fullmatch(text) if PYTHON_INTEGER.fullmatch(text) else None


def _prefixed(text: str) -> bool:
    return text.lstrip("+-")[1:2].isalpha()


def _unquoted(text: str) -> str | None:
    """A string without its quotes, if it has a pair; within them, another of the same kind has a backslash."""
    quote = text[:1]
    if quote not in ("'", '"') or not text.endswith(quote):
        return text
    inner = text[1:-1]
    if re.search(rf"(?<!\\){quote}", inner):
        return None
    return inner.replace(f"\\{quote}", quote)


def _strings(text: str) -> list[str] | None:
    """The elements of an array of strings: a comma within quotes does not end one."""
    found: list[str] = []
    at = 0
    while at < len(text):
        match = ELEMENT.match(text, at)
        if match is None:
            return None
        found.append(match[1].rstrip())
        at = match.end()
    return found
