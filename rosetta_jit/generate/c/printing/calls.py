"""Calls: of routines, of functions that write the messages within others, and of those of the program."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.c.printing.expressions import expression
from rosetta_jit.generate.c.printing.function import Callable, Function, fail, fail_if, failed
from rosetta_jit.generate.c.printing.room import moved
from rosetta_jit.generate.c.printing.varint_loops import REPLACED, replaced, sooner
from rosetta_jit.generate.c.words import C_TYPES
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.descents import Visit
from rosetta_jit.generate.passes.messages_in_turn import CLOSED, OPENED
from rosetta_jit.generate.unit import Role
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.passes.fold import folded
from rosetta_jit.kernel.terms import END, add

if TYPE_CHECKING:
    from rosetta_jit.generate.c.printing.scope import Scope

SHARED_BY_VISITS: dict[Role, tuple[str, ...]] = {
    "borrow": ("bytes", "end", "failure"),
    "encode": ("holder", "bytes", "end", "failure"),
    "size": ("holder", "failure"),
}
"""What functions for messages within others are given, besides the message, where it begins, and how deep it lies."""


def shared_by_visits(function: Function) -> tuple[str, ...]:
    """The same of those of a function; such as read are given the holder only if lists of their objects are opened."""
    opens = function.role == "borrow" and any(lane and straight.lane for (lane, _), straight in function.scope.lanes.straight.items())
    return (*(("holder",) if opens else ()), *SHARED_BY_VISITS[function.role])


def print_call(function: Function, call: nodes.Call) -> None:
    """Results come through pointers; what the function returns is the number of its own site that failed, or 0."""
    scope = function.scope
    if (visit := function.visits.get(call.routine)) is not None:
        (_visit if visit.number is None else _visit_one)(function, call, visit)
        return
    if scope.lanes.dialect == "c++" and call.routine in REPLACED:
        for line in replaced(scope, call):
            function.line(line)
        return
    if call.routine in (OPENED, CLOSED):
        _length(function, call)
        return
    routine = function.routines[call.routine]
    if routine.returns:
        _returned(function, call, routine)
        return
    for result in call.results:
        function.line(f"{C_TYPES[result.type]} {scope.locals.identifier(result.name)} = 0;")
    found = (f"&{scope.locals.identifier(result.name)}" for result in call.results)
    for each in routine.shared:
        scope.takes(each)
    arguments = ", ".join((*routine.shared, *(bare(expression(scope, each)) for each in call.arguments), *found))
    if not routine.fails:
        function.line(f"{routine.name}({arguments});")
        return
    name = call.results[0].name if call.results else call.routine
    problem = scope.locals.identifier(f"{name} problem")
    quick = sooner(scope, call) if scope.lanes.dialect == "c++" else None
    if quick is None:
        function.line(f"const int64_t {problem} = {routine.name}({arguments});")
    else:
        function.line(f"int64_t {problem} = 0;")
        with function.block(f"if ({quick[0]})"):
            function.line(quick[1])
        function.writer.lines[-1] += " else {"
        function.line(f"    {problem} = {routine.name}({arguments});")
        function.line("}")
    with function.block(f"if ({problem} != 0)"):
        failed(function, _site(problem, tuple(map(function.site, call.sites))), "failure->offset", call.indices, None)


def _returned(function: Function, call: nodes.Call, routine: Callable) -> None:
    """A call whose result is what the function returns."""
    scope = function.scope
    found = scope.locals.identifier(call.results[0].name)
    given = (*map(scope.takes, routine.shared), *(bare(expression(scope, each)) for each in call.arguments))
    function.line(f"const int64_t {found} = {routine.name}({', '.join(given)});")
    with function.block(f"if ({found} < 0)"):
        function.line(f"return {found};")


def positions_found(function: Function, call: nodes.Call) -> frozenset[int]:
    """Which results of a call are positions of the message."""
    if call.routine in function.visits or call.routine in (OPENED, CLOSED):
        return frozenset({0})
    return function.routines[call.routine].positions if call.routine in function.routines else frozenset()


def _visit(function: Function, call: nodes.Call, visit: Visit) -> None:
    """The messages of an array, one behind the other. Of a tree most have none. What they contain may move the rows at hand.

    A list that is read may get some elements at first, and then more: a count that a message only says takes little memory.
    """
    scope, lanes = function.scope, function.scope.lanes
    at, count = (bare(expression(scope, each)) for each in call.arguments)
    number, behind = scope.locals.identifier("object number"), scope.locals.identifier(call.results[0].name)
    list_ = "" if visit.place is None else lanes.messages[visit.place.lane, visit.place.offset]
    function.line(f"int64_t {behind} = {at};")
    if list_:
        scope.takes("given_object")
        around = bare(expression(scope, add(visit.depth, -1)))
        function.line(f"rosetta_jit::detail::begin_messages({list_}, {count}, {expression(scope, END)} - {behind}, {around});")
    with function.block(f"if (ROSETTA_JIT_UNLIKELY({count} > 0))"):
        if visit.shallow is not None:
            fail_if(function, expression(scope, folded(nodes.Unary("not", visit.shallow.condition))), visit.shallow.failure)
        with function.block(f"for (int64_t {number} = 0; {number} < {count}; {number}++)"):
            shared = ", ".join(map(scope.takes, shared_by_visits(function)))
            message = f"rosetta_jit::detail::message_of({list_}, {number}, {count})" if list_ else _written(scope, visit, number)
            arguments = (message, behind, bare(expression(scope, visit.depth)))
            function.line(f"{behind} = {visiting(function, visit.lane)}({shared}, {', '.join(arguments)});")
            with function.block(f"if ({behind} < 0)"):
                function.line(f"return {behind};")
        for lane in sorted(lanes.moving):
            scope.moved.add(lane)
            function.line(moved(lanes, lane))


def _visit_one(function: Function, call: nodes.Call, visit: Visit) -> None:
    """One message, which its function measures or writes. The lengths that it adds may move those at hand."""
    assert visit.number is not None
    scope, lanes = function.scope, function.scope.lanes
    found = scope.locals.identifier(call.results[0].name)
    message = _written(scope, visit, bare(expression(scope, visit.number)))
    given = (*map(scope.takes, shared_by_visits(function)), message, *(bare(expression(scope, each)) for each in call.arguments))
    function.line(f"const int64_t {found} = {visiting(function, visit.lane)}({', '.join(given)});")
    with function.block(f"if ({found} < 0)"):
        function.line(f"return {found};")
    for lane in sorted((*lanes.moving, *([lanes.own] if function.role == "size" else ()))):
        scope.moved.add(lane)
        function.line(moved(lanes, lane))


def _length(function: Function, call: nodes.Call) -> None:
    """Where something with a length begins, or ends: what is written knows its lengths only if it was measured."""
    scope = function.scope
    scope.hidden.add(0)
    found, lengths = scope.locals.identifier(call.results[0].name), f"{scope.takes('holder')}->given_lengths"
    given = ", ".join(bare(expression(scope, each)) for each in call.arguments)
    if call.routine == OPENED:
        function.line(f"const int64_t {found} = {lengths}.opened({given});")
    else:
        function.line(f"const int64_t {found} = {lengths}.closed({scope.takes('bytes')}, {expression(scope, END)}, {given});")


def _written(scope: Scope, visit: Visit, number: str) -> str:
    """A message that is written, or measured: the start of the span is the address of the first."""
    return f"{scope.lanes.objects(visit.lane)}::at({bare(expression(scope, visit.start))}, {number})"


def visiting(function: Function, lane: int) -> str:
    """The function for a message of a lane; a kernel with several bodies has one for each."""
    return "_".join((function.role, *filter(None, (function.body,)), function.scope.lanes.rows(lane)))


def _site(problem: str, sites: tuple[int, ...]) -> str:
    """The caller's site for that of a routine."""
    text = str(sites[-1])
    for own, site in reversed(list(enumerate(sites[:-1], 1))):
        text = f"{problem} == {own} ? {site} : {text}" if text != str(site) or len(set(sites)) > 1 else text
    return text


def print_host_call(function: Function, call: nodes.HostCall) -> None:
    """A function that the program has which this becomes part of."""
    scope = function.scope
    result = scope.locals.identifier(call.result.name)
    function.line(f"{C_TYPES[call.result.type]} {result} = 0;")
    arguments = ", ".join((*(bare(expression(scope, each)) for each in call.arguments), f"&{result}"))
    with function.block(f"if (!{scope.lanes.prefix}_{call.function}({arguments}))"):
        fail(function, call.failure)
