"""How many rounds of a loop LLVM is to do at once, where it would do fewer than pay.

That is so of loops that put three or four streams of bytes together, as planes become pixels: `.message[3 * i + c] = .lane[n * c + i]`.
Those that take streams apart gain where rows have a multiple of 64 pixels, and lose more where they have not.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cache

from llvmlite import binding, ir

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import type_of

ROUNDS = 64
"""As many as the widest registers have bytes. LLVM takes half of it, and needs as many instructions for that. What is left it does so."""

STREAMS = (3, 4)


@cache
def are_known() -> bool:
    """Whether this machine moves bytes about in wide registers: where one cannot, it would do each byte by itself."""
    machine = os.uname().machine if hasattr(os, "uname") else ""
    return machine in ("aarch64", "arm64") or "+avx2" in binding.get_host_cpu_features().flatten().split(",")


def joins_streams(loop: nodes.For, strides: Sequence[int]) -> bool:
    """Whether the rounds of a loop do nothing but write so many bytes, each next to that of the round or of the stream before.

    LLVM reports of a loop for which it is told a width that it cannot do so; this one it can, whatever it has to find out before.
    """
    count = sum(isinstance(each, nodes.Store) for each in loop.body)
    if count not in STREAMS:
        return False
    steps: dict[str, int | None] = {loop.variable: 1}
    for each in loop.body:
        match each:
            case nodes.Let(name, value) if type_of(value) == "i64":
                steps[name] = _step(value, steps)
            case nodes.Let(_, value) if _is_moved(value, steps, strides, count):
                pass
            case nodes.Store(at, nodes.Local("u8")) if _step(at, steps) == count:
                pass
            case nodes.Store(at, value) if _step(at, steps) == count and _is_moved(value, steps, strides, count):
                pass
            case _:
                return False
    return True


def _is_moved(value: nodes.Expr, steps: dict[str, int | None], strides: Sequence[int], count: int) -> bool:
    """Whether a byte is of the message or of a lane of bytes, next to that of the round or of the stream before."""
    match value:
        case nodes.Load("u8", at):
            return _step(at, steps) in (1, count)
        case nodes.Get("u8", place) if strides[place.lane] == 1:
            return _step(place.row, steps) in (1, count)
        case _:
            return False


def _step(value: nodes.Expr, steps: dict[str, int | None]) -> int | None:
    """By how much a number grows with each round; None where that is no constant."""
    match value:
        case nodes.Const():
            return 0
        case nodes.Local(_, name):
            return steps.get(name, 0)
        case nodes.Binary("add" | "sub" as op, left, right):
            one, other = _step(left, steps), _step(right, steps)
            return None if one is None or other is None else one + other if op == "add" else one - other
        case nodes.Binary("mul", left, nodes.Const(_, factor)) if (step := _step(left, steps)) is not None:
            return step * int(factor)
        case nodes.Binary(_, left, right):
            return 0 if _step(left, steps) == _step(right, steps) == 0 else None
        case nodes.Convert(_, operand):
            return 0 if _step(operand, steps) == 0 else None
        case _:
            return None


def widen(module: ir.Module, latch: ir.Terminator) -> None:
    """Tell LLVM so of the loop that ends with a branch."""
    width = module.add_metadata([ir.MetaDataString(module, "llvm.loop.vectorize.width"), ir.Constant(ir.IntType(32), ROUNDS)])
    loop = ir.MDValue(module, (), str(len(module.metadata)))
    loop.operands = (loop, width)  # what is said of a loop begins with itself, so that it is of no other one
    latch.set_metadata("llvm.loop", loop)
