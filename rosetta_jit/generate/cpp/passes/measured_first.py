"""Encoders that look at the object first, and whether there is room for what follows, and write it then.

That is the whole message, or what each element of a list has, up to a list within it. They stand in the header, and begin anew elsewhere
where anything is wrong: nobody is told which part of the message it is.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from rosetta_jit.generate.passes.positions import bound_in, difference, terms_of
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.nodes import Block, Expr, Stmt
from rosetta_jit.kernel.rewrite import locals_in, substituted, with_blocks
from rosetta_jit.kernel.terms import END, add, index
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.startup.dataclass import dataclass, replace

Counts = Collection[tuple[int, int]]
"""The fields of rows that are counts, which are not negative, by lane and offset."""


FULL = nodes.Failure(0, index(0))
"""Nobody is told more."""
MOST = 2**32
"""Room for so many bytes is not asked for here: counts that are in a sum of bytes fit 32 bits then."""


def measured_first(body: Block, counts: Counts) -> Block:
    """The statements of an encoder in that order; where what it writes is longer than a sum says, room is looked at where it is needed."""
    body = _untold(body)
    found = tuple(_in_parts(body, counts))
    if _ranges(found) == _ranges(body):
        return found
    return (nodes.Expect(nodes.Compare("lt", END, index(MOST)), FULL), *found)


def _untold(body: Block) -> Block:
    """The statements without what they say where anything is wrong, which may need locals."""
    inner = (with_blocks(stmt, _untold) for stmt in body)
    return tuple(replace(stmt, failure=FULL) if isinstance(stmt, nodes.Expect | nodes.Require) else stmt for stmt in inner)


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
    bounds = {name for stmt in block if (name := _asked_for_each(stmt)) is not None}
    for stmt in (stmt for stmt in block if _in_range(stmt) is None or _in_range(stmt) not in bounds):
        if isinstance(stmt, nodes.While | nodes.For) and any(isinstance(each, nodes.Require) for each, _ in statements((stmt,))):
            yield from _measured(part, counts)
            yield with_blocks(stmt, lambda inner: tuple(_in_parts(inner, counts)))
            part = []
        else:
            part.append(stmt)
    yield from _measured(part, counts)


def _asked_for_each(stmt: Stmt) -> str | None:
    """The count of a loop that asks for a byte at least in each round: more elements than there are bytes are found there."""
    match stmt:
        case nodes.While(nodes.Compare("lt", nodes.Local(), nodes.Local(_, count)), body):
            sizes = (each.size for each in body if isinstance(each, nodes.Require))
            return count if any(isinstance(size, nodes.Const) and size.value >= 1 for size in sizes) else None
        case _:
            return None


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
    asked = max((number for number, stmt in enumerate(stmts) if isinstance(stmt, nodes.Require)), default=0)
    late = {name for number, stmt in enumerate(stmts[:asked]) if number not in early for name in bound_in(stmt)}
    behind = [difference(sums[-1], each) for each in sums]
    if not ends or late & locals_in(ends[-1]) or not all(each is not None and _is_size(each, sizes) for each in behind):
        yield from (stmts[number] for number in (*sorted(early), *(each for each in range(len(stmts)) if each not in early)))
        return
    yield from _behind_one_check(stmts, early, ends[-1], values, sizes)


def _behind_one_check(stmts: list[Stmt], early: set[int], end: Expr, values: Mapping[str, Expr], sizes: set[str]) -> Iterator[Stmt]:
    """The statements without other checks of room; ``values`` are those of early locals, ``sizes`` the counts among these."""
    total = substituted(end, values)
    in_sum = sizes & locals_in(total)
    left_out = {number for number, stmt in enumerate(stmts) if isinstance(stmt, nodes.Require) or _in_range(stmt) in in_sum}
    checked = {name for number in _needed(stmts, early - left_out, ()) for name in bound_in(stmts[number])}
    sum_ = _summed(total, {name: value for name, value in values.items() if name not in checked}, in_sum)
    first = _needed(stmts, early - left_out, locals_in(end if sum_ is None else sum_.end.value))
    if sum_ is not None:
        stmts = [sum_.other if sum_.other.name in bound_in(stmt) else stmt for stmt in stmts]
        left_out |= {number for number, stmt in enumerate(stmts) if stmt == sum_.end}
    yield from (stmts[number] for number in sorted(first))
    yield from () if sum_ is None else (sum_.end,)
    yield nodes.Expect(nodes.Compare("ge", END, end if sum_ is None else nodes.Local("i64", sum_.end.name)), FULL)
    yield from (stmt for number, stmt in enumerate(stmts) if number not in first | left_out)


@dataclass(frozen=True, slots=True)
class _Sum:
    """The end of what is written as a local, and another local that is found from it; they may be the same."""

    end: nodes.Let
    other: nodes.Let


def _summed(total: Expr, values: Mapping[str, Expr], sizes: set[str]) -> _Sum | None:
    """The end of an element, for which counts are added to each other before they are added to where it begins.

    So the next element waits for one addition, and not for one after each text.
    """
    behind = {name: difference(total, value) for name, value in values.items()}
    known = {name: int(size.value) for name, size in behind.items() if isinstance(size, nodes.Const) and size.value >= 0}
    terms = [each for each in terms_of(total) if isinstance(each, nodes.Local) and each.name not in sizes]
    counts = difference(total, terms[0]) if len(terms) == 1 else None
    if not known or counts is None or isinstance(counts, nodes.Const):
        return None
    name, size = [*known.items()][-1]
    end = nodes.Let(f"{name} behind" if size else name, nodes.Binary("add", terms[0], counts))
    return _Sum(end, nodes.Let(name, add(nodes.Local("i64", end.name), -size)) if size else end)


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
