"""Conditions around loops that only say that there are rounds: a loop of none does nothing."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Block, Compare, Const, Expr, For, If, Stmt
from rosetta_jit.kernel.rewrite import with_blocks


def without_guards(block: Block) -> Block:
    """A block with the loop in place of each `if count > 0:` that has nothing but a loop of so many rounds."""
    found: list[Stmt] = []
    for old in block:
        stmt = with_blocks(old, without_guards)
        match stmt:
            case If(Compare("gt", count, Const(_, 0)), then, ()) if _is_loop_of(then, count):
                found += then
            case _:
                found.append(stmt)
    return tuple(found)


def _is_loop_of(block: Block, count: Expr) -> bool:
    match block:
        case (For(_, rounds, _),):
            return rounds == count
        case _:
            return False
