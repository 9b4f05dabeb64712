"""Statements that set fields, rows and bytes of the message, each as one line."""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.generate.origins import origin_of
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.python.printing.expressions import expression, location, slice_of
from rosetta_jit.generate.python.printing.printed import Function
from rosetta_jit.generate.python.printing.reading import numbers_read
from rosetta_jit.generate.python.printing.scope import CODES, Scope
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.model.layout import Span


def print_effect(function: Function, stmt: nodes.Effect) -> None:
    """One such statement."""
    scope, origin = function.scope, origin_comment(function, stmt)
    match stmt:
        case nodes.Store(at, value, order):
            type_, where, text = type_of(value), function.text(at), function.text(value)
            if type_ in ("u8", "bool"):
                function.line(f"data[{where}] = {text}{origin}")
            else:
                function.line(
                    f"{scope.struct('<' if nodes.WIDTH[type_] == 1 else order, CODES[type_], 'store')}(data, {where}, {text}){origin}"
                )
        case nodes.SetField(nodes.Place(lane), _) if lane in scope.direct.gathered:
            if lane not in scope.direct.listed:
                function.line(f"{scope.lanes.rows(lane)}.append({slice_of(scope, *scope.direct.gathered[lane])}){origin}")
        case nodes.SetField(nodes.Place(lane, _, offset), _) if (lane, offset) in scope.direct.pieces:
            function.line(f"{_piece(scope, lane, offset)}{origin}")
        case nodes.SetField(nodes.Place(lane) as place, _) if place in scope.direct.rows.get(lane, ()):
            number = [*scope.direct.rows[lane]].index(place)
            function.line(f"{scope.element(lane, number)} = {_row_of(function, lane, *scope.direct.rows[lane][place])}{origin}")
        case nodes.SetField(place, value):
            target = target_of(function, place, value)
            text = function.text(value)
            if type_of(value) == "f32" and text.startswith("_single(") and target.endswith("]"):
                text = bare(text.removeprefix("_single"))  # a view rounds by itself
            function.line(f"{target} = {text}{origin}")
        case nodes.Copy(nodes.Place(lane), nodes.Wire(at), size) if lane in scope.direct.whole:
            function.line(f"{scope.lanes.rows(lane)} = {list_read(function, lane, at, size, '<')}{origin}")
        case nodes.Copy(target, source, size):
            (to, first), (of, begin), length = location(scope, target), location(scope, source), expression(scope, size)
            function.line(f"{to}[{first} : {first} + {length}] = {of}[{begin} : {begin} + {length}]{origin}")
        case nodes.Fill(nodes.Place(0, _, offset), nodes.Const(_, size), _) if scope.flat:
            function.line(f"<row {offset} {int(size)}>")
        case nodes.Fill(target, size, byte):
            (to, first), length = location(scope, target), expression(scope, size)
            filling = f"bytes({bare(length)})" if byte == 0 else f"bytes([{byte}]) * {length}"
            function.line(f"{to}[{first} : {first} + {length}] = {filling}{origin}")
        case _:
            assert_never(stmt)


def target_of(function: Function, place: nodes.Place, value: nodes.Expr) -> str:
    """What a field is assigned to."""
    return function.scope.place(place, type_of(value), lambda: expression(function.scope, place.row))


def origin_comment(function: Function, stmt: nodes.Stmt) -> str:
    """The line of the mapping that a statement comes from, as a comment behind it."""
    line = origin_of(stmt, function.origins) if function.origins else None
    return "" if line is None else f"  # {ascii(line)[1:-1]}"


def _piece(scope: Scope, lane: int, offset: int) -> str:
    """The line that takes bytes out of the message: for a list of them, or for a field."""
    piece = slice_of(scope, *scope.direct.pieces[lane, offset])
    return f"{scope.lanes.rows(lane)}.append({piece})" if lane in scope.direct.listed else f"{scope.piece(lane, offset)} = {piece}"


def list_read(function: Function, lane: int, at: nodes.Expr, size: nodes.Expr, order: str) -> str:
    """An array that lies in the message."""
    scope, objects = function.scope, function.objects
    assert objects.layout is not None
    return numbers_read(scope, lane, objects.layout.lanes[lane].element, lambda: objects.row(scope, lane), at, size, order)


def _row_of(function: Function, lane: int, at: nodes.Expr, size: nodes.Expr) -> str:
    """A row, of an array of arrays, that lies in the message."""
    objects = function.objects
    assert objects.layout is not None
    inner = objects.layout.lanes[lane].element
    assert isinstance(inner, Span)
    return slice_of(function.scope, at, size) if lane in objects.blobs else list_read(function, inner.lane, at, size, "<")
