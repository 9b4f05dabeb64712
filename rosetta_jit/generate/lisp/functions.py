"""A kernel as one function whose attempts and routines are local: numbers pass between these unboxed.

(decode-kernel codec data end attempt)      where the message ends, or -1 - site
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.generate.lisp.expressions import Scope, expression
from rosetta_jit.generate.lisp.lines import Lines
from rosetta_jit.generate.lisp.statements import Function, Variable, declaration, print_block, registers
from rosetta_jit.generate.lisp.words import LISP_TYPES, Names, hyphenated
from rosetta_jit.generate.origins import Origin
from rosetta_jit.generate.reachable import leaves, reached, read_names
from rosetta_jit.generate.shares import changed_lanes
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.ir import Kernel, Routine
from rosetta_jit.kernel.nodes import Binary, Compare, Convert, Decimal, Expr, Unary
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.lisp.lanes import Lanes

DECLARED = (
    "(declare (optimize (speed 1) (safety 0) (debug 0) (compilation-speed 2)) (type codec codec) (type octets data) (type i64 end) "
    "(type fixnum attempt) (ignorable codec data end attempt))"
)
"""Where compiling fast counts more than fast code, SBCL does not join what it knows of variables where branches meet. Kernels gain
nothing by that, and those of large types would take twice the time and the memory."""


@dataclass(frozen=True, slots=True)
class About:
    """What a kernel is printed with: the lines of the mapping, the fields that lanes belong to, and the mapping's functions by name."""

    origins: Sequence[Origin] = ()
    paths: Sequence[str] = ()
    functions: Mapping[str, str] | None = None


@dataclass(frozen=True, slots=True)
class Printed:
    """A kernel's function as text, its attempts, and the sites that it names."""

    text: str
    attempts: int
    sites: tuple[int, ...]


def print_kernel(kernel: Kernel, lanes: Lanes, role: str, about: About) -> Printed:
    """The function of a kernel that is for a message alone (`kernel.passes.alone`); its name begins with the role."""
    numbers, names, routines = {0: 0}, Names(frozenset()), dict[str, str]()
    attempts = [names.symbol(f"{role}-{number}") for number in range(1, len(kernel.bodies) + 1)]
    lines = Lines()
    with lines.form(f"(defun {role}-kernel (codec data end attempt)"):
        lines.line(DECLARED)
        with lines.form("(labels"):
            first = len(lines.lines)
            lines.column += 3
            for routine in kernel.routines:
                name = names.symbol(f"{role}-{hyphenated(routine.name)}")
                function = _function(name, kernel, lanes, about, numbers, routines, routine)
                _routine(lines, function, routine)
                routines[routine.name] = name
            for number, name in enumerate(attempts):
                _attempt(lines, _function(name, kernel, lanes, about, numbers, routines), kernel, number)
            lines.column -= 3
            lines.close()
            lines.lines[first].column -= 1
            lines.lines[first].text = f"({lines.lines[first].text}"
            lines.line(_chosen(attempts))
    return Printed(lines.text(), len(attempts), tuple(numbers))


def _chosen(attempts: list[str]) -> str:
    if len(attempts) == 1:
        return f"({attempts[0]})"
    cases = [f"({number} ({name}))" for number, name in enumerate(attempts[:-1], 1)]
    return f"(case attempt {' '.join(cases)} (t ({attempts[-1]})))"


def _function(
    name: str,
    kernel: Kernel,
    lanes: Lanes,
    about: About,
    numbers: dict[int, int],
    routines: Mapping[str, str],
    routine: Routine | None = None,
) -> Function:
    scope = Scope(Names(lanes.words()), lanes, registers="unpack" if kernel.direction == "decode" else "pack")
    sites = kernel.sites if routine is None else routine.sites
    origins = about.origins if routine is None else ()
    return Function(name, scope, sites, routines, numbers, about.paths, about.functions or {}, origins, is_routine=routine is not None)


def _attempt(lines: Lines, function: Function, kernel: Kernel, number: int) -> None:
    body = reached(kernel.bodies[number])
    function.read, function.staying = read_names(body), changed_lanes(kernel)

    def finish() -> None:
        if not leaves(body):
            function.line("-1", "never reached: every path has returned")

    with lines.form(f"({function.name} ()"):
        _within_lanes(lines, function, kernel, lambda lanes: print_block(function, body, finish, lanes))


def _within_lanes(lines: Lines, function: Function, kernel: Kernel | None, write: Callable[[list[Variable]], None]) -> None:
    """What is written, within variables for the lanes that it touches: it is written once to see which these are."""
    write([])
    function.lines, scope = lines, function.scope
    rows = [Variable(scope.lanes.rows(lane), "octets", scope.lanes.place(lane)) for lane in sorted(scope.touched)]
    counts = sorted(scope.counted) if kernel else []
    write([*rows, *(Variable(scope.lanes.used(lane), "i64", _used_at_start(kernel, scope.lanes, lane)) for lane in counts if kernel)])


def _used_at_start(kernel: Kernel, lanes: Lanes, lane: int) -> str:
    """Lane 0 has the row of the message; a decoder starts with all others empty but those that it keeps, as hidden ones are."""
    if lane == 0:
        return "1"
    is_empty = lane >= lanes.own or (kernel.direction == "decode" and lane not in kernel.kept)
    return "0" if is_empty else lanes.place_of_used(lane)


def _routine(lines: Lines, function: Function, routine: Routine) -> None:
    scope = function.scope
    own = [Variable(scope.locals.symbol(each.name), LISP_TYPES[each.type]) for each in routine.parameters]
    function.read = read_names(routine.body, (each.name for each in routine.results))

    def finish() -> None:
        for register, each in zip(registers(routine.results), routine.results, strict=True):
            function.line(f"(setf {register} {expression(scope, each)})")
        function.line("0")

    with lines.form(f"({function.name} ({' '.join(each.name for each in own)})"):
        if own:
            lines.line(declaration(own))
        _within_lanes(lines, function, None, lambda lanes: print_block(function, routine.body, finish, lanes))


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
