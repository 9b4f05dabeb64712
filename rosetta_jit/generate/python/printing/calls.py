"""What calls of routines pass on, and calls of the functions that a mapping declares."""

from __future__ import annotations

from rosetta_jit.generate.python.printing.failures import fail
from rosetta_jit.generate.python.printing.printed import Attempt, Function
from rosetta_jit.generate.python.printing.scope import CODES, Scope, view_name
from rosetta_jit.kernel import nodes


def pass_on(scope: Scope, routine: Attempt) -> None:
    """What a routine needs its caller needs, too."""
    for lane in range(len(scope.lanes.all)) if routine.needs else ():  # most need nothing
        for code in ("", *set(CODES.values())):
            if view_name(scope.lanes, lane, code) in routine.needs:
                scope.views.add((lane, code))
        if f"{scope.lanes.rows(lane)}_room" in routine.needs:
            scope.rooms.add(lane)
    scope.rows.update(each for each in routine.needs if each.startswith("m_"))


def tuple_of(texts: list[str]) -> str:
    """A tuple of some expressions."""
    return f"({', '.join(texts)}{',' if len(texts) == 1 else ''})"


def host_call(function: Function, call: nodes.HostCall) -> None:
    """A call of a function that the mapping declares."""
    result = function.scope.locals.identifier(call.result.name)
    arguments = ", ".join(function.text(each) for each in call.arguments)
    with function.writer.indented("try:"):
        function.line(f'{result} = functions["{call.function}"]({arguments})')
    with function.writer.indented("except Refused:"):
        fail(function, call.failure)
