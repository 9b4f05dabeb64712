"""A kernel as static functions of C: one for each routine, and one for each attempt.

    int64 decode_1(holder, bytes, end, failure)         where the message ends, or -1 - site
    int64 decode_varint(bytes, end, failure, …, &…)     0, or the number of a site of its own

Each takes those of the shared parameters that it needs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Namespace, Writer, counted_lanes
from rosetta_jit.generate.c.printing.expressions import expression
from rosetta_jit.generate.c.printing.function import Callable, Function
from rosetta_jit.generate.c.printing.heads import declared, head
from rosetta_jit.generate.c.printing.scope import Scope, register_name
from rosetta_jit.generate.c.printing.statements import print_block
from rosetta_jit.generate.c.printing.varint_loops import called
from rosetta_jit.generate.c.printing.visited import print_visited, starts_of
from rosetta_jit.generate.c.state import register_word
from rosetta_jit.generate.c.support import function_names
from rosetta_jit.generate.c.words import C_TYPES
from rosetta_jit.generate.origins import Origin
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.aligned import as_printed
from rosetta_jit.generate.passes.decided import decided
from rosetta_jit.generate.passes.descents import Descents
from rosetta_jit.generate.passes.positions import is_position, said_by
from rosetta_jit.generate.passes.reachable import leaves, reached, read_names
from rosetta_jit.generate.unit import Role
from rosetta_jit.kernel.ir import Kernel, Routine
from rosetta_jit.kernel.nodes import Advance, Block, Call, Direction, For, While
from rosetta_jit.kernel.walk import statements
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes

SHARED = ("holder", "given_row", "given_object", "bytes", "end", "failure")
"""The parameters that all functions of a kernel may have, in order."""
MOST_PLACES = 100
"""In how many places a compiler of C++ puts a routine in place of a call."""


@dataclass(frozen=True, slots=True)
class Attempt:
    """A body as a function: its name, and which of the shared parameters it takes."""

    name: str
    parameters: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Printed:
    """A kernel's functions as text: its attempts in order, the sites that they name, the support, hidden lanes and lanes that they use."""

    text: str
    attempts: tuple[Attempt, ...]
    sites: tuple[int, ...]
    support: frozenset[str]
    hidden: frozenset[int]
    named: frozenset[int] = frozenset()


def print_kernel(kernel: Kernel, lanes: Lanes, role: Role, origins: Sequence[Origin] = (), descents: Sequence[Descents] = ()) -> Printed:
    """The functions of a kernel that is for a message alone (`kernel.passes.alone`); their names begin with its role.

    ``origins`` say which lines of the mapping stand beside the statements. With ``descents``, one for each body, functions handle the
    messages within others.
    """
    writer, support, hidden, named, routines = Writer(), set[str](), set[int](), set[int](), dict[str, Callable]()
    words = lanes.words() | function_names() | {f"{role}_{each.name}" for each in kernel.routines}
    words |= {register_name(number) for number in range(kernel.registers)}

    def scope(subject: int = 0) -> Scope:
        return Scope(Namespace(words), replace(lanes, subject=subject), support, hidden, named)

    short = _short(kernel) if lanes.dialect == "c++" else frozenset[str]()
    needed = called(kernel) if lanes.dialect == "c++" else frozenset(each.name for each in kernel.routines)
    for routine in (each for each in kernel.routines if each.name in needed):
        function = Function(scope(), routine.sites, routines, is_routine=True, known=said_by(routine.requires))
        inline = "ROSETTA_JIT_INLINE " if routine.name in short else ""
        routines[routine.name] = _routine(writer, role, kernel.direction, routine, function, inline)
    numbers = {0: 0}

    bodies = [each.body for each in descents] or kernel.bodies

    def begun(number: int, subject: int = 0) -> Function:
        visits, own = descents[number].visits if descents else {}, str(number + 1) if len(bodies) > 1 else ""
        return Function(scope(subject), kernel.sites, routines, visits=visits, numbers=numbers, origins=origins, role=role, body=own)

    for number, each in enumerate(descents):
        print_visited(writer, each, {lane: begun(number, lane) for lane in each.rows}, kernel.direction)
    attempts = tuple(_attempt(writer, role, kernel, body, begun(number)) for number, body in enumerate(bodies))
    return Printed(writer.text(), attempts, tuple(numbers), frozenset(support), frozenset(hidden), frozenset(named))


