"""Loads from the message, which decoding does not change, move to the one statement that uses them: fewer values are live meanwhile."""

from __future__ import annotations

from collections import Counter

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Expr, Let, Load, Local, Stmt
from rosetta_jit.kernel.rewrite import locals_in, reads_memory, substituted, with_blocks, with_bodies, with_expressions
from rosetta_jit.kernel.walk import changed_names, expressions_of, statements, subexpressions


def postpone(kernel: Kernel) -> Kernel:
    """The kernel with loads in the statements, of the same block, that alone use them."""
    if kernel.direction != "decode":
        return kernel
    return with_bodies(kernel, tuple(map(_body, kernel.bodies)))


def _body(body: Block) -> Block:
    used = Counter(name for stmt, _ in statements(body) for expr in expressions_of(stmt) for name in _names(expr))
    changed = changed_names(body)

    def block(inner: Block) -> Block:
        return _block(inner, used, changed)

    return block(tuple(with_blocks(stmt, block) for stmt in body))


def _names(expr: Expr) -> list[str]:
    """Those of the locals that an expression reads, each as often as it does."""
    return [part.name for part in subexpressions(expr) if isinstance(part, Local)]


def _block(block: Block, used: Counter[str], changed: set[str]) -> Block:
    values: dict[str, Expr] = {}
    here = {name for stmt in block for expr in expressions_of(stmt) for name in locals_in(expr)}
    result: list[Stmt] = []
    for stmt in block:
        if (
            isinstance(stmt, Let)
            and isinstance(stmt.value, Load)
            and used[stmt.name] == 1
            and stmt.name in here
            and _stays(stmt.value, changed)
        ):
            values[stmt.name] = stmt.value
            continue
        result.append(with_expressions(stmt, lambda expr: substituted(expr, values)) if values else stmt)
    return tuple(result)


def _stays(load: Load, changed: set[str]) -> bool:
    """Whether it is the same load further on."""
    return not reads_memory(load.at) and locals_in(load.at).isdisjoint(changed)
