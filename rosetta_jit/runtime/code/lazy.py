"""Lazy binding, as dynamic linkers do it: a function has an address before there is code for it, and its first call finds the code.

For x86-64 (System V ABI). A function jumps to where its slot says. At first that is its own second half: it calls the function's finder, a
Python object without arguments, which writes the slot, and then jumps there with the arguments as they were. A finder that fails has set
Python's error: then the caller is given the function's failure. Functions have up to four arguments, all of them integers or pointers.

The instructions are so few that they stand here as bytes: LLVM, to assemble them, would take longer than all else that a process does with
accessors before it calls one.
"""

from __future__ import annotations

import ctypes
import os
import struct
import sys
from collections.abc import Callable, Mapping, Sequence

from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.prelinked import Prelinked, data_offset, to_bytes

TABLES = ("slots", "finders", "failures")
"""Numbers of 8 bytes, one for each function. Python fills them when the code is loaded."""

CALLS = ("PyObject_CallNoArgs", "Py_DecRef")

STUB = struct.Struct("<2siBIBi")
"""``jmp *slot(%rip)``, ``mov $number, %eax``, ``jmp find``."""

JUMP_BYTES = 6
"""Of the first instruction of a stub; behind it is what an unbound one does."""

FIND = (
    ("57 56 52 51 50", ""),  # push %rdi, %rsi, %rdx, %rcx, %rax: now the stack is aligned as calls want it
    ("48 8d 3d", "finders"),  # lea finders(%rip), %rdi
    ("48 8b 3c c7", ""),  # mov (%rdi,%rax,8), %rdi
    ("ff 15", "PyObject_CallNoArgs"),  # call *PyObject_CallNoArgs(%rip)
    ("48 85 c0", ""),  # test %rax, %rax
    ("0f 84", "failed"),  # je failed
    ("48 89 c7", ""),  # mov %rax, %rdi
    ("ff 15", "Py_DecRef"),  # call *Py_DecRef(%rip)
    ("58 59 5a 5e 5f", ""),  # pop %rax, %rcx, %rdx, %rsi, %rdi
    ("4c 8d 15", "slots"),  # lea slots(%rip), %r10
    ("41 ff 24 c2", ""),  # jmp *(%r10,%rax,8)
)
FAILED = (
    ("58", ""),  # pop %rax
    ("48 83 c4 20", ""),  # add $32, %rsp
    ("4c 8d 15", "failures"),  # lea failures(%rip), %r10
    ("49 8b 04 c2", ""),  # mov (%r10,%rax,8), %rax
    ("c3", ""),  # ret
)
"""Instructions, and what they refer to: its distance from their end is their last four bytes."""


def is_supported() -> bool:
    """Whether there are stubs for this machine and system."""
    return sys.platform == "linux" and os.uname().machine == "x86_64"


def stubs_of(names: Sequence[str]) -> bytes:
    """Stubs of functions, as `runtime.code.native` loads them."""
    find = STUB.size * len(names)
    failed = find + _size(FIND)
    calls = -(-(failed + _size(FAILED)) // 8) * 8
    size = 8 * len(names)
    begin = data_offset(bytes(calls + 8 * len(CALLS)))
    tables = {name: begin + number * size for number, name in enumerate(TABLES)}
    places = {**tables, "failed": failed} | {name: calls + 8 * number for number, name in enumerate(CALLS)}
    stubs = b"".join(_stub(number, tables["slots"], find) for number in range(len(names)))
    code = b"".join((stubs, _assembled(FIND, find, places), _assembled(FAILED, failed, places)))
    gives = {name: STUB.size * number for number, name in enumerate(names)} | tables
    return to_bytes(Prelinked(code.ljust(calls + 8 * len(CALLS), b"\0"), bytes(size * len(TABLES)), calls, CALLS, gives))


def _stub(number: int, slots: int, find: int) -> bytes:
    begin = STUB.size * number
    return STUB.pack(b"\xff\x25", slots + 8 * number - (begin + JUMP_BYTES), 0xB8, number, 0xE9, find - (begin + STUB.size))


def _size(instructions: Sequence[tuple[str, str]]) -> int:
    return sum(len(bytes.fromhex(opcode)) + 4 * bool(operand) for opcode, operand in instructions)


def _assembled(instructions: Sequence[tuple[str, str]], begin: int, places: Mapping[str, int]) -> bytes:
    """The bytes of instructions that begin at a place."""
    code = bytearray()
    for opcode, operand in instructions:
        code += bytes.fromhex(opcode)
        if operand:
            code += struct.pack("<i", places[operand] - (begin + len(code) + 4))
    return bytes(code)


class Stubs:
    """The stubs of functions, loaded.

    Parameters
    ----------
    finders
        By name, what is called when a function is first called. It calls `bind`, or raises an error.
    failures
        What a function gives its caller when its finder has failed, where that is not 0, the null pointer.
    """

    def __init__(self, finders: Mapping[str, Callable[[], object]], failures: Mapping[str, int]) -> None:
        own = f"stubs {id(self)}"  # the tables are filled for these stubs alone, and what they refer to ends with them
        self._code = native.load(stubs_of((*finders,)), (*finders, *TABLES), program=own)
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
