"""Prelinked code: it may lie anywhere, so to load it is to copy it, and to write down where it finds what is the process's.

    prelinked = magic, head, offsets of what it gives, names of what it wants and of what it gives, code, data
    head      = sizes of code and data, offset of the slots, how many it wants, how many it gives, size of the names

Numbers are u32, little-endian; a zero byte stands between names.
Its parts refer to one another by distance. What it takes from the process it finds in the slots: addresses of 8 bytes at the end of the
code, in the order of ``wants``. In memory the data begin on the page behind the code; code is executed and never written, data are written
and never executed. `runtime.code.prelink` makes it.
"""

from __future__ import annotations

import ctypes
import os
import struct
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from types import MappingProxyType
from typing import cast

from rosetta_jit.runtime.code.allowed import ForeignCodeError, check_wanted
from rosetta_jit.startup.dataclass import dataclass

MAGIC = b"prelink\x02"
"""The last byte is the version of this format."""

PAGE = 4096
"""Of the processors for which there is such code."""

READ, WRITE, EXECUTE, OWN_AND_EMPTY = 1, 2, 4, 0x22
"""Of Linux on x86-64 (sys/mman.h), which alone has such code: to import `mmap` for them takes half as long as to load it."""

_HEAD = struct.Struct("<6I")
_FAILED = 2**64 - 1


@dataclass(frozen=True, slots=True)
class Prelinked:
    """Code and data, where the code's slots begin, and what they are for; offsets of what it gives, in memory."""

    code: bytes
    data: bytes
    slots: int
    wants: tuple[str, ...]
    gives: Mapping[str, int]


def to_bytes(prelinked: Prelinked) -> bytes:
    """The code as it is kept."""
    code, data, wants, gives = prelinked.code, prelinked.data, prelinked.wants, prelinked.gives
    names = "\0".join((*wants, *gives)).encode()
    head = _HEAD.pack(len(code), len(data), prelinked.slots, len(wants), len(gives), len(names))
    return b"".join((MAGIC, head, struct.pack(f"<{len(gives)}I", *gives.values()), names, code, data))


def from_bytes(image: bytes) -> Prelinked:
    """The code that was kept, or ForeignCodeError."""
    try:
        sizes: tuple[int, ...] = _HEAD.unpack_from(image, len(MAGIC))
        code_size, data_size, slots, wants, gives, names_size = sizes
        names_at = len(MAGIC) + _HEAD.size + 4 * gives
        offsets: tuple[int, ...] = struct.unpack(f"<{gives}I", image[names_at - 4 * gives : names_at])
        begin = names_at + names_size
        names, end = image[names_at:begin].decode().split("\0"), begin + code_size
        prelinked = Prelinked(image[begin:end], image[end:], slots, tuple(names[:wants]), dict(zip(names[wants:], offsets, strict=True)))
    except (struct.error, ValueError) as error:
        raise ForeignCodeError("damaged code") from error
    whole = len(prelinked.data) == data_size and slots == code_size - 8 * wants
    if not whole or any(offset >= data_offset(prelinked.code) + data_size for offset in offsets):
        raise ForeignCodeError("damaged code")
    return prelinked


def data_offset(code: bytes | bytearray) -> int:
    """The offset of the data that belong to code."""
    return -(-len(code) // PAGE) * PAGE


def place(
    image: bytes, symbols: Sequence[str], given: Mapping[str, int] = MappingProxyType({})
) -> tuple[dict[str, int], Callable[[], object]]:
    """The addresses of the code's symbols, and the function that frees its memory.

    What it wants it finds in the process, or where it is ``given``.

    Raises
    ------
    ForeignCodeError
        If it is damaged, wants what is not allowed or what the process has not, or lacks one of ``symbols``.
    """
    prelinked = from_bytes(image)
    check_wanted(each for each in prelinked.wants if each not in given)
    missing = [symbol for symbol in symbols if symbol not in prelinked.gives]
    if missing:
        raise ForeignCodeError(f"the code has no {', '.join(missing)}")
    begin = data_offset(prelinked.code)
    code = bytearray(prelinked.code.ljust(begin, b"\0"))
    addresses = (given.get(name) or _address_of(name) for name in prelinked.wants)
    struct.pack_into(f"<{len(prelinked.wants)}Q", code, prelinked.slots, *addresses)
    size = begin + len(prelinked.data)
    base = _writable(size)
    ctypes.memmove(base, bytes(code) + prelinked.data, size)
    _make_executable(base, begin)
    return {symbol: base + prelinked.gives[symbol] for symbol in symbols}, partial(_system().munmap, base, size)


@cache
def _address_of(name: str) -> int:
    try:
        found = getattr(ctypes.pythonapi, name)
    except AttributeError as error:
        raise ForeignCodeError(f"this process has no {name}") from error
    return cast("int", ctypes.cast(found, ctypes.c_void_p).value)


def _writable(size: int) -> int:
    """Memory of our own. No object gives it up when Python ends: others may still call what is in it."""
    address = _system().mmap(None, size, READ | WRITE, OWN_AND_EMPTY, -1, 0)
    if address == _FAILED:
        raise MemoryError(f"{size} bytes for code")
    return address


def _make_executable(address: int, size: int) -> None:
    if _system().mprotect(address, size, READ | EXECUTE):
        why = os.strerror(ctypes.get_errno())
        _system().munmap(address, size)
        raise ForeignCodeError(f'this system lets no memory be executed ({why}); backend="python" needs none')


@cache
def _system() -> ctypes.CDLL:
    """The C library, whose functions are those of POSIX."""
    system = ctypes.CDLL(None, use_errno=True)
    extent = [ctypes.c_void_p, ctypes.c_size_t]
    system.mmap.restype, system.mmap.argtypes = ctypes.c_void_p, [*extent, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_long]
    system.mprotect.argtypes, system.munmap.argtypes = [*extent, ctypes.c_int], extent
    return system
