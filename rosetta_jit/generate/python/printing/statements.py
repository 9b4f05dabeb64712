"""Kernel statements as Python statements, one a line. What a message cannot be raises `_Failed`."""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.descents import Visit
from rosetta_jit.generate.python.passes.bools import Bools, Flags, bools_read, with_flags
from rosetta_jit.generate.python.passes.groups import bounded, grouped, scalar_of, turned, without_sign
from rosetta_jit.generate.python.passes.mentions import assigned
from rosetta_jit.generate.python.printing.calls import host_call, print_call
from rosetta_jit.generate.python.printing.effects import list_read, origin_comment, print_effect, target_of
from rosetta_jit.generate.python.printing.expressions import expression, is_small, location
from rosetta_jit.generate.python.printing.failures import fail, fail_if, lacks
from rosetta_jit.generate.python.printing.printed import Function
from rosetta_jit.generate.python.printing.reading import rows_read, takes_text
from rosetta_jit.generate.python.printing.reserving import reserve, take
from rosetta_jit.generate.python.printing.rows_at_once import rows_at_once
from rosetta_jit.generate.python.printing.scope import CODES
from rosetta_jit.generate.python.printing.switching import print_switch
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.passes.fold import FALSE, folded
from rosetta_jit.kernel.terms import mul

COPY = "<copy>"
"""Stands for what functions of rows get besides, where some arrays are views of the message."""


def print_block(function: Function, block: nodes.Block) -> None:
    """The statements of a block."""
    before, sums, allowed = len(function.writer.lines), dict(function.scope.sums), function.scope.allowed
    for number, late in enumerate(function.scope.direct.fields):
        if id(block) in late.cases:
            function.line(f"<late {number}>")
    for each in with_flags(block):
        if isinstance(each, Flags):
            _flags(function, each)
        else:
            _groups(function, each)
    if len(function.writer.lines) == before:
        function.line("pass")
    function.scope.sums, function.scope.allowed = sums, allowed
    function.scope.forget(assigned(block))


def _groups(function: Function, block: nodes.Block) -> None:
    for group in grouped(block):
        if len(group) == 1:
            print_statement(function, group[0])
        else:
            _together(function, group)


def _together(function: Function, group: list[nodes.Stmt]) -> None:
    """Scalars that lie one behind the other, by one call."""
    scope, found = function.scope, [each for stmt in group if (each := scalar_of(stmt)) is not None]
    order = next((order for type_, _, order in found if nodes.WIDTH[type_] > 1), "<")
    codes, at = "".join(CODES[type_] for type_, _, _ in found), function.text(found[0][1])
    targets: list[str] = []
    for stmt in group:
        match stmt:
            case nodes.Let(name, _):
                targets.append(scope.locals.identifier(name) if name in function.read else "_")
            case nodes.SetField(place, value):
                targets.append(target_of(function, place, value))
            case nodes.Store(_, value, _):
                targets.append(function.text(value))
            case _:
                raise AssertionError(stmt)
    if isinstance(group[0], nodes.Store):
        function.line(f"{scope.struct(order, codes, 'store')}(data, {at}, {', '.join(targets)})")
    else:
        function.line(f"{', '.join(targets)} = {scope.struct(order, codes, 'load')}(data, {at})")


def print_statement(function: Function, stmt: nodes.Stmt) -> None:
    """One statement."""
    match stmt:
        case nodes.Require(at, size, failure):
            fail_if(function, lacks(function, at, size), failure)
            function.scope.allowed |= bounded(stmt)
        case nodes.Expect(condition, failure):
            if condition == FALSE:
                fail(function, failure)
            elif (taken := takes_text(function.scope, condition)) is not None:
                _taken(function, taken, failure)
            else:
                unsigned = without_sign(condition, function.positive)
                fail_if(function, function.text(folded(nodes.Unary("not", unsigned))), failure)
                function.scope.allowed |= bounded(stmt)
        case nodes.Let(name, value) | nodes.Var(name, value) | nodes.Assign(name, value):
            function.scope.note(name, is_small=isinstance(stmt, nodes.Let) and is_small(value, function.scope.small))
            if name in function.read:
                text = function.text(value)
                function.line(f"{function.scope.locals.identifier(name)} = {text}{origin_comment(function, stmt)}")
                function.scope.forget({name} if isinstance(stmt, nodes.Assign) else set())
                if isinstance(stmt, nodes.Let) and isinstance(value, nodes.Binary) and value.op == "add":
                    function.scope.sums[value] = function.scope.locals.identifier(name)
        case nodes.SetField(place) if place in function.unasked:
            pass
        case nodes.Store() | nodes.SetField() | nodes.Copy() | nodes.Fill():
            print_effect(function, stmt)
        case nodes.Reserve(lane, count):
            reserve(function, lane, count)
        case nodes.Advance(lane, count):
            function.line(f"{function.scope.used(lane)} += {function.text(count)}")
        case nodes.Return():
            _return(function, stmt)
        case nodes.For() | nodes.While() | nodes.If() | nodes.Switch():
            _nested(function, stmt)
        case nodes.Call():
            _call(function, stmt)
        case nodes.HostCall():
            host_call(function, stmt)
        case _:
            assert_never(stmt)


