"""Decoders that keep in locals what they read again of a row: nothing then needs the row, and the object alone has its numbers.

set lane 0[0].24 = load i32> [at]           let kept = load i32> [at]
let told = get i32 lane 0[0].24             set lane 0[0].24 = kept
                                            let told = kept
"""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Block, Expr, Get, Let, Local, Place, Scalar, SetField, Stmt
from rosetta_jit.kernel.rewrite import with_blocks, with_expressions, with_operands
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.startup.dataclass import replace


def with_numbers_kept(block: Block, lane: int) -> Block:
    """A block that does so with the numbers that it sets once, in any case, in its row of a lane: as LCM's counts of lists."""
    stmts = [stmt for stmt, _ in statements(block)]
    sets = [stmt.place.offset for stmt in stmts if isinstance(stmt, SetField) and stmt.place.lane == lane]
    parts = (part for stmt in stmts for expr in expressions_of(stmt) for part in subexpressions(expr))
    read = {(part.place.offset, part.type) for part in parts if isinstance(part, Get) and part.place.lane == lane}
    known, found = dict[tuple[int, Scalar], Local](), list[Stmt]()

    def kept(stmt: Stmt) -> Stmt:
        return with_blocks(with_expressions(stmt, put), lambda inner: tuple(map(kept, inner)))

    def put(expr: Expr) -> Expr:
        match expr:
            case Get(type_, Place(own, _, offset)) if own == lane and (offset, type_) in known:
                return known[offset, type_]
            case _:
                return with_operands(expr, put)

    for each in map(kept, block):
        match each:
            case SetField(Place(own, _, offset), value) if own == lane and sets.count(offset) == 1 and (offset, type_of(value)) in read:
                local = Local(type_of(value), f"kept\0{offset}")
                known[offset, local.type] = local
                found += [Let(local.name, value), replace(each, value=local)]
            case _:
                found.append(each)
    return tuple(found)
