"""The body of a large kernel in parts, of which each becomes a function: SBCL's time and memory grow faster than a function does.

A part is a block of the body, or a run of statements of one. A `Call` of its name stands in its place. Locals that several parts
use are **spilled**: they lie in memory of the codec.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import locals_in, with_blocks
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import blocks_of, expressions_of, flat, subexpressions
from rosetta_jit.startup.dataclass import dataclass, field

LARGE = 2000
"""Bodies of more statements and expressions are parted. `Marker` of CDR, of 1,300, is compiled in 4.2 s as one and in 2.6 s in parts, which
read it in 432 ns where one function takes 398."""

MAX_NODES = 600
"""Statements and expressions of a part. `InteractiveMarkerUpdate` is compiled in 4.4, 6 and 8 s with parts of 150, 600 and 1,000, which
read a message in 11.9, 10.3 and 10.6 us; as one function in 18 s and 9.5 us."""

OF_CALL = 12
"""About how many nodes a call of a part is worth."""


@dataclass(slots=True)
class Parts:
    """``blocks`` are the parts by their names, each behind those that it calls; ``body`` is what remains."""

    body: nodes.Block
    blocks: dict[str, nodes.Block] = field(default_factory=dict[str, nodes.Block])

    def spilled(self, read: frozenset[str]) -> dict[str, nodes.Scalar]:
        """The locals, among those that are read, that more than one function uses, and their types."""
        types: dict[str, nodes.Scalar] = {}
        users: dict[str, int] = {}
        for block in (self.body, *self.blocks.values()):
            for name in names_in(block, types) & read:
                users[name] = users.get(name, 0) + 1
        return {name: type_ for name, type_ in types.items() if users.get(name, 0) > 1}


def is_large(block: nodes.Block) -> bool:
    """Whether a body is to be parted."""
    return weight(block) > LARGE


def weight(block: Sequence[nodes.Stmt]) -> int:
    """How many statements and expressions a block has."""
    return sum(1 + sum(len(subexpressions(expr)) for expr in _printed(stmt)) for stmt in flat(tuple(block)))


def parted(body: nodes.Block, name: str) -> Parts:
    """The parts of a body, called by its name and numbers, that have `MAX_NODES` at most if their statements allow it."""
    parts = Parts(body)
    parts.body = _light(body, parts, name)
    return parts


def _light(block: nodes.Block, parts: Parts, name: str) -> nodes.Block:
    """A block of few nodes: it calls its heaviest inner blocks or, where that is not enough, runs of its statements."""
    stmts = tuple(with_blocks(stmt, lambda inner: _light(inner, parts, name)) for stmt in block)
    excess = weight(stmts) - MAX_NODES
    inner = [each for stmt in stmts for each in blocks_of(stmt)]
    called = dict[int, nodes.Block]()
    for each in sorted(inner, key=weight, reverse=True):
        if excess > 0 and weight(each) > OF_CALL and _can_be_part(each):
            called[id(each)] = _call(each, parts, name)
            excess -= weight(each) - OF_CALL
    stmts = tuple(with_blocks(stmt, lambda inner: called.get(id(inner), inner)) for stmt in stmts)
    return tuple(_runs(stmts, parts, name)) if excess > 0 else stmts


def _runs(block: nodes.Block, parts: Parts, name: str) -> Iterator[nodes.Stmt]:
    """The statements of a block with calls in place of runs of them."""
    run: list[nodes.Stmt] = []
    total = 0
    for stmt in block:
        size = weight((stmt,)) if _can_be_part((stmt,)) else None
        if size is None or total + size > MAX_NODES:
            yield from _ended(run, total, parts, name)
            run, total = [], 0
        if size is None:
            yield stmt
        else:
            run.append(stmt)
            total += size
    yield from _ended(run, total, parts, name)


def _ended(run: Sequence[nodes.Stmt], size: int, parts: Parts, name: str) -> nodes.Block:
    return _call(tuple(run), parts, name) if size > OF_CALL else tuple(run)


def _call(block: nodes.Block, parts: Parts, name: str) -> nodes.Block:
    called = f"{name}.{len(parts.blocks) + 1}"
    parts.blocks[called] = block
    return (nodes.Call(called, (), (), ()),)


def _can_be_part(block: Sequence[nodes.Stmt]) -> bool:
    """A part cannot end the message; what fails in there does."""
    return not any(isinstance(stmt, nodes.Return) for stmt in flat(tuple(block)))


def _printed(stmt: nodes.Stmt) -> tuple[nodes.Expr, ...]:
    return (stmt.condition,) if isinstance(stmt, nodes.While) else expressions_of(stmt)


def names_in(block: nodes.Block, types: dict[str, nodes.Scalar] | None = None) -> set[str]:
    """The locals that a block reads, binds or assigns; ``types`` gets those of what it binds."""
    return {name for stmt in flat(block) for name in _names(stmt, {} if types is None else types)}


def _names(stmt: nodes.Stmt, types: dict[str, nodes.Scalar]) -> Iterator[str]:
    for expr in _printed(stmt):
        yield from locals_in(expr)
    match stmt:
        case nodes.Let(name, value) | nodes.Var(name, value):
            types[name] = type_of(value)
            yield name
        case nodes.Assign(name, _):
            yield name
        case nodes.For(variable):
            types[variable] = "i64"
            yield variable
        case nodes.Call(_, _, results):
            for each in results:
                types[each.name] = each.type
                yield each.name
        case nodes.HostCall(_, _, result):
            types[result.name] = result.type
            yield result.name
        case _:
            return
