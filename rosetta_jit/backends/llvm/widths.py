"""How many rounds of a loop LLVM is to do at once, where it would do fewer than pay.

That is so of loops that put three or four streams of bytes together, as planes become pixels: `.message[3 * i + c] = .lane[n * c + i]`.
What is left behind whole turns is another loop. Of those that take streams apart it is so where nothing is left: LLVM makes a poor loop
of the rest.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cache
from typing import Literal

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


def streams_of(loop: nodes.For, strides: Sequence[int]) -> Literal["joined", "taken apart"] | None:
    """What the rounds of a loop do with so many streams of bytes; None where they do anything else.

    LLVM reports of a loop for which it is told a width that it cannot do so; these it can, whatever it has to find out before.
    """
    steps: dict[str, int | None] = {loop.variable: 1}
    read, written = list[int | None](), list[int | None]()
    for each in loop.body:
        match each:
            case nodes.Let(name, value) if type_of(value) == "i64":
                steps[name] = _step(value, steps)
                continue
            case nodes.Let(_, value):
                pass
            case nodes.Store(at, value):
                written.append(_step(at, steps))
            case nodes.SetField(place, value) if strides[place.lane] == 1:
                written.append(_step(place.row, steps))
            case _:
                return None
        if not (isinstance(value, nodes.Local) and value.type == "u8"):
            read.append(_step_of_byte(value, steps, strides))
    count = len(written)
    if count not in STREAMS or not {*read} <= {1, count}:
        return None
    return "joined" if {*written} == {count} else "taken apart" if ({*read}, {*written}) == ({count}, {1}) else None


def _step_of_byte(value: nodes.Expr, steps: dict[str, int | None], strides: Sequence[int]) -> int | None:
    """By how much the place of a byte grows with each round, in the message or in a lane of bytes; None for anything else."""
    match value:
        case nodes.Load("u8", at):
            return _step(at, steps)
        case nodes.Get("u8", place) if strides[place.lane] == 1:
            return _step(place.row, steps)
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
