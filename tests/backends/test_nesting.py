"""What nests as deep as the kernel's grammar allows still compiles."""

from __future__ import annotations

import pytest

from rosetta_jit.backends.entry.link import compile_program
from rosetta_jit.backends.python.function import compile_python
from rosetta_jit.kernel.nodes import Binary as Operation
from rosetta_jit.kernel.nodes import Compare, Const, Expr, For, If, Load, Require, Return
from rosetta_jit.kernel.terms import BEGIN, index
from tests.backends import kernels
from tests.backends.engines import ENGINES, outcome
from tests.backends.holders import rows


def deep_expression(depth: int) -> Expr:
    sum_: Expr = Load("u8", BEGIN)
    for _ in range(depth):
        sum_ = Operation("xor", Const("u8", 1), sum_)
    return sum_


def test_deep_expressions():
    condition = Compare("eq", deep_expression(98), Const("u8", 5))
    kernel = kernels.kernel(
        (Require(BEGIN, index(1), kernels.failure(1)), If(condition, (Return(index(1)),)), Return(index(0))), strides=(8,)
    )
    for backend in ENGINES:
        assert outcome(backend, kernel, b"\5", rows(kernel)) == outcome("interpreter", kernel, b"\5", rows(kernel))


def test_deep_blocks():
    body = (Return(index(1)),)
    for number in range(95):
        body = (If(Compare("ge", BEGIN, index(number - 200)), body),)
    kernel = kernels.kernel((*body, Return(index(0))), strides=(8,))
    for backend in ENGINES:
        assert outcome(backend, kernel, b"", rows(kernel))[0] == 1


def nests_loops(depth):
    """Whether this Python compiles so many loops within each other: up to 3.12 it takes twenty."""
    try:
        compile("".join(f"{' ' * number}for i in a:\n" for number in range(depth)) + " " * depth + "pass\n", "loops", "exec")
    except SyntaxError:
        return False
    return True


@pytest.mark.skipif(nests_loops(21), reason="this Python knows no such limit")
def test_python_says_when_loops_are_too_deep():
    body = (Return(index(1)),)
    for number in range(21):
        body = (For(f"i{number}", index(1), body),)
    kernel = kernels.kernel((*body, Return(index(0))), strides=(8,))
    assert compile_program([kernel], "decode", with_numba=False)
    with pytest.raises(SyntaxError, match="nested"):
        compile_python(kernel)