def _return(function: Function, stmt: nodes.Return) -> None:
    """The end of an attempt that has succeeded."""
    position, objects = function.text(stmt.position), function.objects
    if stmt.registers:
        function.scope.from_call.add("registers")
        words = "".join(f"call_registers[{number}], " for number, _ in stmt.registers)
        values = "".join(f"{function.text(value)}, " for _, value in stmt.registers)
        function.line(f"{words}call_end = {values}{position}")
        position = "call_end"
    for line in objects.settings(function.scope):
        function.line(line)
    result = objects.result(function.scope, position)
    if names := objects.inner_names(function.scope) if function.scope.direct.left is None and not function.scope.has_rows_apart else []:
        made = function.scope.locals.identifier("made\0message")
        function.line(f"{made} = {result}")
        function.line(f"del {', '.join(names)}")
        result = made
    function.line(f"return {result}")


def _taken(function: Function, taken: str, failure: nodes.Failure) -> None:
    """A text, which is not valid where it cannot be decoded."""
    with function.writer.indented("try:"):
        function.line(taken)
    with function.writer.indented("except UnicodeDecodeError:"):
        fail(function, failure)


def _nested(function: Function, stmt: nodes.For | nodes.While | nodes.If | nodes.Switch) -> None:
    scope = function.scope
    if isinstance(stmt, nodes.For | nodes.While):
        scope.forget(assigned(stmt.body))
    match stmt:
        case nodes.For(variable, count, _) if (found := turned(stmt)) is not None and variable not in scope.direct.loops:
            _turn(function, count, found, decodes=isinstance(stmt.body[-1], nodes.SetField))
        case nodes.For(variable, count, _) if (bools := bools_read(stmt)) is not None and bools.first.lane in scope.direct.whole:
            _bools(function, variable, count, bools)
        case nodes.For(_, count) if (rows := _rows_read(function, stmt)) is not None:
            _rows(function, stmt, "" if isinstance(count, nodes.Const) else function.text(count), *rows)
        case nodes.For():
            layout = function.objects.layout
            at_once = None if layout is None else rows_at_once(scope, stmt, layout)
            if at_once is None:
                _loop(function, stmt)
                return
            with function.writer.indented(f"if {at_once.condition}:"):
                for line in at_once.lines:
                    function.line(line)
            with function.writer.indented("else:"):
                _loop(function, stmt)
        case nodes.While(condition, body):
            with function.writer.indented(f"while {function.text(condition)}:"):
                print_block(function, body)
        case nodes.If(condition, then, otherwise):
            if not then:
                condition, then, otherwise = folded(nodes.Unary("not", condition)), otherwise, ()
            with function.writer.indented(f"if {function.text(condition)}:"):
                print_block(function, then)
            if otherwise:
                with function.writer.indented("else:"):
                    print_block(function, otherwise)
        case nodes.Switch():
            print_switch(function, stmt, print_block)
        case _:
            assert_never(stmt)


def _loop(function: Function, loop: nodes.For) -> None:
    scope = function.scope
    with function.writer.indented(f"for {scope.locals.identifier(loop.variable)} in range({function.text(loop.count)}):"):
        print_block(function, loop.body)
        if (lane := scope.direct.loops.get(loop.variable)) is not None and lane not in scope.direct.listed:
            function.line(f"{scope.lanes.rows(lane)}.append({function.objects.row(scope, lane)})")


def _rows_read(function: Function, loop: nodes.For) -> tuple[str, int] | None:
    """The rows that a loop takes from the message, if these are read by one call."""
    scope, layout = function.scope, function.objects.layout
    if layout is None:
        return None
    return rows_read(scope, loop, lambda lane: layout.lanes[lane].element, function.objects.row)


