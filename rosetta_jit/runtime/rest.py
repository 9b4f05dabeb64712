"""The rest of a program's calls, compiled when it is first asked for: most programs of a process are called in the usual way alone.

The usual call looks for it where it has something else to do (`backends/entry/rest_later.ll`, `next_later.ll`). Until it is there, the slow
path does that, and has it made for the next time; so does who asks for one of its symbols.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping

from rosetta_jit.kernel.entries import ANY_CALL, NEXT, NEXT_CALL, NEXT_KERNEL, REST
from rosetta_jit.runtime.code import native

KERNELS = ("kernel", "size", NEXT_KERNEL)
"""What it calls of the program."""

PLACES = {REST: ANY_CALL, NEXT: NEXT_CALL}
"""Where the program looks for which of its functions."""


class Rest:
    """The rest of loaded code. It must live as long as that.

    Parameters
    ----------
    addresses
        Those of the code.
    symbols
        What the rest defines.
    compiled
        Gives its code.
    """

    def __init__(self, addresses: Mapping[str, int], symbols: tuple[str, ...], compiled: Callable[[], bytes]) -> None:
        self._places = {symbol: ctypes.c_int64.from_address(addresses[place]) for place, symbol in PLACES.items() if place in addresses}
        self._kernels = {name: addresses[name] for name in KERNELS if name in addresses}
        self._symbols, self._compiled = symbols, compiled
        self._libraries: list[native.Library] = []

    def made(self) -> native.Library:
        """The code, which the usual call finds from now on.

        Threads may come here at once: what they have made is the same, and all of it stays, as a call may be running in it.
        """
        if not self._libraries:
            self._libraries.append(native.load(self._compiled(), self._symbols, given=self._kernels))
            for symbol, place in self._places.items():
                place.value = self._libraries[0][symbol]
        return self._libraries[0]
