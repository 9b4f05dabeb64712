"""Encoders that look at the object first, and whether there is room for what follows, and write it then.

That is the whole message, or what each element of a list has, up to a list within it. They stand in the header, and begin anew elsewhere
where anything is wrong: nobody is told which part of the message it is.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from rosetta_jit.generate.passes.positions import bound_in, difference
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.nodes import Block, Expr, Stmt
from rosetta_jit.kernel.rewrite import locals_in, substituted, with_blocks
from rosetta_jit.kernel.terms import END, add, index
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions

Counts = Collection[tuple[int, int]]
"""The fields of rows that are counts, which are not negative, by lane and offset."""


FULL = nodes.Failure(0, index(0))
"""Nobody is told more."""
MOST = 2**32
"""Room for so many bytes is not asked for here: counts that are in a sum of bytes fit 32 bits then."""


def measured_first(body: Block, counts: Counts) -> Block:
    """The statements of an encoder in that order; where what it writes is longer than a sum says, room is looked at where it is needed."""
    found = tuple(_in_parts(body, counts))
    if _ranges(found) == _ranges(body):
        return found
    return (nodes.Expect(nodes.Compare("lt", END, index(MOST)), FULL), *found)


def _ranges(body: Block) -> int:
    """How many checks there are that counts fit 32 bits."""
    return sum(1 for stmt, _ in statements(body) if _in_range(stmt) is not None)


def _in_range(stmt: Stmt) -> str | None:
    """The local of such a check."""
    match stmt:
        case nodes.Expect(nodes.Compare("lt", nodes.Local(_, name), nodes.Const(_, bound))) if bound >= MOST:
            return name
        case _:
            return None


def _in_parts(block: Block, counts: Counts) -> Iterator[Stmt]:
    """A block's statements between those that ask for room again and again."""
    part: list[Stmt] = []
    for stmt in block:
        if isinstance(stmt, nodes.While | nodes.For) and any(isinstance(each, nodes.Require) for each, _ in statements((stmt,))):
            yield from _measured(part, counts)
            yield with_blocks(stmt, lambda inner: tuple(_in_parts(inner, counts)))
            part = []
        else:
            part.append(stmt)
    yield from _measured(part, counts)


def _measured(stmts: list[Stmt], counts: Counts) -> Iterator[Stmt]:
    """Statements one behind the other, behind one check that there is room for all."""
    early = _early(stmts)
    values, sizes = dict[str, Expr](), set[str]()
    for stmt in (stmt for number, stmt in enumerate(stmts) if number in early and isinstance(stmt, nodes.Let)):
        match stmt.value:
            case nodes.Get("i64", nodes.Place(lane, _, offset)) if (lane, offset) in counts:
                sizes.add(stmt.name)
            case value:
                values[stmt.name] = substituted(value, values)
    ends = [add(stmt.at, stmt.size) for stmt in stmts if isinstance(stmt, nodes.Require)]
    sums = [substituted(each, values) for each in ends]
    late = {name for number, stmt in enumerate(stmts) if number not in early for name in bound_in(stmt)}
    behind = [difference(sums[-1], each) for each in sums]
    if not ends or late & locals_in(ends[-1]) or not all(each is not None and _is_size(each, sizes) for each in behind):
        yield from (stmts[number] for number in (*sorted(early), *(each for each in range(len(stmts)) if each not in early)))
        return
    in_sum = sizes & locals_in(sums[-1])
    left_out = {number for number, stmt in enumerate(stmts) if isinstance(stmt, nodes.Require) or _in_range(stmt) in in_sum}
    first = _needed(stmts, early - left_out, locals_in(ends[-1]))
    yield from (stmts[number] for number in sorted(first))
    yield nodes.Expect(nodes.Compare("ge", END, ends[-1]), FULL)
    yield from (stmt for number, stmt in enumerate(stmts) if number not in first | left_out)


def _early(stmts: list[Stmt]) -> set[int]:
    """The numbers of the statements that may come first: locals and checks of what an object has, but for those that need others."""
    early, bound, is_checked = set[int](), set[str](), False
    for number, stmt in enumerate(stmts):
        needs = {name for expr in expressions_of(stmt) for name in locals_in(expr)}
        is_guarded = isinstance(stmt, nodes.Let) and is_checked
        if isinstance(stmt, nodes.Let | nodes.Expect) and not needs & bound and not is_guarded and not _reads_message(stmt):
            early.add(number)
        else:
            bound |= bound_in(stmt)
            is_checked = is_checked or isinstance(stmt, nodes.Expect)
    return early


def _needed(stmts: list[Stmt], early: set[int], names: Collection[str]) -> set[int]:
    """Of early statements the checks, and the locals that these need, or that are among ``names``."""
    found, needs = set[int](), set(names)
    for number in sorted(early, reverse=True):
        stmt = stmts[number]
        if isinstance(stmt, nodes.Expect) or needs & bound_in(stmt):
            found.add(number)
            needs |= {name for expr in expressions_of(stmt) for name in locals_in(expr)}
    return found


def _reads_message(stmt: Stmt) -> bool:
    return any(isinstance(part, nodes.Load) for expr in expressions_of(stmt) for part in subexpressions(expr))


def _is_size(expr: Expr, counts: set[str]) -> bool:
    """Whether a sum is one of counts, which are not negative."""
    match expr:
        case nodes.Binary("add" | "mul", left, right):
            return _is_size(left, counts) and _is_size(right, counts)
        case nodes.Const(_, value):
            return value >= 0
        case nodes.Local(_, name):
            return name in counts
        case _:
            return False
