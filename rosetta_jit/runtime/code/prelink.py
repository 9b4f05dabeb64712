"""Prelink: lay out the sections of object files once, when they are compiled, so that no later process needs a linker for them.

    code    executable sections, read-only ones, a jump for each function of the process that is called, the slots
    data    what is written

What is not known here is left to a linker: other processors and systems, kinds of relocation that our code has not.
"""

from __future__ import annotations

import os
import struct
import sys
from collections.abc import Container, Mapping, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.runtime.code import object_file
from rosetta_jit.runtime.code.object_file import (
    EXECUTABLE,
    IN_MEMORY,
    NOTE,
    THREAD_LOCAL,
    UNDEFINED,
    UNWIND,
    WRITABLE,
    X86_64,
    ObjectFile,
    Section,
    Symbol,
)
from rosetta_jit.runtime.code.prelinked import PAGE, Prelinked, data_offset, to_bytes
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    _Key = tuple[int, int]
    """A section: the number of its file, and its number there."""

# System V ABI, AMD64 supplement, 4.4.1: all of them 32 bits, relative to the place itself.
_RELATIVE, _CALL = 2, 4
_SLOTS = (9, 41, 42)

_JUMP, _INDIRECT, _JUMP_BYTES = struct.Struct("<2si2x"), b"\xff\x25", 6
"""``jmp [rip + distance]``, its first bytes, and how long it is: the distance counts from its end."""


class _UnknownError(Exception):
    """Something that is left to a linker; never leaves this module."""


@dataclass(frozen=True, slots=True)
class _Tables:
    """The places of the jumps and the slots, and their order."""

    wants: tuple[str, ...]
    jumps: int
    slots: int

    def jump(self, name: str) -> int:
        return self.jumps + _JUMP.size * self.wants.index(name)

    def slot(self, name: str) -> int:
        return self.slots + 8 * self.wants.index(name)


def is_prelinking() -> bool:
    """Whether code for this machine is prelinked."""
    return sys.platform == "linux" and os.uname().machine == "x86_64"


def prelinked(*images: bytes, gives: Container[str] | None = None) -> bytes | None:
    """Object files as one piece of prelinked code, in which each may call functions of the others; None where that cannot be.

    ``gives`` are the symbols that whoever loads it can ask for: all by default.
    """
    if sys.platform != "linux" or not all(image.startswith(object_file.MAGIC) for image in images):
        return None
    files = [object_file.read(image) for image in images]
    if any(file.machine != X86_64 for file in files):
        return None
    try:
        return to_bytes(_laid_out(files, gives))
    except _UnknownError:
        return None


def _laid_out(files: Sequence[ObjectFile], wanted: Container[str] | None) -> Prelinked:
    sections = _in_memory(files)
    code, data = bytearray(), bytearray()
    places = _append(code, 0, {key: each for key, each in sections.items() if not each.flags & WRITABLE})
    exported = {each.name: (number, each) for number, file in enumerate(files) for each in file.symbols if _is_exported(each)}
    relocations = [
        ((number, each.section), each, *_definition(number, file.symbols[each.symbol], exported))
        for number, file in enumerate(files)
        for each in file.relocations
        if (number, each.section) in sections
    ]
    tables = _append_tables(code, tuple(dict.fromkeys(symbol.name for *_, symbol in relocations if symbol.section == UNDEFINED)))
    places |= _append(data, data_offset(code), {key: each for key, each in sections.items() if each.flags & WRITABLE})
    for key, relocation, number, symbol in relocations:
        place = places[key] + relocation.offset
        if place >= len(code):
            raise _UnknownError  # an address among the data: it depends on where they lie
        struct.pack_into("<i", code, place, _target(relocation.kind, number, symbol, places, tables) + relocation.addend - place)
    gives = {name: _place(number, symbol, places) for name, (number, symbol) in exported.items() if wanted is None or name in wanted}
    return Prelinked(bytes(code), bytes(data), tables.slots, tables.wants, gives)


def _is_exported(symbol: Symbol) -> bool:
    """Whether other files may use what a file defines."""
    return symbol.is_global and symbol.section != UNDEFINED


def _definition(file: int, symbol: Symbol, exported: Mapping[str, tuple[int, Symbol]]) -> tuple[int, Symbol]:
    """What a file means by a symbol: its own, another file's, or what the process must give; with the number of the file that has it."""
    return exported.get(symbol.name, (file, symbol)) if symbol.section == UNDEFINED else (file, symbol)


def _in_memory(files: Sequence[ObjectFile]) -> dict[_Key, Section]:
    """The sections that a program has when it runs, executable ones first. Nothing unwinds our stacks."""
    every = {(number, index): each for number, file in enumerate(files) for index, each in enumerate(file.sections)}
    kept = {key: each for key, each in every.items() if each.flags & IN_MEMORY and each.kind not in (NOTE, UNWIND)}
    if any(each.flags & THREAD_LOCAL or each.alignment > PAGE for each in kept.values()):
        raise _UnknownError
    return dict(sorted(kept.items(), key=lambda item: not item[1].flags & EXECUTABLE))


def _append(memory: bytearray, begin: int, sections: Mapping[_Key, Section]) -> dict[_Key, int]:
    """Append sections to memory that begins somewhere; where each of them lies."""
    places: dict[_Key, int] = {}
    for key, section in sections.items():
        places[key] = begin + _aligned(memory, section.alignment)
        memory += section.content.ljust(section.size, b"\0")
    return places


def _append_tables(code: bytearray, wants: tuple[str, ...]) -> _Tables:
    """Append a jump and a slot for each thing that the process gives."""
    jumps = _aligned(code, _JUMP.size)
    tables = _Tables(wants, jumps, jumps + _JUMP.size * len(wants))
    for name in wants:
        code += _JUMP.pack(_INDIRECT, tables.slot(name) - (tables.jump(name) + _JUMP_BYTES))
    code += bytes(8 * len(wants))
    return tables


def _aligned(memory: bytearray, alignment: int) -> int:
    """The end of the memory, which is made a multiple of something."""
    memory += bytes(-len(memory) % alignment)
    return len(memory)


def _target(kind: int, file: int, symbol: Symbol, places: Mapping[_Key, int], tables: _Tables) -> int:
    """What a place refers to: a symbol of the files' own, or the jump or the slot of one of the process's."""
    is_own = symbol.section != UNDEFINED
    if is_own and kind in (_RELATIVE, _CALL):
        return _place(file, symbol, places)
    if not is_own and kind == _CALL:
        return tables.jump(symbol.name)
    if not is_own and kind in _SLOTS:
        return tables.slot(symbol.name)
    raise _UnknownError


def _place(file: int, symbol: Symbol, places: Mapping[_Key, int]) -> int:
    """The place of a file's symbol in memory."""
    if (file, symbol.section) not in places:
        raise _UnknownError  # a number and no place, or something that object files share
    return places[file, symbol.section] + symbol.value