def _attempt(writer: Writer, role: Role, kernel: Kernel, block: Block, function: Function) -> Attempt:
    body, scope = reached(decided(block)), function.scope
    advanced = {each.lane for each in (stmt for stmt, _ in statements(body)) if isinstance(each, Advance)}
    counted = [lane for lane in counted_lanes(kernel, body) if lane < scope.lanes.own and not _is_forgotten(scope.lanes, role)]
    finish = {lane: scope.lanes.used(lane) if lane in advanced else "0" for lane in counted}
    function.read = read_names(as_printed(body), starts_of(function.visits))
    function.finish = tuple(f"{scope.takes('holder')}->{scope.lanes.rows(lane)}.used = {used};" for lane, used in finish.items())
    print_block(function, body)
    if not leaves(body):
        function.line("return INT64_MIN; /* never reached: every path has returned */")
    name = f"{role}_{function.body or 'message'}"
    parameters = tuple(each for each in SHARED if each in scope.parameters)
    listed = ", ".join(declared(parameters, kernel.direction, scope.lanes)) or "void"
    head(writer, f"static int64_t {name}({listed})", scope, kernel.direction)
    for each in sorted(scope.registers):
        writer.line(f"    const int64_t {register_name(each)} = {register_word(role, each)};")
    for lane in sorted(scope.counted):
        start = _used_at_start(kernel, scope.lanes, lane)
        writer.line(f"    {'' if lane in advanced else 'const '}int64_t {scope.lanes.used(lane)} = {start};")
    writer.lines += [*function.kept_lines(), "}"]
    return Attempt(name, parameters)


def _is_forgotten(lanes: Lanes, role: Role) -> bool:
    """Whether nobody asks how many rows a decoder has used: code that fills an object knows it by the spans."""
    return lanes.dialect == "c++" and role == "borrow"


def _used_at_start(kernel: Kernel, lanes: Lanes, lane: int) -> str:
    """Lane 0 has the row of the message; a decoder starts with all others empty, but for those that it keeps."""
    if lane == 0:
        return "1"
    is_empty = lane >= lanes.own or (kernel.direction == "decode" and lane not in kernel.kept)
    return "0" if is_empty else f"holder->{lanes.rows(lane)}.used"


def _short(kernel: Kernel) -> frozenset[str]:
    """The routines that are better printed where they are called: they have no loop, and the bodies call them, in few places."""
    called = Counter(stmt.routine for body in kernel.bodies for stmt, _ in statements(body) if isinstance(stmt, Call))
    looped = {each.name for each in kernel.routines for stmt, _ in statements(each.body) if isinstance(stmt, For | While)}
    return frozenset(name for name, places in called.items() if name not in looped and places <= MOST_PLACES)


def _routine(writer: Writer, role: str, direction: Direction, routine: Routine, function: Function, inline: str) -> Callable:
    scope = function.scope
    own = {each.name: scope.locals.identifier(each.name) for each in routine.parameters}
    body = decided(routine.body)
    function.read = read_names(as_printed(body), (each.name for each in routine.results))
    print_block(function, body)
    for each in routine.results:
        function.line(f"*found_{scope.locals.identifier(each.name)} = {bare(expression(scope, each))};")
    fails = "failure" in scope.parameters
    if fails:
        function.line("return 0;")
    shared = tuple(each for each in SHARED if each in scope.parameters)
    parameters = [f"{C_TYPES[each.type]} {own[each.name]}" for each in routine.parameters]
    found = [f"{C_TYPES[each.type]} *found_{scope.locals.identifier(each.name)}" for each in routine.results]
    name = f"{role}_{routine.name}"
    listed = ", ".join((*declared(shared, direction, scope.lanes), *parameters, *found)) or "void"
    head(writer, f"{inline}static {'int64_t' if fails else 'void'} {name}({listed})", scope, direction)
    writer.lines += [f"    (void){identifier};" for parameter, identifier in own.items() if parameter not in function.read]
    writer.lines += [*function.writer.lines, "}"]
    ensured = said_by(routine.ensures)
    return Callable(name, shared, fails, frozenset(number for number, each in enumerate(routine.results) if is_position(ensured, each)))
