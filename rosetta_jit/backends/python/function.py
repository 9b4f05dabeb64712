"""A kernel as Python source that a person can read, and debug: slow, and right wherever Python runs.

    kernel(buffer, begin, end, state, lanes, row) -> int

It takes and returns what `kernel.interpret.run` does; a kernel with registers has them as a parameter more. Each attempt is a function;
what a message cannot be ends it with `Failed`.
"""

from __future__ import annotations

import keyword
from collections.abc import Callable, Iterable
from typing import Any, assert_never

from rosetta_jit.backends.printing import Namespace, Writer, counted_lanes, emptied_lanes, statements
from rosetta_jit.backends.python.expr import FLOATS, FORMATS, Names, expression, location, part
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.host import NO_FUNCTIONS, Functions
from rosetta_jit.kernel.interpret import runnable as interpreted
from rosetta_jit.kernel.state import CAPACITY, USED, lane_word
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import expressions_of, extents_of, subexpressions

IMPORTS = (
    "from struct import pack_into, unpack_from",
    "",
    "from numpy import float32, float64",
    "",
    "from rosetta_jit.backends.python_support import Failed, has_room, is_text, quotient, remainder, reserve, run_attempts",
    "from rosetta_jit.kernel.arithmetic import binary, convert, fits, from_bytes, same_bits, to_bytes, unary, wrapped",
)
HOST_IMPORTS = ("from rosetta_jit.kernel.host import RefusedError",)
"""Of a kernel that calls functions of its host."""

OF_DECIMALS = "from rosetta_jit.kernel.decimals import digits, nearest, scale"
CALLED = frozenset(name.strip(",") for line in (*IMPORTS, *HOST_IMPORTS, OF_DECIMALS) for name in line.partition(" import ")[2].split())
PARAMETERS = "buffer, begin, end, state, lanes, row"
REGISTERS = ", registers"
"""The parameter more of a kernel that has some."""


def compile_python(kernel: ir.Kernel, functions: Functions = NO_FUNCTIONS) -> Callable[..., int]:
    """The kernel as a Python function, which calls those of the host.

    Raises
    ------
    SyntaxError
        If blocks nest deeper than Python allows: 20 loops, 100 levels of indentation.
    """
    scope: dict[str, Any] = {"host": functions}
    exec(compile(python_text(kernel), f"<kernel {kernel.name!a}>", "exec"), scope)  # noqa: S102 - our own text, of mangled names and numbers
    return scope["kernel"]


def runnable(kernel: ir.Kernel, functions: Functions) -> Callable[..., int]:
    """The same; where Python does not nest so deep, the interpreter, which does what the text would."""
    try:
        return compile_python(kernel, functions)
    except SyntaxError:
        return interpreted(kernel, functions)


def python_text(kernel: ir.Kernel) -> str:
    """The kernel as the source of a Python module, the same for the same kernel."""
    writer = Writer()
    writer.line(f"# Made by rosetta_jit from the kernel {kernel.name!a}, which is to {kernel.direction}. Changes will be lost.")
    calls_host = any(isinstance(stmt, nodes.HostCall) for body in kernel.bodies for stmt in statements(body))
    for line in (*IMPORTS, *(HOST_IMPORTS if calls_host else ()), *([OF_DECIMALS] if _has_decimals(kernel) else [])):
        writer.line(line)
    for routine in kernel.routines:
        writer.line()
        writer.line()
        _RoutineBody(kernel, routine, writer).write()
    kept = REGISTERS if kernel.registers else ""
    for number, body in enumerate(kernel.bodies):
        writer.line()
        writer.line()
        with writer.indented(f"def attempt_{number}({PARAMETERS}{kept}):"):
            _Attempt(kernel, body, writer).write()
    writer.line()
    writer.line()
    with writer.indented(f"def kernel({PARAMETERS}{kept}):"):
        attempts = "".join(f"attempt_{number}, " for number in range(len(kernel.bodies))).rstrip()
        hidden = f", {kernel.lanes}, {kernel.strides[kernel.lanes :]}" if kernel.hidden else ""
        given = ", registers=(registers,)" if kernel.registers else ""
        writer.line(f"return run_attempts(({attempts}), (buffer, begin, end), state, lanes, row{hidden}{given})")
    return writer.text()


