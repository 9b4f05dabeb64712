"""Object files as compilers write them on Linux: ELF-64, little-endian (System V ABI, chapter 4).

What is read may be damaged: then it is a `ForeignCodeError`, and nothing else.
"""

from __future__ import annotations

import struct
import sys
from collections.abc import Iterator

from rosetta_jit.runtime.code.allowed import ForeignCodeError
from rosetta_jit.startup.dataclass import dataclass

MAGIC = b"\x7fELF"
X86_64 = 62
UNDEFINED = 0
"""The section of symbols that an object takes from elsewhere."""

SYMBOLS, RELOCATIONS, NO_BITS, NOTE, UNWIND = 2, 4, 8, 7, 0x70000001
"""Kinds of sections (sh_type)."""

WRITABLE, IN_MEMORY, EXECUTABLE, THREAD_LOCAL = 1, 2, 4, 0x400
"""Flags of sections (sh_flags)."""

_GLOBAL = 1
_HEADER, _SYMBOL, _RELOCATION = struct.Struct("<IIQQQQIIQQ"), struct.Struct("<IBBHQQ"), struct.Struct("<QQq")


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a program. ``link`` and ``info`` are numbers of other sections, in a meaning of their own for each kind."""

    kind: int
    flags: int
    content: bytes
    size: int
    link: int
    info: int
    alignment: int


@dataclass(frozen=True, slots=True)
class Symbol:
    """A name for a place in a section; a local one may have none."""

    name: str
    section: int
    value: int
    is_global: bool


@dataclass(frozen=True, slots=True)
class Relocation:
    """A place in a section that depends on where a symbol will lie."""

    section: int
    offset: int
    kind: int
    symbol: int
    addend: int


@dataclass(frozen=True, slots=True)
class ObjectFile:
    """Sections and symbols by their numbers."""

    machine: int
    sections: tuple[Section, ...]
    symbols: tuple[Symbol, ...]
    relocations: tuple[Relocation, ...]


def undefined_symbols(image: bytes) -> frozenset[str]:
    """The names that an object file takes from elsewhere. Those of other systems than Linux are not examined."""
    if not image.startswith(MAGIC) and sys.platform != "linux":
        return frozenset()
    return frozenset(each.name for each in read(image).symbols if each.section == UNDEFINED and each.name)


def read(image: bytes) -> ObjectFile:
    """The object file, or ForeignCodeError."""
    if not image.startswith(MAGIC):
        raise ForeignCodeError("no ELF object file")
    try:
        (machine,) = struct.unpack_from("<H", image, 0x12)
        sections = tuple(_sections(image))
        tables = [each for each in sections if each.kind == SYMBOLS]
        if len(tables) != 1:
            raise ForeignCodeError("an object file without symbols")
        symbols = tuple(_symbols(tables[0].content, sections[tables[0].link].content))
        return ObjectFile(machine, sections, symbols, tuple(_relocations(sections)))
    except (struct.error, IndexError, OverflowError) as error:
        raise ForeignCodeError("a damaged object file") from error


def _sections(image: bytes) -> Iterator[Section]:
    (start,) = struct.unpack_from("<Q", image, 0x28)
    (number,) = struct.unpack_from("<H", image, 0x3C)
    for index in range(number):
        _, kind, flags, _, at, size, link, info, alignment, _ = _HEADER.unpack_from(image, start + _HEADER.size * index)
        content = b"" if kind == NO_BITS else image[at : at + size]
        if kind != NO_BITS and len(content) != size:
            raise ForeignCodeError("a damaged object file")
        yield Section(kind, flags, content, size, link, info, max(alignment, 1))


def _symbols(table: bytes, names: bytes) -> Iterator[Symbol]:
    for name, info, _, section, value, _ in _SYMBOL.iter_unpack(table):
        yield Symbol(names[name : names.find(b"\0", name)].decode("latin-1"), section, value, info >> 4 == _GLOBAL)


def _relocations(sections: tuple[Section, ...]) -> Iterator[Relocation]:
    for table in sections:
        if table.kind == RELOCATIONS:
            for offset, info, addend in _RELOCATION.iter_unpack(table.content):
                yield Relocation(table.info, offset, info & 0xFFFFFFFF, info >> 32, addend)
