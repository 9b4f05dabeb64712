"""Loops that count by hand become loops over a range."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Assign, Binary, Block, Compare, Const, For, Let, Local, Stmt, Var, While
from rosetta_jit.kernel.rewrite import locals_in, with_blocks
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import expressions_of, statements


def counted(block: Block) -> Block:
    """A block with `For` in place of each `While` whose variable goes from 0 up to a count, one by one, and is not needed behind it."""
    constant = {stmt.name for stmt, _ in statements(block) if isinstance(stmt, Let)}
    return _counted(block, constant)


def _counted(block: Block, constant: set[str]) -> Block:
    found: list[Stmt] = []
    begun: dict[str, Var] = {}
    for number, old in enumerate(block):
        made = _as_for(old, begun, constant, block[number + 1 :]) if isinstance(old, While) else None
        if made is not None:
            found = [each for each in found if each is not begun[made.variable]]
        stmt = old if made is None else made
        found.append(with_blocks(stmt, lambda inner: _counted(inner, constant)))
        if isinstance(stmt, Var):
            begun[stmt.name] = stmt
        for name in [name for name in begun if not isinstance(stmt, Var) and _names(stmt, name)]:
            del begun[name]
    return tuple(found)


def _as_for(loop: While, begun: dict[str, Var], constant: set[str], after: Block) -> For | None:
    match loop:
        case While(Compare("lt", Local(_, name), count), (*body, Assign(changed, Binary("add", Local(_, same), Const(_, 1))))):
            again = any(isinstance(each, Assign) and each.name == name for each, _ in statements(tuple(body)))
            is_fixed = isinstance(count, Const) or (isinstance(count, Local) and count.name in constant)
            starts = name in begun and begun[name].value == index(0)
            if not (name == changed == same and starts and is_fixed) or again or any(_names(each, name) for each in after):
                return None
            return For(name, count, tuple(body))
        case _:
            return None


def _names(stmt: Stmt, name: str) -> bool:
    """Whether a statement has to do with a local."""
    for each, _ in statements((stmt,)):
        if any(name in locals_in(expr) for expr in expressions_of(each)) or (isinstance(each, Assign) and each.name == name):
            return True
    return False
