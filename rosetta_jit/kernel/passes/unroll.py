"""Innermost loops of a few rounds become their rounds, one behind the other."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.limits import MAX_UNROLLED_ROUNDS, MAX_UNROLLED_STATEMENTS
from rosetta_jit.kernel.nodes import Assign, Block, Call, Const, Expr, For, HostCall, Let, Stmt, Var, While
from rosetta_jit.kernel.rewrite import ends, substituted, with_blocks, with_bodies, with_expressions
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import bound_names, statements
from rosetta_jit.startup.dataclass import replace


def unroll(kernel: Kernel, stays: Callable[[For], bool] = lambda _: False) -> Kernel:
    """The kernel without short loops, but for those of which ``stays`` is true."""
    names = {name for body in kernel.bodies for stmt, _ in statements(body) for name in bound_names(stmt)}

    def unrolled(block: Block) -> Block:
        result: list[Stmt] = []
        for stmt in block:
            match stmt:
                case For(variable, Const(_, count), body) if _is_short(int(count), body) and not stays(stmt):
                    for number in range(int(count)):
                        result.extend(_round(body, variable, number, names))
                case _:
                    result.append(with_blocks(stmt, unrolled))
        return tuple(result)

    return with_bodies(kernel, tuple(map(unrolled, kernel.bodies)))


def _is_short(count: int, body: Block) -> bool:
    inner = [stmt for stmt, _ in statements(body)]
    is_innermost = not any(isinstance(stmt, For | While | Call | HostCall) for stmt in inner)
    return is_innermost and count <= MAX_UNROLLED_ROUNDS and count * len(inner) <= MAX_UNROLLED_STATEMENTS and not ends(body)


def _round(body: Block, variable: str, number: int, names: set[str]) -> Block:
    """A copy of a loop's body for one value of its variable, with names of its own."""
    bound = [name for stmt, _ in statements(body) for name in bound_names(stmt)]
    renamed = {name: _fresh(f"{name}_{number}", names) for name in bound}

    def change(expr: Expr) -> Expr:
        return substituted(expr, {variable: index(number)}, renamed)

    def copied(block: Block) -> Block:
        return tuple(_renamed(with_blocks(with_expressions(stmt, change), copied), renamed) for stmt in block)

    return copied(body)


def _renamed(stmt: Stmt, renamed: dict[str, str]) -> Stmt:
    """A statement with the new name for what it binds or assigns."""
    if isinstance(stmt, Let | Var | Assign):
        return replace(stmt, name=renamed.get(stmt.name, stmt.name))
    return stmt


def _fresh(name: str, names: set[str]) -> str:
    while name in names:
        name += "_"
    names.add(name)
    return name
