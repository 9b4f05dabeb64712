"""A kernel as Python functions: one for each routine, and one for each attempt. What a message cannot be ends them with `_Failed`."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.origins import Origin
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.cleared import settled
from rosetta_jit.generate.passes.descents import Descents, NotNested, descended
from rosetta_jit.generate.passes.reachable import reached, read_names
from rosetta_jit.generate.passes.undamaged import undamaged
from rosetta_jit.generate.python.passes.bools import with_bytes
from rosetta_jit.generate.python.passes.constants import with_constants
from rosetta_jit.generate.python.passes.empty_spans import without_empty_spans
from rosetta_jit.generate.python.passes.groups import not_negative
from rosetta_jit.generate.python.passes.late_checks import with_late_checks
from rosetta_jit.generate.python.passes.late_fields import late_fields
from rosetta_jit.generate.python.passes.late_rows import with_late_rows
from rosetta_jit.generate.python.passes.local_names import Locals
from rosetta_jit.generate.python.passes.mentions import blocks_within
from rosetta_jit.generate.python.passes.rows_apart import NO_ROWS, rows_apart
from rosetta_jit.generate.python.passes.rows_of_pieces import with_rows_of_pieces
from rosetta_jit.generate.python.passes.search import FEW, direct
from rosetta_jit.generate.python.passes.sums import ends_first, with_locals
from rosetta_jit.generate.python.printing.beginning import begin, completed, lanes_of_function
from rosetta_jit.generate.python.printing.classes import WORDS
from rosetta_jit.generate.python.printing.expressions import expression
from rosetta_jit.generate.python.printing.printed import Attempt, Function, Objects
from rosetta_jit.generate.python.printing.rows_apart import print_rows_apart
from rosetta_jit.generate.python.printing.scope import CODES, Scope, view_name
from rosetta_jit.generate.python.printing.statements import print_block
from rosetta_jit.generate.python.printing.unasked import unasked_words, without_words
from rosetta_jit.generate.python.printing.visiting import OF_READERS, counts_of_rows, print_readers, with_copy
from rosetta_jit.generate.unit import Role
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes


NONE = frozenset[str]()


def is_flat(kernel: ir.Kernel, lanes: Lanes) -> bool:
    """Whether all that is done to the message's row is to set and to read its fields."""
    fields = (each for body in kernel.bodies for stmt, _ in statements(body) for each in _fields(stmt) if each[0].lane == 0)
    if any(lanes.field(0, "0", place.offset, scalar) is None for place, scalar in fields):
        return False
    for body in kernel.bodies:
        for stmt, _ in statements(body):
            if not _clears(stmt) and any(place.lane == 0 for place in _memory(stmt)):
                return False
    places = (place for routine in kernel.routines for stmt, _ in statements(routine.body) for place in (*_memory(stmt), *_set(stmt)))
    return all(place.lane for place in places)


def _clears(stmt: nodes.Stmt) -> bool:
    """Whether a statement sets the message's row, or a part of it, to 0."""
    match stmt:
        case nodes.Fill(nodes.Place(0, nodes.Const(_, 0)), nodes.Const(), 0):
            return True
        case _:
            return False


def _memory(stmt: nodes.Stmt) -> list[nodes.Place]:
    """Places whose bytes a statement takes for what they are."""
    found = (stmt.target, stmt.source) if isinstance(stmt, nodes.Copy) else (stmt.target,) if isinstance(stmt, nodes.Fill) else ()
    texts = [part.address for expr in expressions_of(stmt) for part in subexpressions(expr) if isinstance(part, nodes.IsText)]
    return [each for each in (*found, *texts) if isinstance(each, nodes.Place)]


def _fields(stmt: nodes.Stmt) -> list[tuple[nodes.Place, nodes.Scalar]]:
    """The scalars of rows that a statement sets or reads."""
    found: list[tuple[nodes.Place, nodes.Scalar]] = [(stmt.place, type_of(stmt.value))] if isinstance(stmt, nodes.SetField) else []
    gets = (part for expr in expressions_of(stmt) for part in subexpressions(expr) if isinstance(part, nodes.Get))
    return [*found, *((each.place, each.type) for each in gets)]


def _set(stmt: nodes.Stmt) -> list[nodes.Place]:
    return [stmt.place] if isinstance(stmt, nodes.SetField) else []


def words_of(lanes: Lanes) -> frozenset[str]:
    """What no local may be called."""
    return WORDS.union(beside_lanes(lanes), (each.identifier for each in lanes.all))


def beside_lanes(lanes: Lanes) -> frozenset[str]:
    """What the views of lanes are called, and the locals that say how many rows there are: no lane may be called so."""
    whats = (*sorted(set(CODES.values())), "used", "room")
    return frozenset(f"{each.identifier}_{what}" for each in lanes.all for what in whats)


