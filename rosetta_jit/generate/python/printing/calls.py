"""Calls of routines, and of the functions that a mapping declares."""

from __future__ import annotations

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.python.passes.groups import is_not_negative
from rosetta_jit.generate.python.printing.expressions import expression, is_small
from rosetta_jit.generate.python.printing.failures import fail
from rosetta_jit.generate.python.printing.printed import Attempt, Function
from rosetta_jit.generate.python.printing.scope import CODES, Scope, view_name
from rosetta_jit.kernel import nodes

OF_SEVERAL_BYTES = {**dict.fromkeys(("read_varint", "read_element", "read_packed"), "_several_bytes"), "read_size": "_long_length"}
"""Routines for integers of protobuf that often have several bytes, with the function that reads those that end by one call."""


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


def print_call(function: Function, call: nodes.Call) -> None:
    """A routine gets the numbers of the sites at which the caller fails where it does, and the indices there."""
    scope, routine = function.scope, function.routines[call.routine]
    pass_on(function.scope, routine)
    results = [scope.locals.identifier(result.name) for result in call.results]
    called = next(each for each in function.kernel.routines if each.name == call.routine)
    for result, own in zip(call.results, called.results, strict=True):
        limits = (each.right for each in called.ensures if isinstance(each, nodes.Compare) and (each.op, each.left) == ("le", own))
        scope.note(result.name, is_small=own.type == "u64" and any(is_small(limit, ()) for limit in limits))
    sites = [f"sites[{each - 1}]" if function.is_routine else str(each) for each in call.sites]
    indices = "indices" if function.is_routine else tuple_of([function.text(each) for each in call.indices])
    arguments = ", ".join(["data", "end", tuple_of(sites), indices, *routine.needs, *(function.text(each) for each in call.arguments)])
    bound = f"{', '.join(results)}{',' if len(results) == 1 else ''} = " if results else ""
    if routine.is_mostly_a_byte:
        at, (value, after) = expression(scope, call.arguments[0]), results
        least = "" if is_not_negative(call.arguments[0], function.positive) else "0 <= "
        function.line(f"{value} = data[{bare(at)}]" + (f" if {least}{at} < end else 128" if routine.may_lack else ""))
        function.line(f"{after} = {at} + 1")
        function.line(f"if {value} >= 128:")
        if call.routine in OF_SEVERAL_BYTES:
            function.line(f"    {value}, {after} = {OF_SEVERAL_BYTES[call.routine]}(data, {bare(at)})")
            function.line(f"if not {after}:")
        bound = f"    {bound}"
    function.line(f"{bound}{routine.name}({arguments})")
