"""Positions behind padding, computed from what is before it: `(next + 3) & -4` rather than `next + padding`.

Each text of a list begins where the one before ends, so that a processor waits for every operation between them: two, instead of four.
"""

from __future__ import annotations

from rosetta_jit.generate.passes.positions import bound_in
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import locals_in, with_blocks
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.startup.dataclass import replace


def aligned(block: nodes.Block) -> dict[str, nodes.Expr]:
    """For locals of a block that are positions behind padding another form of their value."""
    paddings, found = dict[nodes.Expr, nodes.Expr](), dict[str, nodes.Expr]()
    for stmt in block:
        if isinstance(stmt, nodes.Let) and stmt.value in paddings:
            found[stmt.name] = paddings[stmt.value]
        if paddings:
            bound = bound_in(stmt)
            paddings = {before: other for before, other in paddings.items() if bound.isdisjoint(locals_in(before))}
        match stmt:
            case nodes.Let(padding, nodes.Binary("and", nodes.Binary("sub", nodes.Const("i64", origin), before), nodes.Const("i64", mask))):
                lower = int(mask)
                if (lower + 1) & lower == 0 and int(origin) & lower == 0:
                    behind = nodes.Binary("and", add(before, lower), index(~lower))
                    paddings[add(before, nodes.Local("i64", padding))] = behind
            case _:
                pass
    return found


def as_printed(block: nodes.Block) -> nodes.Block:
    """A block whose locals have these values, as have those of the blocks in it."""
    others = aligned(block)
    values = (replace(stmt, value=others[stmt.name]) if isinstance(stmt, nodes.Let) and stmt.name in others else stmt for stmt in block)
    return tuple(with_blocks(stmt, as_printed) for stmt in values)
