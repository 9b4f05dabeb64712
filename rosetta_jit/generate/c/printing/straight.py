"""Fields that a decoder sets where an object has them, and no row keeps: the statements that do so."""

from __future__ import annotations

from string import Template
from typing import TYPE_CHECKING

from rosetta_jit.generate.c.printing.expressions import expression
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.kernel.nodes import Binary, Const, Expr, Place

if TYPE_CHECKING:
    from rosetta_jit.generate.c.printing.scope import Scope


def statement(scope: Scope, place: Place, value: Expr) -> str | None:
    """The statement that sets a field of an object, empty for the first half of a span; None if it is one of a row."""
    straight = scope.lanes.straight.get((place.lane, place.offset))
    if straight is not None and straight.is_span:
        scope.begun[place.lane, place.offset] = value
        return ""
    words = {"value": value}
    if straight is None:
        start = scope.begun.pop((place.lane, place.offset - 8), None)
        straight = scope.lanes.straight.get((place.lane, place.offset - 8))
        if start is None or straight is None:
            return None
        words = {"start": start, "size": size_left(value) or value, "count": value}
    for lane in {place.lane, straight.lane} & scope.lanes.opened:
        scope.rows(lane)
    scope.moved |= {straight.lane} & scope.lanes.opened
    if straight.text:
        scope.takes("bytes")
    scope.takes("given_object" if place.lane in {0, scope.lanes.subject, *scope.lanes.given} else "holder")
    words["index"] = place.row
    return Template(straight.statement).substitute({name: bare(expression(scope, each)) for name, each in words.items()})


def size_left(count: Expr) -> Expr | None:
    """The size of bytes that are left in the message, by the count of their span."""
    match count:
        case Binary("sub", Const(_, -1), size):
            return size
        case Const(type_, int(number)) if number < 0:
            return Const(type_, -1 - number)
        case _:
            return None
