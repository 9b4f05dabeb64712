"""A size kernel does not ask where a list starts that it only counts: the encoder asks, which is what goes there.

How much room a text or an array of numbers takes follows from its count. In a holder that somebody has damaged, the check of the start is
then the encoder's alone.
"""

from __future__ import annotations

from collections import Counter

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Binary, Block, Compare, Const, Expect, Expr, Let, Local, Used
from rosetta_jit.kernel.rewrite import with_blocks, with_bodies
from rosetta_jit.kernel.walk import flat, parts_of

READS = 2
"""How often the check of a start reads it."""


def neglect(kernel: Kernel) -> Kernel:
    """A size kernel without starts that nothing but their checks reads."""
    return with_bodies(kernel, tuple(map(_body, kernel.bodies)))


def _body(body: Block) -> Block:
    every = flat(body)
    checks = {name: stmt for stmt in every if type(stmt) is Expect and (name := _start_in(stmt.condition)) is not None}
    if not checks:
        return body
    reads = Counter([part.name for part in parts_of(every) if type(part) is Local and part.name in checks])
    idle = {name for name in checks if reads[name] == READS}
    needless = {id(checks[name]) for name in idle}

    def kept(block: Block) -> Block:
        return tuple([with_blocks(stmt, kept) for stmt in block if not (id(stmt) in needless or (type(stmt) is Let and stmt.name in idle))])

    return kept(body) if idle else body


def _start_in(condition: Expr) -> str | None:
    """The name of a start, if a condition says that so many rows from there on are in use."""
    match condition:
        case Binary(
            "and",
            Compare("ge", Local(_, name), Const("i64", 0)),
            Compare("le", Local(_, same), Binary("sub", Used(), _)),
        ) if same == name:
            return name
        case _:
            return None
