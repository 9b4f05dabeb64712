"""Kernel statements as C statements, one a line.

What a message cannot be ends a function with a negative result: `fail` notes the site, the offset and the indices.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.c.aligned import aligned
from rosetta_jit.generate.c.expressions import expression, list_within, location, store, written
from rosetta_jit.generate.c.flag_loops import flags_done, flags_of
from rosetta_jit.generate.c.positions import (
    NONE,
    Positions,
    after_binding,
    after_call,
    after_require,
    bound_in,
    forget,
    is_position,
    joined,
    said_by,
)
from rosetta_jit.generate.c.room import rows_of
from rosetta_jit.generate.c.state import register_word
from rosetta_jit.generate.c.straight import statement as straight_statement
from rosetta_jit.generate.c.texts import comment
from rosetta_jit.generate.c.varint_loops import REPLACED, Sized, replaced, rounds_done, rounds_of, sooner
from rosetta_jit.generate.c.words import C_TYPES
from rosetta_jit.generate.origins import Origin, described, origin_of
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.reachable import leaves
from rosetta_jit.generate.unit import Role
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.passes.fold import FALSE, folded
from rosetta_jit.kernel.terms import END, add, type_of
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.c.scope import Scope


@dataclass(frozen=True, slots=True)
class Callable:
    """A routine as a C function: its name, what it takes besides its own parameters, and which results are positions of the message."""

    name: str
    shared: tuple[str, ...]
    fails: bool
    positions: frozenset[int] = frozenset()


@dataclass(slots=True)
class Function:
    """One function being printed.

    ``read`` are the locals whose values anything needs; ``finish`` are the lines before a return of success. ``is_routine``: it
    returns the numbers of its own sites. ``numbers`` are the rows of the file's table that sites of the kernel have got, ``origins`` what
    rules of the mapping name. ``role`` is what its kernel is for. ``otherwise`` is
    what is done where a message cannot be, if nobody is told why. ``known`` are positions of the message where the next statement stands,
    ``aligned`` other forms of values that the block's locals have.
    """

    scope: Scope
    sites: Sequence[ir.Site]
    routines: Mapping[str, Callable]
    read: frozenset[str] = frozenset()
    finish: tuple[str, ...] = ()
    is_routine: bool = False
    numbers: dict[int, int] = field(default_factory=lambda: {0: 0})
    origins: Sequence[Origin] = ()
    role: Role = "decode"
    otherwise: str = ""
    known: Positions = NONE
    aligned: Mapping[str, nodes.Expr] = field(default_factory=dict[str, nodes.Expr])
    writer: Writer = field(default_factory=lambda: Writer(depth=1))

    def line(self, text: str) -> None:
        self.writer.line(text)

    def site(self, number: int) -> int:
        """The row of a site in the table, which has those alone that a function names."""
        return number if self.is_routine else self.numbers.setdefault(number, len(self.numbers))

    @contextmanager
    def block(self, head: str) -> Generator[None]:
        """Braces around what is written until the end of the `with`."""
        with self.writer.indented(f"{head} {{"):
            yield
        self.line("}")


def print_block(function: Function, block: nodes.Block) -> Positions:
    """The statements of a block, and what is known of positions behind it; in the function it holds in there alone."""
    known, others = function.known, function.aligned
    function.aligned = aligned(block)
    for stmt in block:
        _statement(function, stmt)
    found, function.known, function.aligned = function.known, known, others
    return found


def _statement(function: Function, stmt: nodes.Stmt) -> None:
    scope = function.scope
    match stmt:
        case nodes.Require(at, size, failure):
            _fail_if(function, lacks(function, at, size), failure)
            function.known = after_require(function.known, at, size)
        case nodes.Expect(condition, failure):
            if condition == FALSE:
                _fail(function, failure)
            else:
                _fail_if(function, expression(scope, folded(nodes.Unary("not", condition))), failure)
        case nodes.Let() | nodes.Var() | nodes.Assign():
            _bind(function, stmt)
            function.known = after_binding(function.known, stmt.name, stmt.value)
        case nodes.SetField(place, value) if (straight := straight_statement(scope, place, value)) is not None:
            if straight:
                function.line(f"{straight}{_origin(function, stmt)}")
        case nodes.Store() | nodes.SetField() | nodes.Copy() | nodes.Fill():
            function.line(f"{_effect(scope, stmt)}{_origin(function, stmt)}")
        case nodes.Reserve() | nodes.Advance():
            for line in rows_of(scope, stmt):
                function.line(line)
        case nodes.Return(position, registers):
            for line in function.finish:
                function.line(line)
            for number, value in registers:
                scope.takes("holder")
                function.line(f"{register_word(function.role, number)} = {bare(expression(scope, value))};")
            function.line(f"return {bare(expression(scope, position))};")
        case nodes.For() | nodes.While() | nodes.If() | nodes.Switch():
            _nested(function, stmt)
        case nodes.Call():
            _call(function, stmt)
            found = function.routines[stmt.routine].positions if stmt.routine in function.routines else frozenset[int]()
            function.known = after_call(function.known, stmt, found)
        case nodes.HostCall():
            _host_call(function, stmt)
            function.known = forget(function.known, bound_in(stmt))
        case _:
            assert_never(stmt)


def _bind(function: Function, stmt: nodes.Let | nodes.Var | nodes.Assign) -> None:
    """A local, if anything reads it."""
    if stmt.name not in function.read:
        return
    name, value = function.scope.locals.identifier(stmt.name), bare(expression(function.scope, function.aligned.get(stmt.name, stmt.value)))
    declared = "" if isinstance(stmt, nodes.Assign) else f"{C_TYPES[type_of(stmt.value)]} "
    function.line(f"{'const ' if isinstance(stmt, nodes.Let) else ''}{declared}{name} = {value};{_origin(function, stmt)}")


def _origin(function: Function, stmt: nodes.Stmt) -> str:
    """The line of the mapping that a statement comes from, as a comment behind it."""
    line = origin_of(stmt, function.origins) if function.origins else None
    return "" if line is None else f" {comment(line)}"


def _effect(scope: Scope, stmt: nodes.Effect) -> str:
    match stmt:
        case nodes.Store(at, value, order):
            return store(scope, at, value, order)
        case nodes.SetField(place, value):
            return written(scope, place, value)
        case nodes.Copy(target, source, size):
            return _copy(scope, target, source, size)
        case nodes.Fill(target, size, byte):
            return _fill(scope, target, size, byte)
        case _:
            assert_never(stmt)


def _copy(scope: Scope, target: nodes.Address, source: nodes.Address, count: nodes.Expr) -> str:
    size = bare(expression(scope, count))
    if isinstance(source, nodes.Place) and (view := _shown(scope, source)) is not None:
        taken = (*location(scope, target), *view, str(source.offset), size)
        return f"rosetta_jit::detail::copy_rows({', '.join(taken)});"
    if scope.lanes.dialect == "c++" and isinstance(count, nodes.Const):
        return f"rosetta_jit::detail::copy_known<{size}>({', '.join((*location(scope, target), *location(scope, source)))});"
    copied = ", ".join((*location(scope, target), *location(scope, source), size))
    lanes = [each.lane for each in (target, source) if isinstance(each, nodes.Place)]
    if scope.lanes.dialect == "c++" and any(scope.lanes.stride(lane) > 1 or lane in scope.lanes.opened for lane in lanes):
        return f"rosetta_jit::detail::copy_numbers({copied});"
    if scope.lanes.dialect == "c++" and isinstance(source, nodes.Place):
        return f"rosetta_jit::detail::copy_few({copied});"
    return f"{scope.calls('copy_bytes')}({copied});"


def _shown(scope: Scope, source: nodes.Place) -> tuple[str, str] | None:
    """What shows a list of an object, and the number of an element, if rows are made of these."""
    if source.lane in scope.lanes.within:
        return list_within(scope, source.lane, source.row)
    return (scope.rows(source.lane), bare(expression(scope, source.row))) if source.lane in scope.lanes.viewed else None


def lacks(function: Function, at: nodes.Expr, size: nodes.Expr) -> str:
    """Whether some of ``size`` bytes from ``at`` are missing."""
    scope = function.scope
    is_known = is_position(function.known, at)
    match size:
        case nodes.Const(_, length) if is_known and length >= 0:
            return f"({expression(scope, END)} < {bare(expression(scope, add(at, size)))})"
        case _:
            arguments = [bare(expression(scope, each)) for each in (at, size, END)]
            return f"{scope.calls('lacks_behind' if is_known else 'lacks')}({', '.join(arguments)})"


def _fail_if(function: Function, condition: str, failure: nodes.Failure) -> None:
    with function.block(f"if ({bare(condition)})"):
        _fail(function, failure)


def _fail(function: Function, failure: nodes.Failure) -> None:
    _failed(
        function, str(function.site(failure.site)), expression(function.scope, failure.at), failure.indices, function.sites[failure.site]
    )


def _failed(function: Function, site: str, at: str, indices: tuple[nodes.Expr, ...], about: ir.Site | None) -> None:
    """Leave the function. A routine leaves the indices to who calls it."""
    if function.otherwise:
        function.line(function.otherwise)
        return
    function.scope.takes("failure")
    for number, each in enumerate(indices if not function.is_routine else ()):
        function.line(f"failure->indices[{number}] = {bare(expression(function.scope, each))};")
    said = "" if about is None else f" {comment(described(about))}"
    name = "fail_here" if function.is_routine else "fail"
    function.line(f"return {function.scope.calls(name)}(failure, {site}, {bare(at)});{said}")


def _fill(scope: Scope, target: nodes.Address, size: nodes.Expr, byte: int) -> str:
    memory, start = location(scope, target)
    is_known = isinstance(size, nodes.Const) and size.value > 0
    if scope.lanes.dialect == "c++" and is_known:
        return f"rosetta_jit::detail::fill_known<{expression(scope, size)}>({memory}, {start}, {byte});"
    if isinstance(target, nodes.Place) and is_known and start == "0":
        return f"memset({memory}, {byte}, {expression(scope, size)});"
    if scope.lanes.dialect == "c++":
        return f"rosetta_jit::detail::fill_few({memory}, {start}, {bare(expression(scope, size))}, {byte});"
    return f"{scope.calls('fill_bytes')}({memory}, {start}, {bare(expression(scope, size))}, {byte});"


def _nested(function: Function, stmt: nodes.For | nodes.While | nodes.If | nodes.Switch) -> None:
    """A statement with blocks, and what is known of positions behind it."""
    match stmt:
        case nodes.For() | nodes.While():
            function.known = forget(function.known, bound_in(stmt))
            function.known |= said_by(stmt.invariant) if isinstance(stmt, nodes.While) else NONE
            _loop(function, stmt)
        case nodes.If(condition, then, otherwise):
            function.known = joined(stmt, _if(function, condition, then, otherwise))
        case nodes.Switch(value, cases, default):
            with function.block(f"switch ({bare(expression(function.scope, value))})"):
                ends = [
                    each
                    for number, body in cases
                    for each in _case(function, f"case {expression(function.scope, nodes.Const(type_of(value), number))}:", body)
                ]
                ends += _case(function, "default:", default)
            function.known = joined(stmt, ends)
        case _:
            assert_never(stmt)


def _loop(function: Function, stmt: nodes.For | nodes.While) -> None:
    """A loop: within it, what it changes is not known but for what it says."""
    scope = function.scope
    match stmt:
        case nodes.For(variable, count, body):
            name, bound = scope.locals.identifier(variable), bare(expression(scope, count))
            if not isinstance(count, nodes.Const | nodes.Local):
                function.line(f"const int64_t {(before := scope.locals.identifier(f'{variable} count'))} = {bound};")
                bound = before
            flags = flags_of(stmt)
            done = None if flags is None else flags_done(scope, flags, bound)
            if flags is not None and done is not None and not flags.is_read:
                function.line(f"{done};")
                return
            begin = f"int64_t {name} = {done or 0}"
            with _unless_copied(function, stmt, bound), function.block(f"for ({begin}; {name} < {bound}; {name}++)"):
                print_block(function, body)
        case nodes.While(condition, body):
            rounds = rounds_of(stmt) if scope.lanes.dialect == "c++" else None
            for line in rounds_done(scope, rounds) if rounds is not None else ():
                function.line(line)
            if isinstance(rounds, Sized):
                return
            with function.block(f"while ({bare(expression(scope, condition))})"):
                print_block(function, body)
        case _:
            assert_never(stmt)


@contextmanager
def _unless_copied(function: Function, stmt: nodes.For, count: str) -> Generator[None]:
    """Around a loop that sets a list: where its elements lie in the object as in the message, all are copied at once instead."""
    scope, packed = function.scope, function.scope.lanes.packed.get(stmt)
    if packed is None:
        yield
        return
    scope.moved.add(packed.lane)
    with function.block(f"if ({packed.lies})"):
        what = (scope.rows(packed.lane), f"{scope.takes('bytes')} + {expression(scope, packed.at)}", f"{count} * {packed.size}")
        function.line(f"{packed.copy}({', '.join(what)});")
    function.writer.lines[-1] += " else {"
    function.writer.depth += 1
    yield
    function.writer.depth -= 1
    function.line("}")


def _if(function: Function, condition: nodes.Expr, then: nodes.Block, otherwise: nodes.Block) -> list[Positions]:
    """What is known at the ends of the branches that have one."""
    if not then:
        condition, then, otherwise = folded(nodes.Unary("not", condition)), otherwise, ()
    with function.block(f"if ({bare(expression(function.scope, condition))})"):
        ends = _branch(function, then)
    if not otherwise:
        return [*ends, function.known]
    function.writer.lines[-1] += " else {"
    function.writer.depth += 1
    ends += _branch(function, otherwise)
    function.writer.depth -= 1
    function.line("}")
    return ends


def _branch(function: Function, block: nodes.Block) -> list[Positions]:
    known = print_block(function, block)
    return [] if leaves(block) else [known]


def _case(function: Function, label: str, body: nodes.Block) -> list[Positions]:
    function.writer.depth -= 1
    with function.block(label):
        ends = _branch(function, body)
        if ends:
            function.line("break;")
    function.writer.depth += 1
    return ends


def _call(function: Function, call: nodes.Call) -> None:
    """Results come through pointers; what the function returns is the number of its own site that failed, or 0."""
    scope = function.scope
    if scope.lanes.dialect == "c++" and call.routine in REPLACED:
        for line in replaced(scope, call):
            function.line(line)
        return
    routine = function.routines[call.routine]
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
        _failed(function, _site(problem, tuple(map(function.site, call.sites))), "failure->offset", call.indices, None)


def _site(problem: str, sites: tuple[int, ...]) -> str:
    """The caller's site for that of a routine."""
    text = str(sites[-1])
    for own, site in reversed(list(enumerate(sites[:-1], 1))):
        text = f"{problem} == {own} ? {site} : {text}" if text != str(site) or len(set(sites)) > 1 else text
    return text


def _host_call(function: Function, call: nodes.HostCall) -> None:
    """A function that the program has which this becomes part of."""
    scope = function.scope
    result = scope.locals.identifier(call.result.name)
    function.line(f"{C_TYPES[call.result.type]} {result} = 0;")
    arguments = ", ".join((*(bare(expression(scope, each)) for each in call.arguments), f"&{result}"))
    with function.block(f"if (!{scope.lanes.prefix}_{call.function}({arguments}))"):
        _fail(function, call.failure)
