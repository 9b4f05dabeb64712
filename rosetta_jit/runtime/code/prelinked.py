"""Prelinked code: it may lie anywhere, so to load it is to copy it, and to write down where it finds what is the process's.

    prelinked = magic, length of table (u32), table (JSON object), code, data
    table     = {"code": bytes, "data": bytes, "slots": offset, "wants": [name, …], "gives": {name: offset, …}}

Its parts refer to one another by distance. What it takes from the process it finds in the slots: addresses of 8 bytes at the end of the
code, in the order of ``wants``. In memory the data begin on the page behind the code; code is executed and never written, data are written
and never executed. `runtime.code.prelink` makes it.
"""

from __future__ import annotations

import ctypes
import json
import mmap
import os
import struct
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import Any, cast

from rosetta_jit.runtime.code.allowed import ForeignCodeError, check_wanted
from rosetta_jit.startup.dataclass import dataclass

MAGIC = b"prelink\x01"
"""The last byte is the version of this format."""

PAGE = 4096
"""Of the processors for which there is such code."""

_SIZE = struct.Struct("<I")
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
    code, data = prelinked.code, prelinked.data
    table = {"code": len(code), "data": len(data), "slots": prelinked.slots, "wants": prelinked.wants, "gives": prelinked.gives}
    text = json.dumps(table, separators=(",", ":")).encode()
    return MAGIC + _SIZE.pack(len(text)) + text + code + data


def from_bytes(image: bytes) -> Prelinked:
    """The code that was kept, or ForeignCodeError."""
    try:
        (size,) = _SIZE.unpack_from(image, len(MAGIC))
        begin = len(MAGIC) + _SIZE.size + size
        table: dict[str, Any] = json.loads(image[begin - size : begin])
        end = begin + table["code"]
        prelinked = Prelinked(image[begin:end], image[end:], table["slots"], tuple(table["wants"]), dict(table["gives"]))
        whole = len(prelinked.data) == table["data"] and 0 <= prelinked.slots == table["code"] - 8 * len(prelinked.wants)
        inside = all(0 <= offset < data_offset(prelinked.code) + len(prelinked.data) for offset in prelinked.gives.values())
    except (struct.error, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ForeignCodeError("damaged code") from error
    if not whole or not inside:
        raise ForeignCodeError("damaged code")
    return prelinked


def data_offset(code: bytes | bytearray) -> int:
    """The offset of the data that belong to code."""
    return -(-len(code) // PAGE) * PAGE


def place(image: bytes, symbols: Sequence[str]) -> tuple[dict[str, int], Callable[[], object]]:
    """The addresses of the code's symbols, and the function that frees its memory.

    Raises
    ------
    ForeignCodeError
        If it is damaged, wants what is not allowed or what the process has not, or lacks one of ``symbols``.
    """
    prelinked = from_bytes(image)
    check_wanted(prelinked.wants)
    missing = [symbol for symbol in symbols if symbol not in prelinked.gives]
    if missing:
        raise ForeignCodeError(f"the code has no {', '.join(missing)}")
    begin = data_offset(prelinked.code)
    code = bytearray(prelinked.code.ljust(begin, b"\0"))
    struct.pack_into(f"<{len(prelinked.wants)}Q", code, prelinked.slots, *map(_address_of, prelinked.wants))
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
    address = _system().mmap(None, size, mmap.PROT_READ | mmap.PROT_WRITE, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, -1, 0)
    if address == _FAILED:
        raise MemoryError(f"{size} bytes for code")
    return address


def _make_executable(address: int, size: int) -> None:
    if _system().mprotect(address, size, mmap.PROT_READ | mmap.PROT_EXEC):
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
