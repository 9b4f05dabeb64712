"""Compiled code, loaded into this process once, however many programs use it; neither numba nor the compiler is imported for that."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from weakref import WeakValueDictionary, finalize

from rosetta_jit.runtime.code import prelinked
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.sha import sha256


@dataclass(frozen=True, slots=True, weakref_slot=True)
class Library:
    """Loaded code, and what it was ``prepared`` with. The addresses are good until the last reference to the library is gone."""

    addresses: Mapping[str, int]
    prepared: object = None

    def __getitem__(self, symbol: str) -> int:
        return self.addresses[symbol]


def load(image: bytes, symbols: Sequence[str], prepare: Callable[[Mapping[str, int]], object] = len, program: str = "") -> Library:
    """Load code into the process, or find it there: whoever loads the same code at the same time shares it.

    Parameters
    ----------
    image
        What the compiler made: prelinked code, or an object file.
    symbols
        What it defines.
    prepare
        Is given the addresses when the code is loaded, before anybody calls it; what it gives lives as long as the code.
    program
        The name of the only program that may share the code, where it keeps what depends on that.

    Raises
    ------
    ForeignCodeError
        If it is no code for this machine, wants what is not allowed, or lacks one of ``symbols``.
    """
    key = (sha256(image).digest(), program, *symbols)
    library = _in_use().get(key)
    if library is None:
        library = _in_use()[key] = _loaded(image, symbols, prepare)
    return library


def _loaded(image: bytes, symbols: Sequence[str], prepare: Callable[[Mapping[str, int]], object]) -> Library:
    if image.startswith(prelinked.MAGIC):
        addresses, free = prelinked.place(image, symbols)
    else:
        from rosetta_jit.runtime.code import linker

        addresses, free = linker.link(image, symbols)
    library = Library(addresses, prepare(addresses))
    # Not at exit: other objects may still call the code then.
    finalize(library, _free, free, library.prepared).atexit = False
    return library


def _free(free: Callable[[], object], called: object) -> None:
    del called  # functions that the code has called until now
    free()


@cache
def _in_use() -> WeakValueDictionary[tuple[object, ...], Library]:
    """The libraries of this process. Code never changes, so a thousand decoders of one type need it once."""
    return WeakValueDictionary()
