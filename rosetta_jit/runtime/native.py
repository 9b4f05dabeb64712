"""Object code, loaded into this process by llvmlite's linker alone: neither numba nor the compiler is imported.

Code comes from the cache, a trusted folder, yet it is linked only if all that it wants from the process is on a short list.
"""

from __future__ import annotations

import struct
import sys
from functools import cache
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary, finalize

from llvmlite import binding

from rosetta_jit.dataclass import dataclass
from rosetta_jit.sha import sha256

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

MATHEMATICS = (
    *("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "copysign", "cos", "cosh", "erf", "erfc", "exp", "exp2", "expm1"),
    *("fabs", "fma", "fmax", "fmin", "frexp", "hypot", "ldexp", "lgamma", "log", "log10", "log1p", "log2", "nearbyint", "pow", "round"),
    *("roundeven", "sin", "sincos", "sinh", "tan", "tanh", "tgamma"),
)
"""Functions of the C library that users' functions call; those of float32 end in f."""

ALLOWED = frozenset(
    [
        "PyBuffer_Release",
        "PyByteArray_Type",
        "PyBytes_FromStringAndSize",
        "PyBytes_Type",
        "PyErr_Occurred",
        "PyList_SetItem",
        "PyLong_AsSsize_t",
        "PyLong_FromSsize_t",
        "PyMemoryView_FromObject",
        "PyObject_GetBuffer",
        "PyObject_Vectorcall",
        "Py_DecRef",
        "Py_IncRef",
        "clock_gettime",
        *("memcmp", "memcpy", "memmove", "memset"),
        *("ceil", "ceilf", "floor", "floorf", "fmod", "fmodf", "rint", "rintf", "sqrt", "sqrtf", "trunc", "truncf"),
        *("snprintf", "strtod", "strtoll"),
        *("acos", "asin", "atan", "atan2", "cos", "sin", "sincos", "tan"),
        *(f"{name}{suffix}" for suffix in ("", "f") for name in MATHEMATICS),
    ]
)
"""Everything that object code may take from the process: what the entries call, and what LLVM turns intrinsics into."""

_SYMBOL = struct.Struct("<IBBHQQ")
_UNDEFINED = 0


class ForeignCodeError(ValueError):
    """Object code that is none of ours."""


@dataclass(frozen=True, slots=True, weakref_slot=True)
class Library:
    """Loaded code. The addresses are good until the last reference to the library is gone; then its memory is freed."""

    addresses: Mapping[str, int]

    def __getitem__(self, symbol: str) -> int:
        return self.addresses[symbol]


def load(image: bytes, symbols: Sequence[str], prepare: Callable[[Mapping[str, int]], object] = len) -> Library:
    """Link object code into the process, or find it there: whoever loads the same code at the same time shares it.

    Parameters
    ----------
    image
        An object file, as the compiler made it.
    symbols
        What it defines.
    prepare
        Is given the addresses when the code is linked, before anybody calls it; what it gives lives as long as the code.

    Raises
    ------
    ForeignCodeError
        If it is no object file for this machine, wants a symbol that is not in `ALLOWED`, or lacks one of ``symbols``.
    """
    key = (sha256(image).digest(), *symbols)
    library = _in_use().get(key)
    if library is None:
        library = _in_use()[key] = _linked(image, symbols, prepare)
    return library


def _linked(image: bytes, symbols: Sequence[str], prepare: Callable[[Mapping[str, int]], object]) -> Library:
    """A library in a linker of its own, because one that is shared keeps something of every library that it ever had."""
    foreign = sorted(undefined_symbols(image) - ALLOWED)
    if foreign:
        raise ForeignCodeError(f"the code wants {', '.join(foreign[:3])} from the process")
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    linker = binding.create_lljit_compiler(suppress_errors=True)
    builder = binding.JITLibraryBuilder().add_object_img(image).add_current_process()
    for symbol in symbols:
        builder.export_symbol(symbol)
    try:
        code = builder.link(linker, "program")
    except RuntimeError as error:
        linker.close()
        raise ForeignCodeError(str(error)) from error
    library = Library({symbol: code[symbol] for symbol in symbols})
    # Not at exit: other objects may still call the code then.
    finalize(library, _free, code, linker, prepare(library.addresses)).atexit = False
    return library


def _free(code: binding.ResourceTracker, linker: binding.LLJIT, called: object) -> None:
    del called  # functions that the code has called until now
    code.close()
    linker.close()


@cache
def _in_use() -> WeakValueDictionary[tuple[object, ...], Library]:
    """The libraries of this process. Code never changes, so a thousand decoders of one type need it once."""
    return WeakValueDictionary()


def undefined_symbols(image: bytes) -> frozenset[str]:
    """The names that an ELF object takes from elsewhere. Objects of other systems are not examined."""
    if not image.startswith(b"\x7fELF"):
        if sys.platform == "linux":
            raise ForeignCodeError("no ELF object file")
        return frozenset()
    sections = dict(_sections(image))
    table, names = sections.get(".symtab"), sections.get(".strtab")
    if not table or not names:
        raise ForeignCodeError("an object file without symbols")
    entries = _SYMBOL.iter_unpack(table[: len(table) // _SYMBOL.size * _SYMBOL.size])
    return frozenset(_name(names, start) for start, _, _, section, _, _ in entries if section == _UNDEFINED and start)


def _sections(image: bytes) -> Iterator[tuple[str, bytes]]:
    """Name and content of each section (ELF-64 object file format, 4: 64-byte headers, names in the section that e_shstrndx gives)."""
    try:
        start = struct.unpack_from("<Q", image, 0x28)[0]
        number, names_index = struct.unpack_from("<HH", image, 0x3C)
        headers = [struct.unpack_from("<IIQQQQ", image, start + 64 * index) for index in range(number)]
        _, _, _, _, names_at, names_size = headers[names_index]
    except (struct.error, IndexError, OverflowError) as error:
        raise ForeignCodeError("a damaged object file") from error
    names = image[names_at : names_at + names_size]
    for name, _, _, _, at, size in headers:
        yield _name(names, name), image[at : at + size]


def _name(table: bytes, start: int) -> str:
    return table[start : table.find(b"\0", start)].decode("latin-1")
