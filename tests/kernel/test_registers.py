"""Registers: what a kernel keeps from one message to the next, alike on every backend, and only of messages that it handled."""

from __future__ import annotations

import ctypes
from functools import partial

import numpy as np
import pytest

from rosetta_jit.backends.entry.link import compile_program
from rosetta_jit.backends.python.function import compile_python
from rosetta_jit.kernel import interpret
from rosetta_jit.kernel.entries import SYMBOLS
from rosetta_jit.kernel.ir import Kernel, Routine, Site
from rosetta_jit.kernel.nodes import (
    Binary,
    Capacity,
    Compare,
    Const,
    Convert,
    Expect,
    Failure,
    If,
    Let,
    Load,
    Local,
    Place,
    Register,
    Require,
    Return,
    SetField,
)
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.printer import to_text
from rosetta_jit.kernel.proof.verify import VerificationError, verify
from rosetta_jit.kernel.shape import shape_error
from rosetta_jit.kernel.state import ADDRESS, CAPACITY, REGISTERS, STRIDE, lane_word, state_words
from rosetta_jit.kernel.terms import BEGIN, END, ROW, index
from rosetta_jit.kernel.traits import registers_read
from rosetta_jit.runtime.code import native
from tests.backends.holders import KERNEL

FAILED, TRUNCATED = Failure(1, BEGIN), Failure(2, BEGIN)
SITES = Site("grow", "", ""), Site("rejected", ".a", "no"), Site("truncated", ".a", "the message ends here")
BYTE = Local("i64", "byte")
HAS_ROW = Expect(Compare("lt", ROW, Capacity(0)), FAILED)
READ = Require(BEGIN, index(1), TRUNCATED), Let("byte", Convert("i64", Load("u8", BEGIN)))
SWAPPED = (0, Register(1)), (1, Register(0)), (2, BYTE)


def kernel(*bodies, registers=3, routines=()):
    return Kernel("k", "decode", (16,), bodies, SITES, routines, registers=registers)


SWAPPING = kernel(
    (
        HAS_ROW,
        *READ,
        Expect(Compare("ne", BYTE, index(9)), FAILED),
        SetField(Place(0, ROW), Register(0)),
        SetField(Place(0, ROW, 8), Register(2)),
        If(Compare("lt", BYTE, index(100)), (Return(END, SWAPPED),), (Return(END),)),
    ),
    (HAS_ROW, READ[0], Expect(Compare("eq", Load("u8", BEGIN), Const("u8", 9)), FAILED), Return(END, ((1, index(90)),))),
)
"""Two registers change places and a third gets the message's byte; of bytes from 100 on none changes, and 9 is another body's."""


def interpreted(made):
    return partial(interpret.run, made)


def compiled(made, *, with_numba):
    library = native.load(compile_program([made], "decode", with_numba=with_numba), SYMBOLS["decode"])
    code = KERNEL(library["kernel"])

    def run(message, begin, end, state, lanes, row, registers):
        state[REGISTERS], state[lane_word(0, ADDRESS)] = registers.ctypes.data, lanes[0].ctypes.data
        data = (ctypes.c_char * max(end, 1)).from_buffer_copy(bytes(message) or b"\0")
        return code(ctypes.addressof(data), begin, end, state.ctypes.data, row)

    run.library = library  # keeps the code
    return run


BACKENDS = {
    "interpreter": interpreted,
    "python": compile_python,
    "llvm": partial(compiled, with_numba=False),
    "numba": partial(compiled, with_numba=True),
}


@pytest.mark.parametrize("changed", [lambda same: same, passes.run], ids=["written", "improved"])
@pytest.mark.parametrize("backend", BACKENDS.values(), ids=BACKENDS)
def test_backends_agree(changed, backend):
    made = changed(SWAPPING)
    verify(made)
    run = backend(made)
    state, lanes, registers = np.zeros(state_words(1), np.int64), [np.zeros(16, np.uint8)], np.array([1, 2, -3], np.int64)
    state[lane_word(0, CAPACITY)], state[lane_word(0, STRIDE)] = 1, 16

    def ran(*message):
        return run(bytearray(message), 0, len(message), state, lanes, 0, registers), registers.tolist()

    assert ran(7) == (1, [2, 1, 7])
    assert lanes[0].view(np.int64).tolist() == [1, -3]
    assert ran(100) == (1, [2, 1, 7])
    assert lanes[0].view(np.int64).tolist() == [2, 7]
    assert ran() == (-3, [2, 1, 7]), "a message that fails changes no register"
    assert ran(8) == (1, [1, 2, 8])
    assert ran(9) == (1, [1, 90, 8]), "of a body that failed nothing is kept"


def test_their_text():
    text = to_text(SWAPPING)
    assert "strides [16], 3 registers" in text
    assert "return end with register(0) = register(1), register(1) = register(0), register(2) = byte" in text
    assert registers_read(SWAPPING) == {0, 1, 2}


@pytest.mark.parametrize(
    ("body", "why"),
    [
        ((Let("x", Register(3)), Return(END)), "no register 3"),
        ((Let("x", Register(-1)), Return(END)), "no register -1"),
        ((Return(END, ((3, index(0)),)),), "no register 3"),
        ((Return(END, ((1, index(0)), (1, index(0)))),), "a register that is set twice"),
    ],
)
def test_registers_that_there_are_not(body, why):
    assert shape_error(kernel(body)) == why


def test_routines_have_none():
    routine = Routine("r", (), (), (Let("x", Register(0)),), (), (), SITES[:1])
    assert shape_error(kernel((Return(END),), routines=(routine,))) == "routine r: something that only a body can do"


@pytest.mark.parametrize(
    ("body", "why"),
    [
        ((HAS_ROW, SetField(Place(0, Register(0)), index(0)), Return(END)), "a row that may be negative"),
        ((Let("x", Binary("add", Register(0), index(1))), Return(END)), "wrap"),
        ((Return(END, ((0, Const("f64", 1.0)),)),), "f64 where i64 belongs"),
        ((Return(END, ((0, Local("i64", "none")),)),), "not visible"),
    ],
)
def test_nothing_is_known_of_a_register(body, why):
    with pytest.raises(VerificationError, match=why):
        verify(kernel(body))


def test_a_register_is_the_same_wherever_it_stands():
    verify(kernel((Let("none", Binary("sub", Register(0), Register(0))), Return(Local("i64", "none")))))
