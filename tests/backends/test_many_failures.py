"""Bodies of very many checks: each failure stores what it reports, and reports what the interpreter does."""

from __future__ import annotations

import pytest

from rosetta_jit.backends.entry.link import llvm_text
from rosetta_jit.kernel.ir import Compare, Const, Expect, For, Load, Local, Require, Return
from rosetta_jit.kernel.proof.verify import verify
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from tests.backends.engines import outcome
from tests.backends.holders import rows
from tests.backends.kernels import failure, kernel

BYTES, ROUNDS = 600, 3


def checked(*, goes_wrong_at=1):
    """Two attempts: all bytes are 0, the last of them in three rounds; or the byte at a place is 7."""
    every = [Expect(Compare("eq", Load("u8", add(BEGIN, at)), Const("u8", 0)), failure(2, add(BEGIN, at))) for at in range(BYTES)]
    number = Local("i64", "number")
    last = Expect(Compare("eq", Load("u8", add(BEGIN, BYTES)), Const("u8", 0)), failure(3, add(BEGIN, BYTES), number))
    size = Require(BEGIN, index(BYTES + 1), failure(1))
    second = Expect(Compare("eq", Load("u8", add(BEGIN, goes_wrong_at)), Const("u8", 7)), failure(4, add(BEGIN, goes_wrong_at), index(5)))
    first = (size, *every, For(number.name, Const("i64", ROUNDS), (last,)), Return(END))
    return kernel(first, (size, second, Return(END)), strides=(8,), name="checked")


@pytest.mark.parametrize("at", [1, 300, BYTES])
@pytest.mark.parametrize("name", ["llvm", "python"])
@pytest.mark.parametrize("wrong", [None, 0, 1, 299, BYTES - 1, BYTES])
def test_failures_are_those_of_the_interpreter(name, wrong, at):
    made = checked(goes_wrong_at=at)
    verify(made)
    message = bytes(9 if place == wrong else 0 for place in range(BYTES + 1))
    assert outcome(name, made, message, rows(made)) == outcome("interpreter", made, message, rows(made))


def test_no_instruction_names_all_failures():
    text = llvm_text([checked()], "decode", with_numba=False)
    assert max(line.count("[ ") for line in text.splitlines() if "= phi " in line) < 64
