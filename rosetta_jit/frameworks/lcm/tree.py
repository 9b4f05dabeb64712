"""A `.lcm` file as it was written; nothing is looked up yet.

File      = Declaration*                      Declaration = StructDeclaration | EnumDeclaration
StructDeclaration = package, Name, Item*      Item   = Member | Constant
EnumDeclaration   = package, Name, Word*      Word   = Name, number?
Member    = type, Name, size*                 Constant = type, Name, value
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.source import Source, Span


@dataclass(frozen=True, slots=True)
class Name:
    """A word of the text, and where it stands: a name, or a number as it was written."""

    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class Member:
    """A field. ``sizes`` are numbers and names, from the outermost dimension to the innermost."""

    type: Name
    name: Name
    sizes: tuple[Name, ...]
    doc: str


@dataclass(frozen=True, slots=True)
class Constant:
    """A named number of a struct."""

    type: Name
    name: Name
    value: Name
    doc: str


Item = Member | Constant


@dataclass(frozen=True, slots=True)
class StructDeclaration:
    """A struct; ``package`` is that of the text around it, whatever the name says."""

    package: str
    name: Name
    items: tuple[Item, ...]
    doc: str


@dataclass(frozen=True, slots=True)
class Word:
    """An enumerator; without a number of its own it has one more than the largest before it."""

    name: Name
    number: Name | None


@dataclass(frozen=True, slots=True)
class EnumDeclaration:
    """An enum."""

    package: str
    name: Name
    words: tuple[Word, ...]


Declaration = StructDeclaration | EnumDeclaration


@dataclass(frozen=True, slots=True)
class File:
    """The declarations of a source, in order."""

    source: Source
    declarations: tuple[Declaration, ...]


def qualified(package: str, name: str) -> str:
    """The name of a type that is written in a package: one without a dot is of the package itself."""
    return f"{package}.{name}" if package and "." not in name else name
