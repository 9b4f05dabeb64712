"""Kernels that count what is in use of a list, for the pass that looks for starts that nobody needs."""

from __future__ import annotations

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Binary, Compare, Direction, Expect, Expr, Get, If, Let, Place, Return, Stmt, Used, Var
from rosetta_jit.kernel.terms import ROW, index
from tests.kernel.kernels import ROW_EXISTS, expect, i64, kernel

START, COUNT = Let("start", Get("i64", Place(0, ROW))), Let("count", Get("i64", Place(0, ROW, 8)))


def inside(number: str, most: Expr) -> Expect:
    return expect(Binary("and", Compare("ge", i64(number), index(0)), Compare("le", i64(number), most)))


COUNTED, INSIDE = inside("count", Used(1)), inside("start", Binary("sub", Used(1), i64("count")))
LIST = (START, COUNT, COUNTED, INSIDE)


def list_kernel(*body: Stmt, direction: Direction = "size") -> Kernel:
    """A kernel that counts the bytes in use of a list, or writes nothing else of it."""
    return kernel((ROW_EXISTS, *LIST, *body, Return(i64("count"))), strides=(16, 1), direction=direction)


IN_A_BRANCH = (Var("size", index(0)), If(Compare("gt", ROW, index(0)), (START, COUNT, COUNTED, INSIDE)), Return(i64("size")))
OTHERS = expect(Binary("and", Compare("ge", i64("count"), index(0)), Compare("le", i64("start"), Binary("sub", Used(1), i64("count")))))

SIZED = {
    "a start that is only checked": list_kernel(),
    "a start that the encoder checks": list_kernel(direction="encode"),
    "a start that is read": list_kernel(Let("next", Compare("eq", i64("start"), index(0)))),
    "a start that is checked twice": list_kernel(INSIDE),
    "a start within a branch": kernel((ROW_EXISTS, *IN_A_BRANCH), strides=(16, 1), direction="size"),
    "a check of other numbers": kernel(
        (ROW_EXISTS, START, COUNT, COUNTED, OTHERS, Return(i64("count"))), strides=(16, 1), direction="size"
    ),
}
