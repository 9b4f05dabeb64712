"""Compiled code, loaded into this process once, however many programs use it; neither numba nor the compiler is imported for that."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from types import MappingProxyType
from weakref import WeakValueDictionary, finalize

from rosetta_jit.runtime.code import prelinked
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.sha import sha256


@dataclass(frozen=True, slots=True, weakref_slot=True)
class Library:
    """Loaded code, and what it was ``prepared`` with. The addresses are good until the last reference to the library is gone.

    What else it has may be code of its own, which ``later`` makes when somebody asks for something of that.
    """

    addresses: Mapping[str, int]
    prepared: object = None
    later: Callable[[], Library] | None = None

    def __getitem__(self, symbol: str) -> int:
        found = self.addresses.get(symbol)
        if found is not None:
            return found
        assert self.later is not None, symbol
        return self.later()[symbol]


def load(
    image: bytes,
    symbols: Sequence[str],
    prepare: Callable[[Mapping[str, int]], object] = len,
    program: str = "",
    *,
    given: Mapping[str, int] = MappingProxyType({}),
    later: Callable[[Mapping[str, int]], Callable[[], Library]] | None = None,
) -> Library:
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
    given
        Of prelinked code, the addresses of what it takes from other code of ours, which must live as long.
    later
        Is given the addresses like ``prepare``, and gives what makes the code that has the symbols which are asked for besides.

    Raises
    ------
    ForeignCodeError
        If it is no code for this machine, wants what is not allowed, or lacks one of ``symbols``.
    """
    key = (sha256(image).digest(), program, *symbols, *given.values())
    library = _in_use().get(key)
    if library is None:
        library = _in_use()[key] = _loaded(image, symbols, prepare, given, later)
    return library


def is_prelinked(image: bytes) -> bool:
    """Whether code needs no linker."""
    return image.startswith(prelinked.MAGIC)


def _loaded(
    image: bytes,
    symbols: Sequence[str],
    prepare: Callable[[Mapping[str, int]], object],
    given: Mapping[str, int],
    later: Callable[[Mapping[str, int]], Callable[[], Library]] | None,
) -> Library:
    if is_prelinked(image):
        addresses, free = prelinked.place(image, symbols, given)
    else:
        from rosetta_jit.runtime.code import linker

        addresses, free = linker.link(image, symbols)
    library = Library(addresses, prepare(addresses), later and later(addresses))
    # Not at exit: other objects may still call the code then.
    finalize(library, _free, free, library.prepared, library.later).atexit = False
    return library


def _free(free: Callable[[], object], *called: object) -> None:
    del called  # functions that the code has called until now
    free()


@cache
def _in_use() -> WeakValueDictionary[tuple[object, ...], Library]:
    """The libraries of this process. Code never changes, so a thousand decoders of one type need it once."""
    return WeakValueDictionary()
