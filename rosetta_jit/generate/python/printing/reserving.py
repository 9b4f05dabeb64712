"""Room for rows of lanes, as Python statements."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.python.passes.groups import ALWAYS
from rosetta_jit.kernel.nodes import Const, Expr
from rosetta_jit.model.layout import Row, Slot

if TYPE_CHECKING:
    from rosetta_jit.generate.python.printing.printed import Function
    from rosetta_jit.generate.python.printing.scope import Scope


def reserve(function: Function, lane: int, number: Expr) -> None:
    """The lines that make room for more rows."""
    scope, name, count = function.scope, function.scope.lanes.rows(lane), function.text(number)
    if lane in scope.direct.appended and scope.direct.left is not None:
        take(function, lane, count)
        function.line(f"{name} = []")
        return
    if lane in scope.direct.appended:
        if number not in scope.allowed and not (isinstance(number, Const) and number.value <= ALWAYS):
            with function.writer.indented(f"if {count} > most:"):
                function.line(f"raise _Failed(0, 0, ({_path(scope, lane)},))")
        function.line(f"{name} = []")
        return
    if lane and function.reserved[lane] == 1 and lane in function.outside and lane not in scope.rooms and not function.is_routine:
        _reserve_once(function, lane, count)
        return
    used, room = scope.used(lane), scope.room(lane)
    function.moved.add(lane)
    free = room if lane == 0 else f"{room} - {used}"
    path = _path(scope, lane)
    with function.writer.indented(f"if {count} > {free}:"):
        function.line(
            f"{name}, {room} = _more({scope.view(lane, '')}, {room}, {count} - ({free}), {scope.lanes.stride(lane)}, most, {path})"
        )
        function.line(f"<views {lane}>")


def take(function: Function, lane: int, count: str) -> None:
    """The lines that count the rows of a lane which all messages of a type that contains itself share."""
    left = function.scope.direct.left
    assert left is not None
    number = left.setdefault(lane, len(left))
    function.line(f"left[{number}] -= {count}")
    with function.writer.indented(f"if left[{number}] < 0:"):
        function.line(f"raise _Failed(0, 0, ({_path(function.scope, lane)},))")


def _reserve_once(function: Function, lane: int, count: str) -> None:
    """Rows of a lane that has none yet, and gets no others: of structs without fields only their number matters."""
    scope, stride, layout = function.scope, function.scope.lanes.stride(lane), function.objects.layout
    with function.writer.indented(f"if {count} > most:"):
        function.line(f"raise _Failed(0, 0, ({_path(scope, lane)},))")
    if layout is not None and lane < len(layout.lanes) and _has_no_fields(layout.lanes[lane].element):
        return
    size = count if stride == 1 else f"{stride} * ({count})" if " " in count else f"{stride} * {count}"
    function.line(f"{scope.view(lane, '')} = bytearray({size})")
    function.line(f"<views {lane}>")
    function.moved.add(lane)


def _has_no_fields(row: Slot) -> bool:
    return isinstance(row, Row) and not (row.members or row.presence_words or row.unknown)


def _path(scope: Scope, lane: int) -> str:
    return ascii(scope.paths[lane]) if lane < len(scope.paths) else "''"
