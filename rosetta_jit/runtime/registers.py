"""Registers: what a program keeps from one message to the next, where its mapping declares state.

They belong to the program and not to a holder, so that all its calls share them, and one call has them at a time. A kernel changes them
when its message is done (`kernel.nodes.Return`), so that a message that fails leaves them as they were.
"""

from __future__ import annotations

from _thread import allocate_lock
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from rosetta_jit.errors import InUse
from rosetta_jit.kernel.state import REGISTERS
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.runtime.lanes import Lanes

OTHERS = "another call of this program, whose mapping keeps state from one message to the next, has not returned: give each thread its own"

TYPES = {"bool": "?", "float32": "<f4", "float64": "<f8"} | {
    f"{'u' * (sign == 'u')}int{8 * width}": f"<{sign}{width}" for sign in "iu" for width in (1, 2, 4, 8)
}
"""The types of variables, as numpy has them. Each begins at the low byte of its word."""


@dataclass(frozen=True, slots=True)
class Kept:
    """What a program keeps from one message to the next.

    Attributes
    ----------
    variables
        Each state variable: its name, the name of its type, the word that it is at first.
    sizes
        Whether the size of a message depends on them.
    is_shared
        Whether other threads may run while its kernels do, though they have the interpreter lock: they call functions of their host.
    """

    variables: tuple[tuple[str, str, int], ...] = ()
    sizes: bool = False
    is_shared: bool = False

    @classmethod
    def of(cls, plain: Mapping[str, Any]) -> Kept:
        """From the header of a program."""
        return cls(tuple((name, type_, word) for name, type_, word in plain["variables"]), plain["sizes"], plain["is_shared"])

    def registers(self) -> Registers | None:
        """Those of one program, which are what they are at first; None where there are none."""
        return Registers(self.variables) if self.variables else None


NOTHING_KEPT = Kept()


class Registers:
    """The registers of one program, which lie one behind the other.

    Behind them there is room for what they were before a message, which bridges need; the word in front is 1 while a call has them, for the
    compiled entries (`backends/entry/registers.ll`).

    Attributes
    ----------
    values : ndarray of int64
        A word for each variable.
    address : int
        Where they lie.
    """

    __slots__ = ("_in_use", "_initial", "_lock", "_variables", "address", "values")

    def __init__(self, variables: tuple[tuple[str, str, int], ...]) -> None:
        count = len(variables)
        self._variables = tuple((name, type_) for name, type_, _ in variables)
        self._initial = np.array([word for _, _, word in variables], np.int64)
        words = np.zeros(1 + 2 * count, np.int64)
        self._lock = allocate_lock()
        self._in_use = words[:1].data
        self.values = words[1 : 1 + count]
        self.address: int = self.values.ctypes.data
        self.values[:] = self._initial

    def __enter__(self) -> Self:
        """Take them, around what uses them.

        Raises
        ------
        InUse
            Another call has them.
        """
        if not self._lock.acquire(False):
            raise InUse(OTHERS)
        self._in_use[0] = 1
        return self

    def __exit__(self, *_: object) -> None:
        self._in_use[0] = 0
        self._lock.release()

    def lent(self, lanes: Lanes) -> Lent:
        """Around kernels that run on some lanes, and find them there. Raises `InUse` as ``with`` itself."""
        return Lent(self, lanes)

    @contextmanager
    def as_before(self) -> Generator[None]:
        """Around one message: where it fails they are what they were."""
        before = self.values.copy()
        try:
            yield
        except BaseException:
            self.values[:] = before
            raise

    def reset(self) -> None:
        """Let them be what they were at first. Raises `InUse` as ``with`` itself."""
        with self:
            self.values[:] = self._initial

    def shown(self) -> Mapping[str, bool | int | float]:
        """What each variable is now, by its name. Raises `InUse` as ``with`` itself."""
        with self:
            words = self.values.copy()
        named = zip(self._variables, words, strict=True)
        return {name: np.frombuffer(word.tobytes(), TYPES[type_], 1)[0].item() for (name, type_), word in named}


class Lent:
    """Around kernels that run on some lanes and find the registers of a program there; it takes no time that a call would notice."""

    __slots__ = ("_lanes", "_registers")

    def __init__(self, registers: Registers, lanes: Lanes) -> None:
        self._registers, self._lanes = registers, lanes

    def __enter__(self) -> None:
        registers, lanes = self._registers, self._lanes
        registers.__enter__()
        lanes.registers, lanes.words[REGISTERS] = registers.values, registers.address

    def __exit__(self, *_: object) -> None:
        self._registers.__exit__()


def address_of(registers: Registers | None) -> int:
    """The address of registers; 0 where there are none."""
    return 0 if registers is None else registers.address