def _has_decimals(kernel: ir.Kernel) -> bool:
    """Whether a kernel reads or writes floats in decimal."""
    blocks = (*kernel.bodies, *(routine.body for routine in kernel.routines))
    expressions = (expr for block in blocks for stmt in statements(block) for expr in expressions_of(stmt))
    return any(isinstance(part, nodes.Nearest | nodes.Digits | nodes.Scale) for expr in expressions for part in subexpressions(expr))


def _reserved(kernel: ir.Kernel) -> frozenset[str]:
    lanes = range(len(kernel.strides))
    words = {f"{kind}_{lane}" for kind in ("used", "capacity") for lane in lanes}
    words |= {"registers", *(f"register_{number}" for number in range(kernel.registers))}
    functions = {_function(routine.name) for routine in kernel.routines}
    names = {"bool", "bytes", "host", "indices", "int", "len", "min", "max", "range", "sites", "None", *PARAMETERS.split(", ")}
    return frozenset(keyword.kwlist) | CALLED | words | functions | names


class _Attempt:
    """Prints one body."""

    def __init__(self, kernel: ir.Kernel, body: nodes.Block, writer: Writer) -> None:
        parameters = {name: name for name in ("begin", "end", "row")}
        self.kernel, self.body, self.writer = kernel, body, writer
        self.names = Names(Namespace(_reserved(kernel), parameters), kernel.strides)
        self.counted = counted_lanes(kernel, body)

    def write(self) -> None:
        """The body, behind the lengths that it turned out to read."""
        outer, self.writer = self.writer, Writer(depth=self.writer.depth)
        self._block(self.body)
        emptied = emptied_lanes(self.kernel)
        for lane in sorted(self.names.used | set(self.counted)):
            if lane >= self.kernel.lanes:
                outer.line(f"used_{lane} = 0")
                continue
            start = f"int(state[{lane_word(lane, USED)}])"
            outer.line(f"used_{lane} = {start} if row else 0" if lane in emptied else f"used_{lane} = {start}")
        for lane in sorted(self.names.capacities):
            own, stride = lane < self.kernel.lanes, self.kernel.strides[lane]
            capacity = f"int(state[{lane_word(lane, CAPACITY)}])" if own else f"len(lanes[{lane}]) // {stride}"
            outer.line(f"capacity_{lane} = {capacity}")
        for number in sorted(self.names.registers):
            outer.line(f"register_{number} = int(registers[{number}])")
        outer.lines += self.writer.lines
        self.writer = outer

    def _block(self, block: nodes.Block) -> None:
        for statement in block:
            self._statement(statement)
        if not block:
            self.writer.line("pass")

    def _statement(self, statement: nodes.Stmt) -> None:
        match statement:
            case nodes.Require(at, size, failure):
                self._fail_unless(f"has_room({self._text(at)}, {self._text(size)}, end)", failure)
            case nodes.Expect(condition, failure):
                self._fail_unless(self._text(condition), failure)
            case nodes.Let(name, value) | nodes.Var(name, value) | nodes.Assign(name, value):
                self.writer.line(f"{self.names.locals.identifier(name)} = {self._text(value)}")
            case nodes.Store(at, value, order):
                self._set(nodes.Wire(at), value, order)
            case nodes.SetField(place, value):
                self._set(place, value, "<")
            case nodes.Reserve(lane, count):
                free = f"{self.names.capacity_name(lane)} - {self.names.used_name(lane)}"
                self.writer.line(f"reserve({lane}, {self._text(count)}, {free})")
            case nodes.Advance(lane, count):
                self.writer.line(f"{self.names.used_name(lane)} += {self._text(count)}")
            case nodes.Copy(target, source, size):
                length = self._text(size)
                self.writer.line(f"{part(self.names, target, length)} = {part(self.names, source, length)}")
            case nodes.Fill(target, size, byte):
                length = self._text(size)
                self.writer.line(f"{part(self.names, target, length)} = bytes([{byte}]) * {length}")
            case nodes.Return(position, registers):
                for lane in self.counted:
                    self.writer.line(f"state[{lane_word(lane, USED)}] = used_{lane}")
                for number, value in registers:
                    self.writer.line(f"registers[{number}] = {self._text(value)}")
                self.writer.line(f"return {self._text(position)}")
            case nodes.For() | nodes.While() | nodes.If() | nodes.Switch():
                self._nested(statement)
            case nodes.Call():
                self._call(statement)
            case nodes.HostCall():
                self._host_call(statement)
            case _:
                assert_never(statement)

    def _call(self, call: nodes.Call) -> None:
        """Results are a tuple; what a failure reports goes in."""
        bound = _items(self.names.locals.identifier(each.name) for each in call.results)
        given = "".join(f", {self._text(each)}" for each in call.arguments)
        sites = _items(map(self._site, call.sites))
        reported = f"({sites}), {self._indices(call.indices)}"
        self.writer.line(f"{bound} = {_function(call.routine)}(buffer, begin, end, state, lanes, {reported}{given})")

    def _host_call(self, call: nodes.HostCall) -> None:
        spans = (part(self.names, extent.address, self._text(extent.size)) for extent in extents_of(call))
        given = ", ".join((*map(self._text, call.arguments), *spans))
        bound = self.names.locals.identifier(call.result.name)
        with self.writer.indented("try:"):
            self.writer.line(f'{bound} = host["{call.function}"]({given})')
        with self.writer.indented("except RefusedError:"):
            self._fail(call.failure, " from None")

    def _nested(self, statement: nodes.For | nodes.While | nodes.If | nodes.Switch) -> None:
        match statement:
            case nodes.For(variable, count, body):
                self._governed(f"for {self.names.locals.identifier(variable)} in range({self._text(count)}):", body)
            case nodes.While(condition, body, _, _):
                self._governed(f"while {self._text(condition)}:", body)
            case nodes.If(condition, then, otherwise):
                self._governed(f"if {self._text(condition)}:", then)
                if otherwise:
                    self._governed("else:", otherwise)
            case nodes.Switch(value, cases, default):
                with self.writer.indented(f"match {self._text(value)}:"):
                    for number, body in cases:
                        self._governed(f"case {number}:", body)
                    self._governed("case _:", default)
            case _:
                assert_never(statement)

    def _governed(self, head: str, body: nodes.Block) -> None:
        with self.writer.indented(head):
            self._block(body)

    def _fail_unless(self, condition: str, failure: nodes.Failure) -> None:
        with self.writer.indented(f"if not {condition}:"):
            self._fail(failure)

    def _fail(self, failure: nodes.Failure, cause: str = "") -> None:
        reported = f"{self._site(failure.site)}, {self._text(failure.at)}, {self._indices(failure.indices)}"
        self.writer.line(f"raise Failed({reported}){cause}  # {ascii(self._about(failure.site))[1:-1]}")

    def _site(self, number: int) -> str:
        return str(number)

    def _indices(self, indices: tuple[nodes.Expr, ...]) -> str:
        return f"({_items(map(self._text, indices))})"

    def _about(self, number: int) -> str:
        site = self.kernel.sites[number]
        return f"{site.kind} {site.path}"

    def _set(self, address: nodes.Address, value: nodes.Expr, order: nodes.Order) -> None:
        type_ = type_of(value)
        if type_ in FLOATS:
            target = part(self.names, address, str(nodes.WIDTH[type_]))
            self.writer.line(f'{target} = to_bytes("{type_}", {self._text(value)}, "{order}")')
        else:
            memory, start = location(self.names, address)
            self.writer.line(f'pack_into("{order}{FORMATS[type_]}", {memory}, {start}, {self._text(value)})')

    def _text(self, expr: nodes.Expr) -> str:
        return expression(self.names, expr)


