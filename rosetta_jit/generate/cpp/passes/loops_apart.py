"""Loops of an encoder in the header that copy texts or arrays, and look for room in each round, as functions of their own.

They take many statements. A compiler keeps in registers what one such loop needs, but not what all of them need; and what is around them
is short then, and stands in place of a call.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.nodes import Block, Local, Stmt
from rosetta_jit.kernel.passes.fold import folded
from rosetta_jit.kernel.rewrite import names_read, substituted, with_blocks, with_expressions
from rosetta_jit.kernel.terms import END, index
from rosetta_jit.kernel.walk import bound_names, expressions_of, parts_of, statements, subexpressions
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence


@dataclass(frozen=True, slots=True)
class Apart:
    """Such a function: what it is given besides the object, the message and its end, and its statements. It returns a position."""

    name: str
    parameters: tuple[Local, ...]
    body: Block


def loops_apart(body: Block, name_of: Callable[[int], str]) -> tuple[Block, tuple[Apart, ...]]:
    """The statements with calls in place of such loops, and the functions; ``name_of`` the lane of its elements is what one is called."""
    found: dict[str, Apart] = {}
    return _with_calls(body, name_of, found), tuple(found.values())


def _with_calls(block: Block, name_of: Callable[[int], str], found: dict[str, Apart]) -> Block:
    stmts, done = [with_blocks(stmt, lambda inner: _with_calls(inner, name_of, found)) for stmt in block], list[Stmt]()
    for number, stmt in enumerate(stmts):
        if isinstance(stmt, nodes.While) and {nodes.Expect, nodes.Copy} <= {type(each) for each, _ in statements((stmt,))}:
            name = name_of(_lane_of(stmt))
            made = None if name in found else _called(name, done, stmt, tuple(stmts[number + 1 :]))
            if made is not None:
                apart, done = made
                found[name] = apart
                continue
        done.append(stmt)
    return tuple(done)


def _lane_of(loop: nodes.While) -> int:
    """The lane whose elements a loop writes: the first one that it reads."""
    read = (part for stmt in loop.body for expr in expressions_of(stmt) for part in subexpressions(expr))
    return next((each.place.lane for each in read if isinstance(each, nodes.Get)), 0)


def _called(name: str, before: Sequence[Stmt], loop: nodes.While, after: Block) -> tuple[Apart, list[Stmt]] | None:
    """A loop as a function, and the statements before it with a call behind them; None where more than one local of it is read later."""
    begun = {stmt.name: stmt for stmt in before if isinstance(stmt, nodes.Var)}
    inner = {each for stmt, _ in statements(loop.body) if not isinstance(stmt, nodes.Assign) for each in bound_names(stmt)}
    changed = {stmt.name for stmt, _ in statements(loop.body) if isinstance(stmt, nodes.Assign)} - inner
    results = sorted(changed & names_read(after))
    counters = {each: begun[each] for each in sorted(changed - {*results}) if each in begun}
    constants = {each: var.value for each, var in counters.items() if isinstance(var.value, nodes.Const)}
    if len(results) != 1 or results[0] not in begun or len(constants) != len(changed) - 1:
        return None
    result = Local("i64", results[0])
    parameters = tuple(each for each in _read((loop,), result) if each.name not in {*inner, *counters})
    behind = Local("i64", f"{result.name} found")
    call = nodes.Call(name, parameters, (behind,), ())
    there = folded(substituted(loop.condition, constants))
    kept = [stmt for stmt in before if stmt not in counters.values()]
    body = (*counters.values(), replace(loop, body=tuple(_copied_late(loop.body)), invariant=()), nodes.Return(result))
    return Apart(name, parameters, body), [*kept, nodes.If(there, (call, nodes.Assign(result.name, behind)))]


def _read(block: Block, first: Local) -> Iterable[Local]:
    """The locals that statements read, ``first`` before all others."""
    parts = parts_of(replace(stmt, invariant=()) if isinstance(stmt, nodes.While) else stmt for stmt, _ in statements(block))
    return dict.fromkeys([first, *(each for each in parts if isinstance(each, Local) and each != END)])


def _copied_late(block: Block) -> Iterator[Stmt]:
    """Statements that find an address where bytes are copied from it, if there are any."""
    read = Counter(part.name for part in parts_of(stmt for stmt, _ in statements(block)) if isinstance(part, Local))
    found = {stmt.name: stmt.value for stmt in block if isinstance(stmt, nodes.Let) and isinstance(stmt.value, nodes.Get)}
    copies = [stmt for stmt in block if isinstance(stmt, nodes.Copy)]
    named = {part.name for part in parts_of(copies) if isinstance(part, Local)}
    late = {name: value for name, value in found.items() if name in named and read[name] == 1}
    for stmt in block:
        if isinstance(stmt, nodes.Copy):
            copy = with_expressions(stmt, lambda expr: substituted(expr, late))
            yield (
                copy if copy == stmt or isinstance(stmt.size, nodes.Const) else nodes.If(nodes.Compare("gt", stmt.size, index(0)), (copy,))
            )
        elif not isinstance(stmt, nodes.Let) or stmt.name not in late:
            yield stmt
