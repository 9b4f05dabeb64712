"""A kernel as functions. A small one is one function whose attempts and routines are local: numbers pass between these unboxed.

(decode-kernel codec data end attempt)      where the message ends, or -1 - site

Of a large one each attempt, each part of one (`generate.lisp.parts`) and each routine is a function of its own:

(decode.1 codec data end)                   where the message ends, or -1 - site
(decode.1.7 codec data end)                 0, or -1 - site: a part of that attempt
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rosetta_jit.generate.lisp.bindings import Variable, declaration, named_forms
from rosetta_jit.generate.lisp.expressions import Scope, access, expression
from rosetta_jit.generate.lisp.lines import Lines
from rosetta_jit.generate.lisp.parts import is_large, names_in, parted
from rosetta_jit.generate.lisp.statements import BOXED, Function, print_block, registers
from rosetta_jit.generate.lisp.words import LISP_TYPES, Names, hyphenated
from rosetta_jit.generate.origins import Origin
from rosetta_jit.generate.passes.reachable import leaves, reached, read_names
from rosetta_jit.generate.shares import changed_lanes
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.ir import Kernel, Routine, Site
from rosetta_jit.kernel.nodes import Binary, Block, Compare, Convert, Decimal, Expect, Expr, HostCall, Local, Require, Scalar, Unary
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import expressions_of, flat, statements, subexpressions
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.lisp.lanes import Lanes

OPTIMIZED = "(optimize (speed 1) (safety 0) (debug 0) (compilation-speed 2))"
"""Where compiling fast counts more than fast code, SBCL does not join what it knows of variables where branches meet. Kernels gain
nothing by that, and those of large types would take twice the time and the memory."""

SHARED = "codec data end"
"""The parameters that functions have which see no variables of each other."""
TYPES_OF_SHARED = "(type codec codec) (type octets data) (type i64 end)"
DECLARED = f"(declare {OPTIMIZED} {TYPES_OF_SHARED} (ignorable {SHARED}))"
WORD = 8
"""Bytes of a place for a spilled local."""


@dataclass(frozen=True, slots=True)
class About:
    """What a kernel is printed with: the lines of the mapping, the fields that lanes belong to, and the mapping's functions by name."""

    origins: Sequence[Origin] = ()
    paths: Sequence[str] = ()
    functions: Mapping[str, str] | None = None


@dataclass(frozen=True, slots=True)
class Printed:
    """A kernel's functions as text, its attempts, the sites that it names, and how many bytes its spilled locals take."""

    text: str
    attempts: int
    sites: tuple[int, ...]
    spilled: int


def print_kernel(kernel: Kernel, lanes: Lanes, role: str, about: About) -> Printed:
    """The functions of a kernel that is for a message alone (`kernel.passes.alone`); their names begin with the role."""
    bodies = tuple(map(reached, kernel.bodies))
    printing = _Printing(kernel, lanes, role, about, changed_lanes(kernel))
    if any(map(is_large, bodies)):
        printing.several(bodies)
    else:
        printing.one(bodies)
    return Printed(printing.lines.text(), len(bodies), tuple(printing.numbers), printing.spilled)


