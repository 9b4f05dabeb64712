"""Kernel statements as forms, one a line. What a message cannot be ends an attempt with what `fail` gives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import assert_never

from rosetta_jit.generate.lisp.bindings import Variable, bound
from rosetta_jit.generate.lisp.expressions import Scope, access, expression, got, location, state_word, zero
from rosetta_jit.generate.lisp.lines import Lines
from rosetta_jit.generate.lisp.texts import literal
from rosetta_jit.generate.lisp.words import LISP_TYPES, hyphenated
from rosetta_jit.generate.origins import Origin, described, origin_of
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.passes.fold import FALSE, folded
from rosetta_jit.kernel.terms import END, add, type_of
from rosetta_jit.startup.dataclass import dataclass, field

NOTHING: Mapping[str, str] = MappingProxyType({})

BOXED: frozenset[nodes.Scalar] = frozenset({"u64"})
"""Numbers of these types are boxed where they are arguments of more than 62 bits. Positions and counts never have so many."""


@dataclass(slots=True)
class Function:
    """One function being printed: its name, and what it shares with others.

    ``read`` are the locals whose values anything needs. ``is_routine``: it gives the number of its own site that failed, or 0.
    ``routines`` are the functions of routines by name. ``numbers`` are the rows of the table that sites of the kernel have got, ``paths``
    the fields that lanes belong to, ``functions`` those of the mapping by name.
    ``staying`` are lanes of which a message leaves rows to others. ``spilled`` are locals that lie in the codec, each with the form that
    reads and sets it there. ``passed`` are the arguments that a global function passes on to each part and routine.
    """

    name: str
    scope: Scope
    sites: Sequence[ir.Site]
    routines: Mapping[str, str]
    numbers: dict[int, int]
    paths: Sequence[str]
    functions: Mapping[str, str]
    origins: Sequence[Origin] = ()
    read: frozenset[str] = frozenset()
    is_routine: bool = False
    staying: Sequence[int] = ()
    spilled: Mapping[str, str] = NOTHING
    passed: str = ""
    lines: Lines = field(default_factory=Lines)

    def line(self, form: str, said: str = "") -> None:
        self.lines.line(form, said)

    def form(self, expr: nodes.Expr) -> str:
        return expression(self.scope, expr)

    def leave(self, value: str) -> str:
        """The form that ends the function with a value."""
        return f"(return-from {self.name} {value})"

    def site(self, number: int) -> int:
        """The row of a site in the table, which has those alone that a function names."""
        return number if self.is_routine else self.numbers.setdefault(number, len(self.numbers))


def print_block(function: Function, block: nodes.Block, finish: Callable[[], None] | None = None, lanes: Sequence[Variable] = ()) -> None:
    """The statements of a block, and what finishes it, within variables for lanes and those that it binds."""
    block = tuple(stmt for stmt in block if not (isinstance(stmt, nodes.Let | nodes.Var | nodes.Assign) and stmt.name not in function.read))
    first = next((number for number, stmt in enumerate(block) if not _binds_at_once(function, stmt)), len(block))
    found = [each for number, stmt in enumerate(block) for each in _bound_by(function, stmt, first=number < first)]
    with bound(function.lines, [*lanes, *found]):
        for stmt in block[first:]:
            _statement(function, stmt)
        if finish is not None:
            finish()


def _binds_at_once(function: Function, stmt: nodes.Stmt) -> bool:
    return isinstance(stmt, nodes.Let | nodes.Var) and stmt.name not in function.spilled


def _bound_by(function: Function, stmt: nodes.Stmt, *, first: bool) -> Iterator[Variable]:
    """The variables of a statement: those before the first other statement have their own values, others have zero until they are set."""
    match stmt:
        case nodes.Let(name, value) | nodes.Var(name, value):
            type_ = type_of(value)
            if name not in function.spilled:
                yield Variable(function.scope.locals.symbol(name), LISP_TYPES[type_], function.form(value) if first else zero(type_))
        case nodes.Call(_, _, results):
            yield from (_unset(function, each) for each in results if each.name in function.read and each.name not in function.spilled)
        case nodes.HostCall(_, _, result) if result.name not in function.spilled:
            yield _unset(function, result)
        case _:
            return


def _unset(function: Function, local: nodes.Local) -> Variable:
    return Variable(function.scope.locals.symbol(local.name), LISP_TYPES[local.type], zero(local.type))


def _statement(function: Function, stmt: nodes.Stmt) -> None:
    match stmt:
        case nodes.Require(at, size, failure):
            with function.lines.form(f"(when {_lacks(function, at, size)}"):
                _fail(function, failure)
        case nodes.Expect(condition, failure):
            if condition == FALSE:
                _fail(function, failure)
            else:
                _fail_unless(function, condition, failure)
        case nodes.Let(name, value) | nodes.Var(name, value) | nodes.Assign(name, value):
            function.line(f"(setf {function.scope.locals.symbol(name)} {function.form(value)})", _origin(function, stmt))
        case nodes.Store() | nodes.SetField() | nodes.Copy() | nodes.Fill():
            function.line(_effect(function.scope, stmt), _origin(function, stmt))
        case nodes.Reserve() | nodes.Advance():
            _rows(function, stmt)
        case nodes.Return(position, changed):
            _return(function, position, changed)
        case nodes.For() | nodes.While() | nodes.If() | nodes.Switch():
            _nested(function, stmt)
        case nodes.Call():
            _call(function, stmt)
        case nodes.HostCall():
            _host_call(function, stmt)
        case _:
            assert_never(stmt)


def _return(function: Function, position: nodes.Expr, changed: Sequence[tuple[int, nodes.Expr]]) -> None:
    """The end of a message that was handled: only now state changes, all of it at once."""
    if not changed:
        function.line(function.leave(function.form(position)))
        return
    assigned = " ".join(f"{state_word(function.scope, number)} {function.form(value)}" for number, value in changed)
    with function.lines.form(f"(let ((behind {function.form(position)}))"):
        function.line("(declare (type i64 behind))")
        function.line(f"(psetf {assigned})")
        for lane in function.staying:
            function.line(f"(setf {function.scope.lanes.place_of_used(lane)} {function.scope.used(lane)})")
        function.line(function.leave("behind"))


def _origin(function: Function, stmt: nodes.Stmt) -> str:
    """The line of the mapping that a statement comes from."""
    return (origin_of(stmt, function.origins) or "") if function.origins else ""


def _lacks(function: Function, at: nodes.Expr, size: nodes.Expr) -> str:
    """Whether bytes are missing."""
    match at, size:
        case nodes.Const(_, start), nodes.Const(_, length) if start >= 0 and length >= 0:
            return f"(< {function.form(END)} {function.form(add(at, size))})"
        case _:
            return f"(lacks {function.form(at)} {function.form(size)} end)"


def _fail_unless(function: Function, condition: nodes.Expr, failure: nodes.Failure) -> None:
    otherwise = folded(nodes.Unary("not", condition))
    bare = isinstance(otherwise, nodes.Unary) and otherwise.function == "not"
    with function.lines.form(f"(unless {function.form(condition)}" if bare else f"(when {function.form(otherwise)}"):
        _fail(function, failure)


def _fail(function: Function, failure: nodes.Failure) -> None:
    site, at = function.site(failure.site), function.form(failure.at)
    said = described(function.sites[failure.site])
    if function.is_routine:
        function.line(function.leave(f"(fail-here codec {site} {at})"), said)
        return
    indices = "".join(f" {function.form(each)}" for each in failure.indices)
    function.line(function.leave(f"(fail codec {site} {at}{indices})"), said)


def _effect(scope: Scope, stmt: nodes.Effect) -> str:
    match stmt:
        case nodes.Store(at, value, order):
            return f"(setf ({access(type_of(value), order)} data {expression(scope, at)}) {expression(scope, value)})"
        case nodes.SetField(place, value):
            return f"(setf {got(scope, type_of(value), place)} {expression(scope, value)})"
        case nodes.Copy(target, source, size):
            (to, first), (of, begin) = location(scope, target), location(scope, source)
            return f"(copy-octets {to} {first} {of} {begin} {expression(scope, size)})"
        case nodes.Fill(target, size, byte):
            to, first = location(scope, target)
            return f"(fill-octets {to} {first} {expression(scope, size)} {byte})"
        case _:
            assert_never(stmt)


def _rows(function: Function, stmt: nodes.Reserve | nodes.Advance) -> None:
    scope, lane, count = function.scope, stmt.lane, function.form(stmt.count)
    used = scope.used(lane)
    if isinstance(stmt, nodes.Advance):
        function.line(f"(setf {used} (i64+ {used} {count}))")
        return
    path = literal(function.paths[lane]) if lane < len(function.paths) else '""'
    full = function.leave(f"(full codec {path})")
    rows, place, stride = scope.rows(lane), scope.lanes.place(lane), scope.lanes.stride(lane)
    function.line(f"(reserve ({rows} {place} {stride}) {used} {count} codec {full})")


def _nested(function: Function, stmt: nodes.For | nodes.While | nodes.If | nodes.Switch) -> None:
    match stmt:
        case nodes.For(variable, count, body):
            _for(function, variable, function.form(count), body)
        case nodes.While(condition, body):
            with function.lines.form(f"(while {function.form(condition)}"):
                print_block(function, body)
        case nodes.If(condition, then, otherwise):
            _if(function, condition, then, otherwise)
        case nodes.Switch(value, cases, default):
            with function.lines.form(f"(case {function.form(value)}"):
                for number, body in cases:
                    with function.lines.form(f"({number}", by=1):
                        print_block(function, body)
                with function.lines.form("(t", by=1):
                    print_block(function, default)
        case _:
            assert_never(stmt)


def _for(function: Function, variable: str, count: str, body: nodes.Block) -> None:
    """A loop; where parts of it use the variable, it counts with one of its own."""
    name = function.scope.locals.symbol(variable)
    own = function.scope.locals.symbol(f"{variable} here") if variable in function.spilled else name
    with function.lines.form(f"(for ({own} {count})"):
        if own != name:
            function.line(f"(setf {name} {own})")
        print_block(function, body)


def _if(function: Function, condition: nodes.Expr, then: nodes.Block, otherwise: nodes.Block) -> None:
    if not (then and otherwise):
        with function.lines.form(f"({'when' if then else 'unless'} {function.form(condition)}"):
            print_block(function, then or otherwise)
        return
    with function.lines.form("(cond"):
        with function.lines.form(f"({function.form(condition)}", by=1):
            print_block(function, then)
        while len(otherwise) == 1 and isinstance(otherwise[0], nodes.If) and otherwise[0].then:
            inner = otherwise[0]
            with function.lines.form(f"({function.form(inner.condition)}", by=1):
                print_block(function, inner.then)
            otherwise = inner.otherwise
        if otherwise:
            with function.lines.form("(t", by=1):
                print_block(function, otherwise)


def _call(function: Function, call: nodes.Call) -> None:
    """A call of a routine, or of a part of the function.

    A routine returns the number of its own site that failed, or 0. Its results, and arguments of `BOXED` types, lie in slots of the codec.
    A part returns what the whole function returns then, or 0 if it goes on.
    """
    if call.routine not in function.routines:
        function.line(f"(run-part ({call.routine}{function.passed}) {function.name})")
        return
    boxed = [each for each in call.arguments if type_of(each) in BOXED]
    for register, each in zip(registers(map(type_of, boxed)), boxed, strict=True):
        function.line(f"(setf {register} {function.form(each)})")
    arguments = "".join(f" {function.form(each)}" for each in call.arguments if type_of(each) not in BOXED)
    called = f"({function.routines[call.routine]}{function.passed}{arguments})"
    problem = function.scope.locals.symbol(f"{call.routine} problem")
    if not call.sites:
        function.line(called)
    else:
        _call_that_fails(function, call, called, problem)
    for result, register in zip(call.results, registers(each.type for each in call.results), strict=True):
        if result.name in function.read:
            function.line(f"(setf {function.scope.locals.symbol(result.name)} {register})")


def _call_that_fails(function: Function, call: nodes.Call, called: str, problem: str) -> None:
    with function.lines.form(f"(let (({problem} {called}))"):
        function.line(f"(declare (type fixnum {problem}))")
        with function.lines.form(f"(when (/= {problem} 0)"):
            function.line(function.leave(_passed_on(function, problem, call)))


def _passed_on(function: Function, problem: str, call: nodes.Call) -> str:
    """The caller's site for that of a routine."""
    sites = tuple(map(function.site, call.sites))
    site = str(sites[-1]) if len(set(sites)) == 1 else f"(svref #({' '.join(map(str, sites))}) (1- {problem}))"
    if function.is_routine:
        return site
    indices = "".join(f" {function.form(each)}" for each in call.indices)
    return f"(fail-there codec {site}{indices})"


def registers(types: Iterable[nodes.Scalar]) -> list[str]:
    """Where values pass between a routine and its callers: slots of the codec, by their types."""
    counts: dict[str, int] = {}
    found: list[str] = []
    for each in types:
        counts[each] = counts.get(each, 0) + 1
        found.append(f"(codec-state-{each}-passed-{counts[each]} codec)")
    return found


def _host_call(function: Function, call: nodes.HostCall) -> None:
    """A function that the program has which this becomes part of."""
    scope, site = function.scope, function.site(call.failure.site)
    indices = "".join(f" {function.form(each)}" for each in call.failure.indices)
    refused = function.leave(f"(fail codec {site} {function.form(call.failure.at)}{indices})")
    arguments = "".join(f" {function.form(each)}" for each in call.arguments)
    name = function.functions.get(call.function, hyphenated(call.function))
    found = f"(call-function ({name} {LISP_TYPES[call.result.type]}) {refused}{arguments})"
    function.line(f"(setf {scope.locals.symbol(call.result.name)} {found})")