def print_kernel(
    kernel: ir.Kernel,
    lanes: Lanes,
    role: Role,
    loads: set[str],
    origins: Sequence[Origin],
    objects: Objects,
    paths: tuple[str, ...],
    *,
    flat: bool,
    measured: range = range(0),
) -> tuple[str, tuple[Attempt, ...]]:
    """The functions of a kernel as text, and how they are called; an encoder gets the hidden lanes that were ``measured``."""
    writer, routines = Writer(), dict[str, Attempt]()
    words = words_of(lanes) | objects.classes | (OF_READERS if objects.layout is not None and objects.layout.recursive else NONE)

    def scope(needed: set[str] = loads) -> Scope:
        return Scope(Locals(words), lanes, flat, needed, kernel.name, paths, numpy=objects.numpy)

    for routine in kernel.routines:
        function = Function(scope(), kernel, routine.sites, routines, (), objects, is_routine=True)
        routines[routine.name] = _routine(writer, role, routine, function)
    attempts: list[Attempt] = []
    for number in range(len(kernel.bodies)):
        needed = set(loads)

        def new(needed: set[str] = needed) -> Function:
            return Function(scope(needed), kernel, kernel.sites, routines, origins, objects, measured=measured)

        try:
            attempts.append(_nested(writer, role, number, new))
        except NotNested:
            needed.clear()
            attempts.append(_attempt(writer, role, number, new()))
        loads |= needed
    return writer.text(), tuple(attempts)


def _nested(writer: Writer, role: Role, number: int, function: Callable[[], Function]) -> Attempt:
    """A decoder of messages of a type that contains itself, with a function for those within others; NotNested where it needs rows."""
    own = function()
    kernel, objects = own.kernel, own.objects
    if kernel.direction != "decode" or not own.scope.flat or objects.layout is None:
        raise NotNested
    descents, readers = descended(reached(kernel.bodies[number]), objects.layout), Writer()
    if copies := print_readers(readers, descents, function):
        own.scope.from_call.add("copy")
    attempt = _attempt(readers, role, number, own, descents)
    _blank(writer)
    writer.lines += [with_copy(line, copies=copies) for line in readers.lines]
    return attempt


def _known_body(function: Function, number: int, descents: Descents | None) -> nodes.Block:
    """A body as it is printed; the function is told what is known of it."""
    kernel, scope, objects = function.kernel, function.scope, function.objects
    body = reached(kernel.bodies[number]) if descents is None else descents.body
    body = with_locals(with_bytes(with_constants(body))) if kernel.direction == "decode" else undamaged(body, kernel.sites)
    if kernel.direction == "decode" and scope.flat and objects.layout is not None:
        body, scope.direct = direct(body, kernel, objects.layout, objects.arrays, objects.blobs, few=0 if scope.numpy else FEW)
        known = {*scope.direct.whole, *scope.direct.appended, *scope.direct.elements, *scope.direct.rows}
        body = without_empty_spans(ends_first(body), kernel.strides, known)
        body, scope.direct.late_rows = with_late_rows(body, kernel, objects.layout, objects.late_rows)
        body = with_rows_of_pieces(body, kernel, objects.layout, objects.late_rows, scope.direct)
        body, scope.direct.fields = late_fields(body, kernel, objects.layout, known) if descents is None else (body, ())
    checked, behind = body, frozenset[str]()
    if descents is not None:
        body, scope.direct.checks = with_late_checks(body, descents.visits)
        scope.direct.visits, scope.direct.left, behind = descents.visits, descents.left, descents.behind()
    assert {number for each in scope.direct.fields for number in each.cases} <= {*map(id, blocks_within(body))}
    _tell(function, body)
    function.positive = not_negative(checked, behind)
    return body


def _tell(function: Function, body: nodes.Block) -> None:
    """What the statements of a body need of its function."""
    kernel, scope, objects = function.kernel, function.scope, function.objects
    function.settled = settled(body)
    if kernel.direction == "decode" and scope.flat:
        scope.attributes = objects.attributes(body, function.settled, scope.direct)
        scope.lists = objects.late_lists(scope)
    function.unasked = unasked_words(body, objects.layout, scope)
    function.read = read_names(without_words(body, function.unasked), scope.direct.read())
    function.reserved = Counter(stmt.lane for stmt, _ in statements(body) if isinstance(stmt, nodes.Reserve))
    blocks = (body, *(routine.body for routine in kernel.routines))
    exprs = (expr for block in blocks for stmt, _ in statements(block) for expr in expressions_of(stmt))
    measured = {part.lane for expr in exprs for part in subexpressions(expr) if isinstance(part, nodes.Capacity)}
    function.outside = {stmt.lane for stmt in body if isinstance(stmt, nodes.Reserve)} - measured - {*kernel.kept}


