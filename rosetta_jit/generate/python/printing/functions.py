"""A kernel as Python functions: one for each routine, and one for each attempt. What a message cannot be ends them with `_Failed`."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence, Set
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
from rosetta_jit.generate.python.passes.rows_of_pieces import with_rows_of_pieces
from rosetta_jit.generate.python.passes.search import FEW, direct
from rosetta_jit.generate.python.passes.sums import ends_first, with_locals
from rosetta_jit.generate.python.printing.classes import WORDS
from rosetta_jit.generate.python.printing.expressions import expression
from rosetta_jit.generate.python.printing.late_lists import said_to_come
from rosetta_jit.generate.python.printing.printed import Attempt, Function, Objects
from rosetta_jit.generate.python.printing.scope import CODES, Scope, flat_name, view_name
from rosetta_jit.generate.python.printing.statements import print_block
from rosetta_jit.generate.python.printing.unasked import unasked_words, without_words
from rosetta_jit.generate.python.printing.visiting import OF_READERS, counts_of_rows, print_readers, with_copy
from rosetta_jit.generate.shares import moved_lanes
from rosetta_jit.generate.unit import Role, kind_of
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


def _attempt(writer: Writer, role: Role, number: int, function: Function, descents: Descents | None = None) -> Attempt:
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
    function.settled = settled(body)
    if kernel.direction == "decode" and scope.flat:
        scope.attributes = objects.attributes(body, function.settled, scope.direct)
        scope.lists = objects.late_lists(scope)
    function.unasked = unasked_words(body, objects.layout, scope)
    function.read = read_names(without_words(body, function.unasked), scope.direct.read())
    function.positive = not_negative(checked, behind)
    function.reserved = Counter(stmt.lane for stmt, _ in statements(body) if isinstance(stmt, nodes.Reserve))
    blocks = (body, *(routine.body for routine in kernel.routines))
    exprs = (expr for block in blocks for stmt, _ in statements(block) for expr in expressions_of(stmt))
    measured = {part.lane for expr in exprs for part in subexpressions(expr) if isinstance(part, nodes.Capacity)}
    function.outside = {stmt.lane for stmt in body if isinstance(stmt, nodes.Reserve)} - measured - {*kernel.kept}
    print_block(function, body)
    made = objects.inner(scope) if descents is None else counts_of_rows(descents, scope)
    name = f"_{role}_{number + 1}"
    parameters = _parameters(function, own_only=kernel.direction != "decode")
    _blank(writer)
    lines = [each for line in function.writer.lines for each in _completed(line, function)]
    is_bounded = kernel.direction != "decode" or any(re.search(r"\bmost\b", line) for line in (*made, *lines))
    writer.line(f"def {name}({', '.join(['data', 'end', *(['most'] if is_bounded else []), *parameters])}):")
    for line in (*_begin(function, role), *made, *objects.begun(scope)):
        writer.line(f"    {line}" if line else "")
    writer.lines += lines
    return Attempt(name, tuple(parameters), is_bounded=is_bounded)


def _completed(line: str, function: Function) -> list[str]:
    """A line, or what it stands for: all fields of a part of the row, all views of a lane that has grown."""
    scope, text = function.scope, line.strip()
    before = line[: len(line) - len(line.lstrip())]
    if text.startswith("<row "):
        begin, size = map(int, text[5:-1].split())
        if size == scope.lanes.stride(0):
            rows = scope.rows - {flat_name(scope.lanes, *each) for each in function.settled}
            offsets = {*range(size)} - {offset for late in scope.direct.fields for offset in late.offsets}
            rows -= {name for name in rows if scope.offsets.get(name, 0) not in offsets}
        else:
            offsets = {*range(begin, begin + size)}
            rows = {name for name, offset in scope.offsets.items() if offset in offsets}
        return [f"{before}{each}" for each in _cleared(scope, rows, offsets)]
    if text.startswith("<late "):
        late, said = scope.direct.fields[int(text[6:-1])], said_to_come(scope, int(text[6:-1]))
        rows = {name for name, offset in scope.offsets.items() if offset in late.offsets}
        lines = [f"{' = '.join(said)} = True", *_empty(function, _lanes(function) & late.lanes), *_cleared(scope, rows, late.offsets)]
        return [f"{before}if not {said[0]}:", *(f"{before}    {each}" for each in lines)]
    if text.startswith("<views "):
        lane = int(text[7:-1])
        name = scope.lanes.rows(lane)
        codes = sorted(code for number, code in scope.views if number == lane and code)
        return [f'{before}{name}_{code} = memoryview({name}).cast("{code}")' for code in codes]
    return [line]


def _cleared(scope: Scope, rows: Set[str], offsets: Set[int]) -> list[str]:
    """The lines that set some ``rows``, which are locals, to 0, and the texts and bytes at some offsets to nothing."""
    late = [span for span in scope.direct.late if span[1] in offsets and span[1] not in (scope.attributes or ())]
    texts = {scope.text(*span) for span in late if span in scope.direct.texts}
    pieces = {scope.piece(*span) for span in late if span in scope.direct.pieces}
    numbers = rows - scope.floats - scope.bools
    groups = ((numbers, "0"), (rows & scope.floats, "0.0"), (rows & scope.bools, "False"), (texts, '""'), (pieces, 'b""'))
    return [f"{' = '.join(sorted(group))} = {zero}" for group, zero in groups if group]


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
    names |= {scope.lanes.rows(lane) for lane in _lanes(function) if lane in function.measured}
    return sorted(names)


def _lanes(function: Function) -> set[int]:
    """The lanes that a function has to do with."""
    scope = function.scope
    return {lane for lane, _ in scope.views} | scope.rooms | scope.counted | function.moved


def chained(lines: list[str]) -> list[str]:
    """Assignments, of which those of the same number, view or rows are one."""
    found: dict[str, list[str]] = {}
    for line in lines:
        name, _, value = line.partition(" = ")
        is_constant = value in ("0", "False", "_NOTHING") or value.startswith("_EMPTY_")
        found.setdefault(value if is_constant else line, []).append(name)
    return [f"{' = '.join(names)} = {value}" if " = " not in value else value for value, names in found.items()]


def _begin(function: Function, role: Role) -> list[str]:
    """Lanes that start empty, or as another message has left them, and views of those that are given."""
    kept, moved, kind = function.kernel.kept, moved_lanes(function.kernel), kind_of(role)
    scope, own, lines = function.scope, function.scope.lanes.own, list[str]()
    late = scope.direct.fields
    for lane in sorted(_lanes(function) - {0}.union(*(each.lanes for each in late))):
        name = scope.lanes.rows(lane)
        codes = sorted(code for number, code in scope.views if number == lane and code)
        if lane < own and kind in ("encode", "size"):
            continue
        if lane in kept or lane in moved:
            lines.append(f'{name} = bytearray(_rows["{name}"])')
            lines += [f"{name}_room = len({name}) // {scope.lanes.stride(lane)}"] if lane in scope.rooms else []
            lines += [f'{name}_{code} = memoryview({name}).cast("{code}")' for code in codes]
            used = f"len({name}) // {scope.lanes.stride(lane)}" if lane in kept else "0"
            lines += [f"{name}_used = {used}"] if lane in scope.counted else []
            continue
        if lane in function.measured:
            lines += [f"{name}_room = len({name}) // {scope.lanes.stride(lane)}"] if lane in scope.rooms else []
            lines += [f'{name}_{code} = memoryview({name}).cast("{code}")' for code in codes]
            lines += [f"{name}_used = 0"] if lane in scope.counted else []
        else:
            lines += _empty_lane(function, lane)
    said = dict.fromkeys(each for number, _ in enumerate(late) for each in said_to_come(scope, number))
    lines = chained([*lines, *(f"{each} = False" for each in said)])
    if not scope.flat and kind in ("decode", "borrow"):
        lines.append('message = bytearray(_rows["message"])' if kept else f"message = bytearray({scope.lanes.stride(0)})")
        lines += [f'message_{code} = memoryview(message).cast("{code}")' for lane, code in sorted(scope.views) if lane == 0 and code]
    return lines


def _empty_lane(function: Function, lane: int) -> list[str]:
    """The locals of a lane that has no row yet."""
    scope, name = function.scope, function.scope.lanes.rows(lane)
    codes = sorted(code for number, code in scope.views if number == lane and code)
    scope.loads.update(f"_EMPTY_{code}" for code in codes)
    lines = [f"{name} = {'[]' if lane in scope.direct.gathered else '_NOTHING'}"]
    lines += [f"{name}_room = 0"] if lane in scope.rooms else []
    lines += [f"{name}_{code} = _EMPTY_{code}" for code in codes]
    lines += [f"{scope.placed(*span)} = {{}}" for span in scope.direct.placed if span[0] == lane]
    return [*lines, f"{name}_used = 0"] if lane in scope.counted else lines


def _empty(function: Function, lanes: Set[int]) -> list[str]:
    return chained([line for lane in sorted(lanes) for line in _empty_lane(function, lane)])


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
