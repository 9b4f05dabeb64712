"""Integers of objects that an encoder compares and writes: the struct module checks their range as it writes them, once is enough.

read = target.size                  without a call of _within
if len(data) != read:
    ...
parts.append(_whole_i(read))
"""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Block, Convert, Expect, Get, Let, Local, Stmt, Store
from rosetta_jit.kernel.walk import blocks_of, expressions_of, statements, subexpressions


def stored_as_read(body: Block) -> frozenset[str]:
    """The locals for integers that are written as they are read, in the same block, and else do nothing but decide whether it fails."""
    elsewhere = {name for stmt, _ in statements(body) for name in _computed(stmt)}
    elsewhere |= {of for stmt, _ in statements(body) for copy, of in _copy(stmt) if copy in elsewhere}
    return frozenset(_stored(body) - elsewhere)


def _stored(block: Block) -> set[str]:
    """The locals for integers that a block reads and writes, or one within it."""
    read = {stmt.name: stmt.value.type for stmt in block if isinstance(stmt, Let) and isinstance(stmt.value, Get)}
    found = set[str]()
    for stmt in block:
        match stmt:
            case Store(_, Local(type_, name)) if type_[0] in "iu" and read.get(name) == type_:
                found.add(name)
            case _:
                found |= {name for inner in blocks_of(stmt) for name in _stored(inner)}
    return found


def _copy(stmt: Stmt) -> list[tuple[str, str]]:
    """A local that has the number of another one, and this."""
    match stmt:
        case Let(name, Local(_, of) | Convert("i64", Local(_, of))):
            return [(name, of)]
        case _:
            return []


def _computed(stmt: Stmt) -> set[str]:
    """The locals with which a statement computes something, but to decide whether it fails."""
    if _copy(stmt) or isinstance(stmt, Expect):
        return set()
    match stmt:
        case Store(at, Local()):
            exprs = (at,)
        case _:
            exprs = expressions_of(stmt)
    return {part.name for expr in exprs for part in subexpressions(expr) if isinstance(part, Local)}
