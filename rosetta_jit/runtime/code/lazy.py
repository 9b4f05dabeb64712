"""Lazy binding, as dynamic linkers do it: a function has an address before there is code for it, and its first call finds the code."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable, Mapping, Sequence

from rosetta_jit.runtime.code import native

TABLES = ("slots", "finders", "failures")
STUB = """.globl {name}
.p2align 4
{name}:
jmpq *slots+{offset}(%rip)
movl ${number}, %eax
jmp find"""
JUMP_BYTES = 6
"""Of the first instruction of a stub; behind it is what an unbound one does."""


def is_supported() -> bool:
    """Whether there are stubs for this machine and system."""
    return sys.platform == "linux" and os.uname().machine == "x86_64"


def stubs_text(names: Sequence[str]) -> str:
    """Stubs of functions as an LLVM module."""
    from pathlib import Path
    from string import Template  # both are slow to import

    stubs = "\n".join(STUB.format(name=name, offset=8 * number, number=number) for number, name in enumerate(names))
    template = Template(Path(__file__).with_name("lazy_x86_64.s").read_text("utf-8"))
    lines = template.substitute(stubs=stubs, size=8 * len(names), functions=f"{len(names)} functions").splitlines()
    return "\n".join(f'module asm "{line}"' for line in lines if not line.startswith("#"))


class Stubs:
    """The stubs of functions, loaded.

    Parameters
    ----------
    image
        What `stubs_text` of the names is assembled to.
    finders
        By name, in the order of the stubs, what is called when a function is first called. It calls `bind`, or raises an error.
    failures
        What a function gives its caller when its finder has failed, where that is not 0, the null pointer.
    """

    def __init__(self, image: bytes, finders: Mapping[str, Callable[[], object]], failures: Mapping[str, int]) -> None:
        own = f"stubs {id(self)}"  # the tables are filled for these stubs alone, and what they refer to ends with them
        self._code = native.load(image, (*finders, *TABLES), program=own)
        self._numbers = {name: number for number, name in enumerate(finders)}
        self._finders = tuple(finders.values())  # the table has no references of its own
        self._slots, called, when_failed = (self._table(name) for name in TABLES)
        for number, (name, finder) in enumerate(finders.items()):
            self._slots[number], called[number], when_failed[number] = self[name] + JUMP_BYTES, id(finder), failures.get(name, 0)

    def _table(self, name: str) -> ctypes.Array[ctypes.c_int64]:
        return (ctypes.c_int64 * len(self._numbers)).from_address(self._code[name])

    def __getitem__(self, name: str) -> int:
        """The address of a function, which is good whether it is bound or not."""
        return self._code[name]

    def bind(self, name: str, address: int) -> None:
        """From now on, let calls of a function go to code at an address, which must live as long as the stubs."""
        self._slots[self._numbers[name]] = address
