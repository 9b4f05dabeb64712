"""Prelink: lay out the sections of an object file once, when it is compiled, so that no later process needs a linker for it.

    code    executable sections, read-only ones, a jump for each function of the process that is called, the slots
    data    what is written

What is not known here is left to a linker: other processors and systems, kinds of relocation that our code has not.
"""

from __future__ import annotations

import struct
import sys
from typing import TYPE_CHECKING

from rosetta_jit.runtime.code import object_file
from rosetta_jit.runtime.code.object_file import EXECUTABLE, IN_MEMORY, NOTE, THREAD_LOCAL, UNDEFINED, UNWIND, WRITABLE, X86_64
from rosetta_jit.runtime.code.prelinked import PAGE, Prelinked, data_offset, to_bytes
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rosetta_jit.runtime.code.object_file import ObjectFile, Section, Symbol

# System V ABI, AMD64 supplement, 4.4.1: all of them 32 bits, relative to the place itself.
_RELATIVE, _CALL = 2, 4
_SLOTS = (9, 41, 42)

_JUMP, _INDIRECT, _JUMP_BYTES = struct.Struct("<2si2x"), b"\xff\x25", 6
"""``jmp [rip + distance]``, its first bytes, and how long it is: the distance counts from its end."""


class _UnknownError(Exception):
    """Something that is left to a linker; never leaves this module."""


@dataclass(frozen=True, slots=True)
class _Tables:
    """Where the jumps and the slots lie, and in which order."""

    wants: tuple[str, ...]
    jumps: int
    slots: int

    def jump(self, name: str) -> int:
        return self.jumps + _JUMP.size * self.wants.index(name)

    def slot(self, name: str) -> int:
        return self.slots + 8 * self.wants.index(name)


def prelinked(image: bytes) -> bytes | None:
    """An object file as prelinked code; None where that cannot be."""
    if sys.platform != "linux" or not image.startswith(object_file.MAGIC):
        return None
    file = object_file.read(image)
    if file.machine != X86_64:
        return None
    try:
        return to_bytes(_laid_out(file))
    except _UnknownError:
        return None


def _laid_out(file: ObjectFile) -> Prelinked:
    sections = _in_memory(file)
    relocations = [(each, file.symbols[each.symbol]) for each in file.relocations if each.section in sections]
    code, data = bytearray(), bytearray()
    places = _append(code, 0, {number: each for number, each in sections.items() if not each.flags & WRITABLE})
    tables = _append_tables(code, tuple(dict.fromkeys(symbol.name for _, symbol in relocations if symbol.section == UNDEFINED)))
    places |= _append(data, data_offset(code), {number: each for number, each in sections.items() if each.flags & WRITABLE})
    for relocation, symbol in relocations:
        place = places[relocation.section] + relocation.offset
        if place >= len(code):
            raise _UnknownError  # an address among the data: it depends on where they lie
        struct.pack_into("<i", code, place, _target(relocation.kind, symbol, places, tables) + relocation.addend - place)
    gives = {each.name: _place(each, places) for each in file.symbols if each.is_global and each.section != UNDEFINED}
    return Prelinked(bytes(code), bytes(data), tables.slots, tables.wants, gives)


def _in_memory(file: ObjectFile) -> dict[int, Section]:
    """The sections that a program has when it runs, by their numbers, executable ones first. Nothing unwinds our stacks."""
    kept = {number: each for number, each in enumerate(file.sections) if each.flags & IN_MEMORY and each.kind not in (NOTE, UNWIND)}
    if any(each.flags & THREAD_LOCAL or each.alignment > PAGE for each in kept.values()):
        raise _UnknownError
    return dict(sorted(kept.items(), key=lambda item: not item[1].flags & EXECUTABLE))


def _append(memory: bytearray, begin: int, sections: Mapping[int, Section]) -> dict[int, int]:
    """Append sections to memory that begins somewhere; where each of them lies."""
    places: dict[int, int] = {}
    for number, section in sections.items():
        places[number] = begin + _aligned(memory, section.alignment)
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


def _target(kind: int, symbol: Symbol, places: Mapping[int, int], tables: _Tables) -> int:
    """What a place refers to: a symbol of the file's own, or the jump or the slot of one of the process's."""
    is_own = symbol.section != UNDEFINED
    if is_own and kind in (_RELATIVE, _CALL):
        return _place(symbol, places)
    if not is_own and kind == _CALL:
        return tables.jump(symbol.name)
    if not is_own and kind in _SLOTS:
        return tables.slot(symbol.name)
    raise _UnknownError


def _place(symbol: Symbol, places: Mapping[int, int]) -> int:
    """Where a symbol of the file's own lies."""
    if symbol.section not in places:
        raise _UnknownError  # a number and no place, or something that object files share
    return places[symbol.section] + symbol.value
