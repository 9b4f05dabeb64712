r"""Fields that an encoder leaves out where they have their default: what is not written is looked at once, and nothing else asks.

read_1 = _within(target.a, 0, 4294967295)           if _index(target.a) != 0:
if read_1 != 0:                                         parts += b"\x08", _varint(_within(target.a, 0, 4294967295))
    parts += b"\x08", _varint(read_1)
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from rosetta_jit.kernel.nodes import Block, Compare, Const, Expr, Get, If, Let, Local, Place, Stmt
from rosetta_jit.kernel.rewrite import substituted, with_blocks, with_expressions
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions


def reads_of(block: Block) -> Counter[str]:
    """How often anything reads a local."""
    exprs = (expr for stmt, _ in statements(block) for expr in expressions_of(stmt))
    return Counter(part.name for expr in exprs for part in subexpressions(expr) if isinstance(part, Local))


def asked_first(block: Block, reads: Counter[str], is_number: Callable[[Place], bool]) -> Block:
    """A block that asks whether a number is not 0 before it does anything else with it."""
    found: list[Stmt] = []
    for stmt in block:
        match found[-1] if found else None, stmt:
            case Let(name, Get(_, place) as value) as let, If(Compare("ne", Local(_, same), Const(_, 0)) as condition, then, ()) if (
                name == same and is_number(place) and 0 < reads_of(then)[name] == reads[name] - 1
            ):
                asked = Compare("ne", value, condition.right)
                found[-1] = If(asked, _put(then, name, value) if reads[name] == 2 else (let, *then), ())
            case _:
                found.append(stmt)
    return tuple(found)


def _put(block: Block, name: str, value: Expr) -> Block:
    """A block with a value in place of a local."""

    def put(stmt: Stmt) -> Stmt:
        stmt = with_expressions(stmt, lambda expr: substituted(expr, {name: value}))
        return with_blocks(stmt, lambda inner: _put(inner, name, value))

    return tuple(map(put, block))