class _RoutineBody(_Attempt):
    """Prints a routine: it fails at the sites and with the indices that it is given."""

    def __init__(self, kernel: ir.Kernel, routine: ir.Routine, writer: Writer) -> None:
        super().__init__(kernel, routine.body, writer)
        self.routine, self.counted = routine, []

    def write(self) -> None:
        """The function, to the return of its results."""
        given = "".join(f", {self.names.locals.identifier(each.name)}" for each in self.routine.parameters)
        with self.writer.indented(f"def {_function(self.routine.name)}(buffer, begin, end, state, lanes, sites, indices{given}):"):
            super().write()
            found = _items(self.names.locals.identifier(each.name) for each in self.routine.results)
            self.writer.line(f"return ({found})")

    def _site(self, number: int) -> str:
        return f"sites[{number - 1}]"

    def _indices(self, indices: tuple[nodes.Expr, ...]) -> str:  # noqa: ARG002 - a routine has the indices of its call
        return "indices"

    def _about(self, number: int) -> str:
        site = self.routine.sites[number]
        return f"{site.kind} {site.detail}"


def _function(routine: str) -> str:
    return f"routine_{routine}"


def _items(texts: Iterable[str]) -> str:
    """What stands in the parentheses of a tuple."""
    listed = list(texts)
    return f"{listed[0]}," if len(listed) == 1 else ", ".join(listed)
