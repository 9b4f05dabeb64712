"""A `.msg` text as it is written.

Definition = name, Constant*, Field*      one message
Constant   = TypeName, Word, value        Field = TypeName, Word, default
"""

from __future__ import annotations

from rosetta_jit.model.types import Constant as Value
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

Values = tuple["bool | int | float | str", ...]


@dataclass(frozen=True, slots=True)
class Word:
    """Characters of a text, and where they are."""

    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class TypeName:
    """The type of a field or constant.

    Attributes
    ----------
    written
        As it stands in the text, for the md5 sum.
    base
        The builtin word, or the qualified name of a message.
    text_maximum
        The bound of a string.
    """

    written: str
    base: str
    span: Span
    builtin: bool
    array: bool = False
    length: int | None = None
    maximum: int | None = None
    text_maximum: int | None = None


@dataclass(frozen=True, slots=True)
class Constant:
    """A constant; ``text`` is its value as written."""

    type: TypeName
    name: Word
    text: Word
    value: Value
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Field:
    """A field, with the value or the values of an array that it has if nobody sets it."""

    type: TypeName
    name: Word
    default: Value | Values | None = None
    optional: bool = False
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Definition:
    """A message: its qualified name, its package, and its own text."""

    name: str
    package: str
    source: Source
    span: Span
    text: str
    constants: tuple[Constant, ...] = ()
    fields: tuple[Field, ...] = ()
    doc: str = ""
