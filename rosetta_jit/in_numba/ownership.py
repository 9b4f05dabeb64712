"""Ownership of holders in users' compiled functions: taken when called, repaired when a kernel fails, given back on return.

While a holder is taken nobody else can use it, as inside ``with lanes:``; so its lanes may grow in the middle of a loop. Arrays that such
a function has read, or returns, keep all memory alive that the holder had meanwhile, whatever has grown since.
"""

from __future__ import annotations

from collections.abc import Callable
from ctypes import CFUNCTYPE, c_int64, py_object
from functools import cache
from threading import local
from typing import Any

from rosetta_jit.errors import DecodeError, RosettaError
from rosetta_jit.kernel.state import GROW, VALID
from rosetta_jit.runtime import run
from rosetta_jit.runtime.holder import Holder
from rosetta_jit.runtime.holder.classes import settle_lanes
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.startup.dataclass import dataclass

_TELL = CFUNCTYPE(None, py_object)
_MEND = CFUNCTYPE(c_int64, py_object, c_int64, c_int64, c_int64)


class Taken:
    """A holder while a compiled function has it.

    Attributes
    ----------
    memory : dict
        All memory that the holder has had meanwhile, by identity.
    address : int
        Where its state lies.
    """

    __slots__ = ("address", "holder", "lanes", "memory")

    def __init__(self, holder: Holder) -> None:
        self.holder = holder
        self.lanes = lanes = holder.lanes_
        self.address = lanes.address
        self.memory: dict[int, Any] = {0: lanes.arena}
        self.keep_memory()

    def keep_memory(self) -> None:
        """Keep the memory alive that the holder has now."""
        self.memory |= {id(each): each for each in self.lanes.memory.values()}


def take(holder: Holder) -> Taken:
    """Take a holder for a compiled function, which finds no borrowed bytes in it.

    Raises
    ------
    InUse
        If it is in use already: by another thread, or by another argument of the same call.
    """
    lanes = holder.lanes_
    lanes.__enter__()  # `give_back` leaves
    try:
        if lanes.words[VALID] and lanes.source[0] is not None:
            settle_lanes(holder)
        return Taken(holder)
    except BaseException:
        lanes.__exit__()
        raise


def give_back(taken: Taken) -> None:
    """Let others use the holder again."""
    taken.lanes.__exit__()


@dataclass(frozen=True, slots=True)
class Program:
    """What calls of a kernel need of the program that it is of.

    Attributes
    ----------
    sites
        Where a message can fail.
    limit
        How many bytes of a lane a message may ask for, whatever its own size.
    tell, untell
        What is told to a kernel before a message, and taken back where that cannot be decoded; None of kernels that do not ask.
    """

    sites: run.Sites
    limit: int
    tell: Callable[[Lanes, int], None] | None
    untell: Callable[[Lanes], None]


class _Last(local):
    """The error that compiled code is about to raise in a thread."""

    error: RosettaError


_LAST = _Last()


class BrokenMessage(DecodeError):  # noqa: N818  the message is what is wrong
    """The `DecodeError` of a message in compiled code, which can raise a class only: it finds there what is wrong."""

    def __init__(self) -> None:
        error = _LAST.error
        assert isinstance(error, DecodeError)
        super().__init__(error.kind, error.path, error.detail, error.offset)

    def __reduce__(self) -> tuple[Any, ...]:
        return DecodeError, (self.kind, self.path, self.detail, self.offset)


@cache
def entries(program: Program) -> tuple[Any, Any]:
    """C functions for a program's kernel: one to tell it of a message that is to come, one for where it fails.

    The second makes room and returns 1, or returns 0 where `BrokenMessage` says why it cannot. Both live as long as the process, as does
    the code that numba compiles, in which their addresses stand.
    """

    def tell(taken: Taken) -> None:
        assert program.tell is not None
        program.tell(taken.lanes, 1)

    def mend(taken: Taken, result: int, begin: int, end: int) -> int:
        lanes = taken.lanes
        try:
            _mend(program, lanes, result, begin, end)
        except DecodeError as error:
            _LAST.error = error
            program.untell(lanes)
            return 0
        taken.keep_memory()
        return 1

    return _TELL(tell), _MEND(mend)


def _mend(program: Program, lanes: Lanes, result: int, begin: int, end: int) -> None:
    if result != GROW:
        raise run.decode_error(program.sites[-1 - result], lanes, begin, end)
    with run.decoding():
        run.limit(lanes, end - begin, program.limit)
        run.grow(lanes)