def _attempt(writer: Writer, role: Role, number: int, function: Function, descents: Descents | None = None) -> Attempt:
    """The function of a body, behind one for its rows of types that contain themselves, if that is apart."""
    kernel, scope, objects = function.kernel, function.scope, function.objects
    body = _known_body(function, number, descents)
    name = f"_{role}_{number + 1}"
    apart = NO_ROWS
    if kernel.direction == "decode" and scope.flat and objects.layout is not None and descents is None:
        body, apart = rows_apart(body, kernel, objects.layout)
    _blank(writer)
    without = frozenset[int]()
    if apart:
        without, lines = print_rows_apart(function, role, body, apart, f"{name}_rows")
        writer.lines += [*lines, "", ""]
        made = list[str]()
    else:
        print_block(function, body)
        made = objects.inner(scope) if descents is None else counts_of_rows(descents, scope)
    parameters = _parameters(function, own_only=kernel.direction != "decode")
    lines = [each for line in function.writer.lines for each in completed(line, function)]
    is_bounded = kernel.direction != "decode" or any(re.search(r"\bmost\b", line) for line in (*made, *lines))
    writer.line(f"def {name}({', '.join(['data', 'end', *(['most'] if is_bounded else []), *parameters])}):")
    for line in (*begin(function, role, without), *made, *objects.begun(scope)):
        writer.line(f"    {line}" if line else "")
    writer.lines += lines
    return Attempt(name, tuple(parameters), is_bounded=is_bounded)


def _parameters(function: Function, *, own_only: bool) -> list[str]:
    """What a function gets: for encoders what the object became, for routines all that their caller has."""
    scope, own = function.scope, function.scope.lanes.own
    if not own_only and not function.is_routine:
        return sorted(f"call_{what}" for what in scope.from_call)
    names = {*scope.rows, *(f"call_{what}" for what in scope.from_call)}
    names |= {view_name(scope.lanes, lane, code) for lane, code in scope.views if lane < own or function.is_routine}
    names |= {
        f"{scope.lanes.rows(lane)}_{what}"
        for what, some in (("used", scope.counted), ("room", scope.rooms))
        for lane in some
        if 0 < lane < own
    }
    if function.is_routine:
        names |= {f"{scope.lanes.rows(lane)}_room" for lane in scope.rooms if lane >= own}
    names |= {scope.lanes.rows(lane) for lane in lanes_of_function(function) if lane in function.measured}
    return sorted(names)


def _blank(writer: Writer) -> None:
    writer.lines += ["", ""] if writer.lines else []


def _routine(writer: Writer, role: Role, routine: ir.Routine, function: Function) -> Attempt:
    scope = function.scope
    own = [scope.locals.identifier(each.name) for each in routine.parameters]
    function.read = read_names(routine.body, (each.name for each in routine.results))
    print_block(function, routine.body)
    results = [bare(expression(scope, each)) for each in routine.results]
    function.line(f"return {', '.join(results)}{',' if len(results) == 1 else ''}" if results else "return ()")
    parameters, name = _parameters(function, own_only=True), f"_{role}_{routine.name}"
    _blank(writer)
    writer.line(f"def {name}({', '.join(['data', 'end', 'sites', 'indices', *parameters, *own])}):")
    writer.lines += function.writer.lines
    return Attempt(
        name, tuple(parameters), _is_mostly_a_byte(routine), isinstance(routine.body[0] if routine.body else None, nodes.Require)
    )


def _is_mostly_a_byte(routine: ir.Routine) -> bool:
    """Whether a routine reads a byte, and goes on if that is 128 or more: a caller may look at it without a call."""
    body = routine.body
    if body and isinstance(body[0], nodes.Require):
        if body[0].size != index(1) or body[0].at != routine.parameters[0]:
            return False
        body = body[1:]
    match routine.parameters, routine.results, body:
        case (
            (at,),
            (value, after),
            (
                nodes.Let(byte, nodes.Load("u8", place)),
                nodes.Var(first, nodes.Convert("u64", nodes.Local(_, converted))),
                nodes.Var(behind, nodes.Binary("add", begin, nodes.Const(_, 1))),
                nodes.If(nodes.Compare("ge", nodes.Local(_, compared), nodes.Const(_, 128)), _, ()),
            ),
        ):
            is_read = place == begin == at and byte == converted == compared
            return is_read and (first, behind) == (value.name, after.name)
        case _:
            return False
