"""How many rounds of a loop LLVM is to do at once, where it would do fewer than pay.

That is so of loops that put three or four streams of bytes together, or take them apart, as the channels of an image:
`.a[3 * i + c] = .b[n * c + i]`.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cache

from llvmlite import binding, ir

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import type_of

ROUNDS = 64
"""As many as the widest registers have bytes. LLVM takes half of it, and needs as many instructions for that."""

STREAMS = (3, 4)


@cache
def are_known() -> bool:
    """Whether this machine moves bytes about in wide registers: where one cannot, it would do each byte by itself."""
    machine = os.uname().machine if hasattr(os, "uname") else ""
    return machine in ("aarch64", "arm64") or "+avx2" in binding.get_host_cpu_features().flatten().split(",")


def joins_streams(loop: nodes.For, strides: Sequence[int]) -> bool:
    """Whether the rounds of a loop do nothing but move so many bytes, each next to that of the round or of the stream before.

    LLVM reports of a loop for which it is told a width that it cannot do so; this one it can, whatever it has to find out before.
    """
    moves = [each for each in loop.body if isinstance(each, nodes.Store | nodes.SetField)]
    if len(moves) not in STREAMS:
        return False
    steps: dict[str, int | None] = {loop.variable: 1}
    for each in loop.body:
        match each:
            case nodes.Let(name, value) if type_of(value) == "i64":
                steps[name] = _step(value, steps)
            case nodes.Let(_, value) | nodes.Store(_, value) | nodes.SetField(_, value):
                places = [_place(part, strides) for part in (each, value) if not isinstance(part, nodes.Let | nodes.Local)]
                if type_of(value) != "u8" or any(place is None or _step(place, steps) not in (1, len(moves)) for place in places):
                    return False
            case _:
                return False
    return True


def _place(part: nodes.Stmt | nodes.Expr, strides: Sequence[int]) -> nodes.Expr | None:
    """Which byte is moved, of the message or of a lane of bytes."""
    match part:
        case nodes.Store(at) | nodes.Load(_, at):
            return at
        case nodes.SetField(place) | nodes.Get(_, place) if strides[place.lane] == 1:
            return place.row
        case _:
            return None


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
