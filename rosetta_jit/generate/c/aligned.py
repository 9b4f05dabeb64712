"""Positions behind padding, computed from what is before it: `(next + 3) & -4` rather than `next + padding`.

Each text of a list begins where the one before ends, so that a processor waits for every operation between them: two, instead of four.
"""

from __future__ import annotations

from dataclasses import replace

from rosetta_jit.generate.c.positions import bound_in
from rosetta_jit.kernel import ir
from rosetta_jit.kernel.rewrite import locals_in, with_blocks
from rosetta_jit.kernel.terms import add, index


def aligned(block: ir.Block) -> dict[str, ir.Expr]:
    """For locals of a block that are positions behind padding another form of their value."""
    paddings, found = dict[ir.Expr, ir.Expr](), dict[str, ir.Expr]()
    for stmt in block:
        if isinstance(stmt, ir.Let) and stmt.value in paddings:
            found[stmt.name] = paddings[stmt.value]
        bound = bound_in(stmt)
        paddings = {before: other for before, other in paddings.items() if bound.isdisjoint(locals_in(before))}
        match stmt:
            case ir.Let(padding, ir.Binary("and", ir.Binary("sub", ir.Const("i64", origin), before), ir.Const("i64", mask))):
                lower = int(mask)
                if (lower + 1) & lower == 0 and int(origin) & lower == 0:
                    behind = ir.Binary("and", add(before, lower), index(~lower))
                    paddings[add(before, ir.Local("i64", padding))] = behind
            case _:
                pass
    return found


def as_printed(block: ir.Block) -> ir.Block:
    """A block whose locals have these values, as have those of the blocks in it."""
    others = aligned(block)
    values = (replace(stmt, value=others[stmt.name]) if isinstance(stmt, ir.Let) and stmt.name in others else stmt for stmt in block)
    return tuple(with_blocks(stmt, as_printed) for stmt in values)
