"""The types of single values. `rosetta_jit.model.types` has all types, these among them.

They contain no expressions, and so expressions can name them: the type of a parameter, the width of an integer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.source import Span


@dataclass(frozen=True, slots=True)
class Bool:
    """True or false; one byte in a holder."""

    spelling: str = ""


@dataclass(frozen=True, slots=True)
class Int:
    """A two's complement or unsigned integer."""

    bits: Literal[8, 16, 32, 64]
    signed: bool = True
    spelling: str = ""


@dataclass(frozen=True, slots=True)
class Float:
    """An IEEE 754 number."""

    bits: Literal[32, 64]
    spelling: str = ""


@dataclass(frozen=True, slots=True)
class String:
    """Text. ``octets`` promises nothing about its bytes (YARP); ``utf-8`` is checked when it is read; ``utf-16`` is kept in code units.

    ``maximum`` bounds its length: bytes, or code units.
    """

    encoding: Literal["utf-8", "octets", "utf-16"] = "utf-8"
    spelling: str = ""
    maximum: int | None = None


@dataclass(frozen=True, slots=True)
class Enum:
    """Named integers. A closed one (proto2) holds no other number than those. ``bits`` is the width that the IDL gives it."""

    name: str
    values: tuple[tuple[str, int], ...]
    closed: bool = True
    span: Span | None = field(default=None, compare=False, repr=False)
    bits: Literal[8, 16, 32] = 32


Scalar = Bool | Int | Float | String | Enum
