"""A kernel for one message that begins at byte 0, in row 0 of a holder that has this row: all that is proven of any message holds of it."""

from __future__ import annotations

from rosetta_jit.kernel.ir import Kernel, Routine
from rosetta_jit.kernel.nodes import Binary, Block, Capacity, Compare, Expect, Expr, Failure, Local
from rosetta_jit.kernel.passes.fold import TRUE, folded
from rosetta_jit.kernel.rewrite import with_blocks, with_expressions, with_operands
from rosetta_jit.kernel.terms import BEGIN, ROW, index
from rosetta_jit.startup.dataclass import replace

KNOWN = {BEGIN.name: index(0), ROW.name: index(0)}


def alone(kernel: Kernel) -> Kernel:
    """The kernel where `begin` and `row` are 0, and lane 0 has one row.

    Nothing but that is put in place, and computed: what was proven of the kernel for all messages needs no other proof for these.
    """
    return replace(kernel, bodies=tuple(map(_block, kernel.bodies)), routines=tuple(map(_routine, kernel.routines)))


def _routine(routine: Routine) -> Routine:
    requires, ensures = (tuple(map(_expression, some)) for some in (routine.requires, routine.ensures))
    return replace(routine, body=_block(routine.body), requires=requires, ensures=ensures)


def _block(body: Block) -> Block:
    known = (with_blocks(with_expressions(stmt, _expression), _block) for stmt in body)
    return tuple(stmt for stmt in known if not (isinstance(stmt, Expect) and stmt.condition == TRUE))


def _expression(expr: Expr) -> Expr:
    match expr:
        case Local(_, name) if name in KNOWN:
            return KNOWN[name]
        case Capacity(0):
            return index(1)
        case _:
            return folded(with_operands(expr, _expression))


def as_proven(kernel: Kernel) -> Kernel:
    """What `verify` must prove of such a kernel: it is safe wherever the message begins at 0 and lane 0 has a row."""
    at_0 = Compare("eq", BEGIN, index(0))
    assumed = Expect(Binary("and", at_0, Compare("gt", Capacity(0), index(0))), Failure(1, BEGIN))
    routines = tuple(replace(each, requires=(at_0, *each.requires)) for each in kernel.routines)
    return replace(kernel, bodies=tuple((assumed, *body) for body in kernel.bodies), routines=routines)
