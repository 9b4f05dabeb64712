"""The statements of a kernel that can run, and the locals that are read. Generated source leaves out the others."""

from __future__ import annotations

from collections.abc import Iterable

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import ends, locals_in, with_blocks
from rosetta_jit.kernel.walk import expressions_of, statements


def read_names(block: nodes.Block, results: Iterable[str] = ()) -> frozenset[str]:
    """The locals whose values anything needs that a block does, or its ``results``: not those that only others need which nothing does."""
    pending, values = list(results), dict[str, set[str]]()
    for stmt, _ in statements(block):
        exprs = (stmt.condition,) if isinstance(stmt, nodes.While) else expressions_of(stmt)
        found = {name for expr in exprs for name in locals_in(expr)}
        if isinstance(stmt, nodes.Let | nodes.Var | nodes.Assign):
            values.setdefault(stmt.name, set()).update(found)
        else:
            pending += found
    read = set[str]()
    while pending:
        name = pending.pop()
        if name not in read:
            read.add(name)
            pending += values.get(name, ())
    return frozenset(read)


def leaves(block: nodes.Block) -> bool:
    """Whether a compiler sees that nothing goes on behind a block."""
    match block[-1] if block else None:
        case nodes.Expect(nodes.Const(_, False), _):
            return True
        case nodes.If(_, then, otherwise):
            return leaves(then) and leaves(otherwise)
        case nodes.Switch(_, cases, default):
            return leaves(default) and all(leaves(inner) for _, inner in cases)
        case _:
            return ends(block)


def reached(block: nodes.Block) -> nodes.Block:
    """A block without the statements that are never reached: compilers look at them, too."""
    found: list[nodes.Stmt] = []
    for stmt in block:
        found.append(with_blocks(stmt, reached))
        if leaves((stmt,)):
            break
    return tuple(found)