@dataclass(slots=True)
class _Printing:
    """``staying`` are lanes of which a message leaves rows to others, ``numbers`` the rows of the table that sites have got.

    ``routines`` are the functions of routines by their names.
    """

    kernel: Kernel
    lanes: Lanes
    role: str
    about: About
    staying: tuple[int, ...]
    numbers: dict[int, int] = field(default_factory=lambda: {0: 0})
    routines: dict[str, str] = field(default_factory=dict[str, str])
    lines: Lines = field(default_factory=Lines)
    spilled: int = 0

    def one(self, bodies: Sequence[Block]) -> None:
        """All of the kernel as one function."""
        names, lines = Names(frozenset()), self.lines
        attempts = [names.symbol(f"{self.role}-{number}") for number in range(1, len(bodies) + 1)]
        with self._kernel(), lines.form("(labels"):
            first = len(lines.lines)
            lines.column += 3
            for routine in self.kernel.routines:
                self._routine(routine, names.symbol(f"{self.role}-{hyphenated(routine.name)}"))
            for name, body in zip(attempts, bodies, strict=True):
                self._attempt(name, body)
            lines.column -= 3
            lines.close()
            lines.lines[first].column -= 1
            lines.lines[first].text = f"({lines.lines[first].text}"
            lines.line(_chosen([f"({name})" for name in attempts]))

    def several(self, bodies: Sequence[Block]) -> None:
        """Each attempt, part and routine as a function, behind those that it calls."""
        names = Names(frozenset())
        for routine in self.kernel.routines:
            self._routine(routine, f"{self.role}.{names.symbol(routine.name)}", SHARED)
        attempts = [f"{self.role}.{number}" for number in range(1, len(bodies) + 1)]
        for name, body in zip(attempts, bodies, strict=True):
            self._parts(name, body)
        with self._kernel():
            self.lines.line(_chosen([f"({name} {SHARED})" for name in attempts]))

    @contextmanager
    def _kernel(self) -> Generator[None]:
        declared = f"(declare {OPTIMIZED} {TYPES_OF_SHARED} (type fixnum attempt) (ignorable {SHARED} attempt))"
        with self._defun(f"{self.role}-kernel", f"{SHARED} attempt", declared):
            yield

    @contextmanager
    def _defun(self, name: str, parameters: str, declared: str, said: str = "") -> Generator[None]:
        if self.lines.lines:
            self.lines.line("")
        if said:
            self.lines.said(said)
        with self.lines.form(f"(defun {name} ({parameters})"):
            self.lines.line(declared)
            yield

    def _function(self, name: str, locals_: Names, read: frozenset[str], spilled: Mapping[str, str] | None = None) -> Function:
        """An attempt, or a part of one; with ``spilled`` locals it sees no variables of other functions."""
        scope = Scope(locals_, self.lanes, registers="unpack" if self.kernel.direction == "decode" else "pack")
        common = self.kernel.sites, self.routines, self.numbers, self.about.paths, self.about.functions or {}, self.about.origins
        function = Function(name, scope, *common, read=read, staying=self.staying)
        if spilled is not None:
            function.spilled, function.passed = spilled, f" {SHARED}"
        return function

    def _attempt(self, name: str, body: Block) -> None:
        function = self._function(name, Names(self.lanes.words()), read_names(body))
        with self.lines.form(f"({name} ()"):
            _within_lanes(self.lines, function, self._used_at_start, lambda lanes: print_block(function, body, _end(function, body), lanes))

    def _parts(self, name: str, body: Block) -> None:
        """The functions of an attempt. Names of spilled locals, and of lanes' rows and counts, stand for places in the codec."""
        read, locals_, parts = read_names(body), Names(self.lanes.words()), parted(body, name)
        spilled = {local: _place(type_, number) for number, (local, type_) in enumerate(parts.spilled(read).items())}
        counts = {lane: _place("i64", len(spilled) + lane) for lane in range(len(self.lanes.all))}
        self.spilled = max(self.spilled, WORD * (len(spilled) + len(counts)))
        found = [(self._function(called, locals_, read, spilled), block) for called, block in parts.blocks.items()]
        found.append((self._function(name, locals_, read, spilled), parts.body))
        for function, block in found:
            print_block(function, block)  # which shows the lanes that it touches
        counted = {lane for function, _ in found for lane in function.scope.counted}
        for function, block in found:
            if block is parts.body:
                function.scope.counted |= counted
            with self._apart(function, block, counts):
                if block is parts.body:
                    for lane in sorted(counted):
                        function.line(f"(setf {self.lanes.used(lane)} {self._used_at_start(lane)})")
                print_block(function, block, _end(function, body) if block is parts.body else lambda function=function: function.line("0"))

    @contextmanager
    def _apart(self, function: Function, block: Block, counts: Mapping[int, str]) -> Generator[None]:
        """A global function, around which `symbol-macrolet` names the places in the codec that it uses."""
        scope, used = function.scope, names_in(block)
        named = {scope.locals.symbol(local): place for local, place in function.spilled.items() if local in used}
        named |= {self.lanes.used(lane): counts[lane] for lane in sorted(scope.counted)}
        named |= {self.lanes.rows(lane): self.lanes.place(lane) for lane in sorted(scope.touched)}
        function.lines = self.lines
        with self._defun(function.name, SHARED, DECLARED, _fields(block, function.sites)), named_forms(self.lines, named):
            yield

    def _used_at_start(self, lane: int) -> str:
        """Lane 0 has the row of the message; a decoder starts with all others empty but those that it keeps, as hidden ones are."""
        if lane == 0:
            return "1"
        is_empty = lane >= self.lanes.own or (self.kernel.direction == "decode" and lane not in self.kernel.kept)
        return "0" if is_empty else self.lanes.place_of_used(lane)

    def _routine(self, routine: Routine, name: str, shared: str = "") -> None:
        """A routine, for which ``shared`` are the parameters that it does not see otherwise."""
        scope = Scope(Names(self.lanes.words()), self.lanes)
        read = read_names(routine.body, (each.name for each in routine.results))
        function = Function(name, scope, routine.sites, self.routines, self.numbers, self.about.paths, {}, read=read, is_routine=True)
        function.passed = f" {shared}" if shared else ""
        own = [_parameter(scope, each) for each in routine.parameters if each.type not in BOXED]
        boxed = [each for each in routine.parameters if each.type in BOXED]
        passed = [_parameter(scope, each, place) for each, place in zip(boxed, registers(each.type for each in boxed), strict=True)]

        def finish() -> None:
            for register, each in zip(registers(each.type for each in routine.results), routine.results, strict=True):
                function.line(f"(setf {register} {expression(scope, each)})")
            function.line("0")

        parameters = " ".join((*shared.split(), *(each.name for each in own)))
        with self._defun(name, parameters, DECLARED) if shared else self.lines.form(f"({name} ({parameters})"):
            if own:
                self.lines.line(declaration(own))
            _within_lanes(self.lines, function, None, lambda lanes: print_block(function, routine.body, finish, [*passed, *lanes]))
        self.routines[routine.name] = name


