"""A decoder's statements for messages whose lists are empty, as optional ones often are, and for messages that have no texts, either.

How many elements a list has must be found before any text is checked: a message that has some loses a comparison.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.nodes import Block, Expr, Stmt
from rosetta_jit.kernel.passes.fold import FALSE, folded
from rosetta_jit.kernel.rewrite import with_blocks, with_expressions, with_operands
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes

NONE = index(0)
NOT_EMPTY = nodes.Failure(0, NONE)
"""What stands for a list with elements: nothing is wrong with it, but other statements read it."""


def of_empty_lists(body: Block, lanes: Lanes) -> Block:
    """The statements of a body that are left, behind checks that lists of the message are empty; the body itself if there are none."""
    lists = lists_of(lanes)
    reserved = (stmt.count for stmt in body if isinstance(stmt, nodes.Reserve) and stmt.lane in lists)
    counts = {count.name for count in reserved if isinstance(count, nodes.Local)}
    return _of_no_more(body, lists, counts, anywhere=False) if lists else body


def of_nothing(body: Block, lanes: Lanes) -> Block:
    """The same of messages that have no elements at all, and no texts: all of these have one size."""
    sizes = (each for stmt in body if isinstance(stmt, nodes.Require) for each in subexpressions(stmt.size))
    named = {each.name for each in sizes if isinstance(each, nodes.Local)}
    counts = {stmt.name for stmt in body if isinstance(stmt, nodes.Let) and stmt.name in named and _is_loaded(stmt.value)}
    return _of_no_more(body, lists_of(lanes), counts, anywhere=True) if counts else ()


def _is_loaded(value: Expr) -> bool:
    """Whether a value is a number of the message."""
    return isinstance(value, nodes.Load) or (isinstance(value, nodes.Convert) and _is_loaded(value.operand))


def lists_of(lanes: Lanes) -> frozenset[int]:
    """The lists of the message."""
    return frozenset(straight.lane for (lane, _), straight in lanes.straight.items() if lane == 0 and straight.lane)


def _of_no_more(body: Block, lists: frozenset[int], counts: set[str], *, anywhere: bool) -> Block:
    """A body where counts are 0, ``anywhere`` or before a text is looked at."""
    values, found, is_soon = dict[str, Expr](), list[Stmt](), True
    for each in body:
        stmt = with_values(each, values)
        match stmt:
            case nodes.Let(name) if name in counts and (anywhere or is_soon):
                values[name] = NONE
                found += [stmt, nodes.Expect(nodes.Compare("eq", nodes.Local("i64", name), NONE), NOT_EMPTY)]
            case nodes.Let(name, value) | nodes.Var(name, value) if isinstance(value, nodes.Const):
                values[name] = value
            case nodes.Let(name, nodes.Used(lane)) if lane in lists:
                values[name] = NONE
            case nodes.Var(name, value):
                found.append(nodes.Let(name, value))
            case nodes.Reserve(lane, count) if count == NONE and (anywhere or lane in lists):
                pass
            case nodes.Advance(lane, count) if lane in lists and count == NONE:
                pass
            case nodes.Expect(nodes.IsText(_, size)) if size == NONE:
                pass
            case nodes.While(condition) | nodes.If(condition, _, ()) if condition == FALSE:
                pass
            case nodes.For(_, count) if count == NONE:
                pass
            case _:
                found.append(stmt)
        is_soon = is_soon and not any(isinstance(part, nodes.IsText) for expr in expressions_of(stmt) for part in subexpressions(expr))
    return tuple(found)


def of_no_elements(body: Block, visits: Collection[str] = ()) -> Block:
    """The statements of an encoder that are left where counts of lists are 0: no loop, and so no local that changes.

    ``visits`` are the calls that write the messages of lists.
    """
    values, found = dict[str, Expr](), list[Stmt]()
    for each in body:
        if isinstance(each, nodes.While) and with_values(nodes.Expect(each.condition, NOT_EMPTY), values) == nodes.Expect(FALSE, NOT_EMPTY):
            continue
        changed = {stmt.name for stmt, _ in statements((each,)) if isinstance(stmt, nodes.Assign)}
        values = {name: value for name, value in values.items() if name not in changed}
        match stmt := with_values(each, values):
            case nodes.Let(name, nodes.Const() as value) | nodes.Var(name, nodes.Const() as value):
                values[name] = value
            case nodes.For(_, count) if count == NONE:
                continue
            case nodes.Call(routine, (begin, count), (behind,)) if routine in visits and count == NONE:
                stmt = nodes.Let(behind.name, begin)
            case _:
                pass
        found.append(stmt)
    changed = {stmt.name for stmt, _ in statements(tuple(found)) if isinstance(stmt, nodes.Assign)}
    return tuple(nodes.Let(each.name, each.value) if isinstance(each, nodes.Var) and each.name not in changed else each for each in found)


def lanes_of_empty_lists(lanes: Lanes) -> Lanes:
    """How such statements reach the object: a list has no lane, but is emptied."""
    straight = {at: replace(each, statement=each.empty) if each.empty else each for at, each in lanes.straight.items()}
    return replace(lanes, straight=straight, opened=frozenset())


def lanes_of_nothing(lanes: Lanes) -> Lanes:
    """How statements for messages without elements and texts reach the object: arrays have no first element."""
    return replace(
        lanes_of_empty_lists(lanes),
        given={lane: replace(each, rows="") if each.rows == "nullptr" else each for lane, each in lanes.given.items()},
    )


def with_values(stmt: Stmt, values: Mapping[str, Expr]) -> Stmt:
    """A statement with what is known in place of locals."""

    def replaced(expr: Expr) -> Expr:
        return values.get(expr.name, expr) if isinstance(expr, nodes.Local) else folded(with_operands(expr, replaced))

    inner = with_blocks(stmt, lambda block: tuple(with_values(each, values) for each in block))
    return with_expressions(inner, replaced)