def _rows(function: Function, loop: nodes.For, count: str, rows: str, least: int) -> None:
    """Rows that are read by one call, which fewer than the ``least`` are not."""
    lane = function.scope.lanes.rows(function.scope.direct.loops[loop.variable])
    line, lines, empty = f"{lane} += {rows}", function.writer.lines, f"{lane} = []"
    if not count or not least:
        is_first = bool(lines) and lines[-1].strip() == empty
        if is_first:
            lines.pop()
        function.line(f"{lane} = {rows}" if is_first else line)
        return
    with function.writer.indented(f"if {count} >= {least}:"):
        function.line(line)
    with function.writer.indented("else:"):
        _loop(function, loop)


def _flags(function: Function, flags: Flags) -> None:
    """Bools that lie side by side, by one call, behind the checks of all where one of them fails."""
    scope, count = function.scope, len(flags.fields)
    with function.writer.indented(f'if {_part(expression(scope, flags.at), str(count))}.lstrip(b"\\0\\1"):'):
        for check in flags.checks:
            print_statement(function, check)
    targets = ", ".join(target_of(function, each.place, each.value) for each in flags.fields)
    function.line(f"{targets} = {scope.struct('<', '?' * count, 'load')}(data, {function.text(flags.at)})")


def _part(begin: str, length: str) -> str:
    """A part of the message, of a length."""
    return f"data[{bare(begin)} : {begin} + {length}]" if begin != "0" else f"data[:{bare(length)}]"


def _bools(function: Function, variable: str, count: nodes.Expr, bools: Bools) -> None:
    """An array of bools, which begins with as many bytes that are 0 or 1 as there are until another one comes."""
    assert bools.check is not None
    scope, number, length = function.scope, function.scope.locals.identifier(variable), expression(function.scope, count)
    part = _part(expression(scope, bools.base), length)
    function.line(f'{number} = {length} - len({part}.lstrip(b"\\0\\1"))')
    with function.writer.indented(f"if {number} < {length}:"):
        print_block(function, bools.before) if bools.before else None
        fail(function, bools.check.failure)
    function.line(f"{scope.lanes.rows(bools.first.lane)} = {list_read(function, bools.first.lane, bools.base, count, '<')}")


def _turn(function: Function, count: nodes.Expr, found: tuple[nodes.Place, nodes.Expr, str], *, decodes: bool) -> None:
    """An array whose numbers have their high byte first, as a whole."""
    place, base, type_ = found
    scope, size = function.scope, f"{expression(function.scope, count)} * {nodes.WIDTH[type_]}"
    if place.lane in scope.direct.whole:
        function.line(f"{scope.lanes.rows(place.lane)} = {list_read(function, place.lane, base, mul(count, nodes.WIDTH[type_]), '>')}")
        return
    (lane, first), begin = location(scope, place), expression(scope, base)
    rows, part = f"{lane}[{first} : {first} + {size}]", f"data[{bare(begin)} : {begin} + {size}]"
    target, source = (rows, part) if decodes else (part, rows)
    with function.writer.indented(f"if {function.text(count)} > 0:"):
        function.line(f'{target} = _turned({source}, "{CODES[type_]}")')


def _call(function: Function, call: nodes.Call) -> None:
    visit = function.scope.direct.visits.get(call.routine)
    if visit is None:
        print_call(function, call)
    else:
        _visit(function, call, visit)


def _visit(function: Function, call: nodes.Call, visit: Visit) -> None:
    """The messages of an array, of a type that contains itself, each read by a function."""
    scope = function.scope
    name, at, count = scope.visited(visit), scope.locals.identifier(call.results[0].name), function.text(visit.count)
    function.line(f"{name} = []")
    function.line(f"{at} = {function.text(call.arguments[0])}")
    checks = scope.direct.checks.get(call.routine, ())
    with function.writer.indented(f"if {count}:" if checks else f"if {count} > 0:"):
        for check in checks:
            print_statement(function, check)
        take(function, visit.lane, count)
        if visit.shallow is not None:
            print_statement(function, visit.shallow)
        with function.writer.indented(f"for _ in range({count}):"):
            function.line(f"element, {at} = {scope.reader(visit.lane)}(data, end, left, {at}, {function.text(visit.depth)}{COPY})")
            function.line(f"{name}.append(element)")