def _parameter(scope: Scope, local: Local, value: str = "") -> Variable:
    return Variable(scope.locals.symbol(local.name), LISP_TYPES[local.type], value)


def _chosen(attempts: list[str]) -> str:
    if len(attempts) == 1:
        return attempts[0]
    cases = [f"({number} {call})" for number, call in enumerate(attempts[:-1], 1)]
    return f"(case attempt {' '.join(cases)} (t {attempts[-1]}))"


def _end(function: Function, body: Block) -> Callable[[], None]:
    """What ends an attempt."""

    def finish() -> None:
        if not leaves(body):
            function.line("-1", "never reached: every path has returned")

    return finish


def _fields(block: Block, sites: Sequence[Site]) -> str:
    """Which fields a block is about: the first and the last one in which it can fail."""
    failing = (stmt for stmt in flat(block) if isinstance(stmt, Require | Expect | HostCall))
    paths = [path for stmt in failing if (path := sites[stmt.failure.site].path)]
    return f"{paths[0]} to {paths[-1]}" if paths else "the message"


def _place(type_: Scalar, number: int) -> str:
    """Where a spilled local lies."""
    return f"({access(type_)} (codec-state-spilled codec) {WORD * number})"


def _within_lanes(
    lines: Lines, function: Function, used_at_start: Callable[[int], str] | None, write: Callable[[list[Variable]], None]
) -> None:
    """What is written, within variables for the lanes that it touches: it is written once to see which these are."""
    write([])
    function.lines, scope = lines, function.scope
    rows = [Variable(scope.lanes.rows(lane), "octets", scope.lanes.place(lane)) for lane in sorted(scope.touched)]
    counted = sorted(scope.counted) if used_at_start else []
    write([*rows, *(Variable(scope.lanes.used(lane), "i64", used_at_start(lane)) for lane in counted if used_at_start)])


def computes_with_floats(kernel: Kernel) -> bool:
    """Whether a kernel does more with floats than move them: only then can it make a NaN, or an infinite number."""
    return any(_is_of_floats(part) for expr in _expressions(kernel) for part in subexpressions(expr))


def _expressions(kernel: Kernel) -> Iterator[Expr]:
    for block in (*kernel.bodies, *(routine.body for routine in kernel.routines)):
        for stmt, _ in statements(block):
            yield from expressions_of(stmt)


def _is_of_floats(expr: Expr) -> bool:
    match expr:
        case Unary(_, operand) | Convert(_, operand):
            return type_of(operand) in FLOATS or type_of(expr) in FLOATS
        case Binary(_, left, _) | Compare(_, left, _):
            return type_of(left) in FLOATS
        case _:
            return isinstance(expr, Decimal)
