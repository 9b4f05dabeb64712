"""The functions of an encoder that joins parts (see `parts`): one for the message, and one for each routine that it calls."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.passes.descents import Descents, NotNested, descended
from rosetta_jit.generate.passes.reachable import reached, read_names
from rosetta_jit.generate.passes.undamaged import undamaged
from rosetta_jit.generate.passes.work_lists import RowBody
from rosetta_jit.generate.python.encoding.object_rows import ObjectScope
from rosetta_jit.generate.python.encoding.parts import Parts
from rosetta_jit.generate.python.encoding.recursive_rows import row_function, rows_in_parts
from rosetta_jit.generate.python.passes.asked import counts_asked_first
from rosetta_jit.generate.python.passes.bools import with_stored_bools
from rosetta_jit.generate.python.passes.counted import counted
from rosetta_jit.generate.python.passes.guards import without_guards
from rosetta_jit.generate.python.passes.local_names import Locals
from rosetta_jit.generate.python.passes.positions import NotInParts, Sum, without_places, without_positions
from rosetta_jit.generate.python.passes.presence import is_behind_message, without_lengths
from rosetta_jit.generate.python.printing.functions import words_of
from rosetta_jit.generate.python.printing.printed import Function, Objects
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.ir import Kernel, Routine
from rosetta_jit.kernel.nodes import Block, Expect, Return
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.types import Ref
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes


KNOWN = {"write_varint": "_varint"}
"""Routines of which a module has a function already, which gives the bytes that they write."""


@dataclass(frozen=True, slots=True)
class InParts:
    """An encoder: the functions of its routines, the lines that make the message of ``target``, what they need."""

    routines: tuple[str, ...]
    lines: tuple[str, ...]
    loads: frozenset[str]
    from_call: frozenset[str]


def encoder_in_parts(unit: Unit, kernel: Kernel, lanes: Lanes, paths: tuple[str, ...], lists: Mapping[tuple[int, int], int]) -> InParts:
    """The encoder of a unit; raises NotInParts where it cannot be printed so. ``lists`` are those that `Parts` knows as late."""
    if len(kernel.bodies) != 1:
        raise NotInParts
    loads, written = set[str](), dict(KNOWN)
    texts = _routines(unit, kernel, lambda: _scope(kernel, lanes, paths, loads), written)
    scope = _scope(kernel, lanes, paths, loads)
    scope.numpy = unit.numpy
    body = undamaged(reached(kernel.bodies[0]), kernel.sites)
    descents = _descents(body, unit)
    body, rows = rows_in_parts(body, unit.layout) if descents is None else (descents.body, dict[int, RowBody]())
    scope.keeps_long = bool(rows)
    parts = _parts(unit, kernel, scope, body, written, depth=2)
    parts.has_long = bool(rows)
    parts.visits = {} if descents is None else descents.visits
    parts.lists = lists
    parts.binder.bind(0, index(0), "target", Ref(unit.type), unit.layout.root)
    parts.block(parts.body)
    called, pending, inner = set[str](), set(parts.called), dict[int, str]()
    for lane, struct in unit.layout.recursive:
        of_lane = _scope(kernel, lanes, paths, loads)
        if descents is not None and lane in descents.rows:
            of_row, inner[lane] = _visited(unit, kernel, of_lane, (lane, struct), descents, written)
        elif lane in rows:
            of_row, inner[lane] = _row(unit, kernel, of_lane, (lane, struct, rows[lane]), written)
        else:
            continue
        pending |= of_row.called
        parts.rows_called |= of_row.rows_called
    if not parts.rows_called <= {*inner}:
        raise NotInParts
    while pending:
        name = pending.pop()
        called.add(name)
        pending |= {each for each, function in written.items() if any(f"{function}(" in line for line in texts.get(name, ())[1:])} - called
    lines = [*(["        parts = []"] if parts.begun else []), *parts.function.writer.lines]
    routines = tuple("\n".join(texts[name]) for name in written if name in called and name in texts)
    return InParts(
        (*routines, *(inner[lane] for lane in sorted(parts.rows_called))), tuple(lines), frozenset(loads), frozenset(scope.from_call)
    )


def _routines(unit: Unit, kernel: Kernel, scope: Callable[[], ObjectScope], written: dict[str, str]) -> dict[str, list[str]]:
    """The functions of routines, by name; ``written`` gets what those that can be printed are called."""
    texts = dict[str, list[str]]()
    for routine in kernel.routines:
        if routine.name in KNOWN:
            continue
        try:
            texts[routine.name] = _routine(unit, kernel, routine, scope(), written)
        except NotInParts:
            continue
        written[routine.name] = f"_encode_{routine.name}"
    return texts


def _descents(body: Block, unit: Unit) -> Descents | None:
    try:
        return descended(body, unit.layout)
    except NotNested:
        return None


def _visited(
    unit: Unit, kernel: Kernel, scope: ObjectScope, of: tuple[int, str], descents: Descents, written: dict[str, str]
) -> tuple[Parts, str]:
    """The function that adds the parts of a message of a lane, of a type that contains itself."""
    lane, struct = of
    scope.numpy = unit.numpy
    depth = scope.locals.identifier(descents.depth.name)
    parts = _parts(unit, kernel, scope, descents.rows[lane], written, depth=1)
    *block, last = parts.body
    assert isinstance(last, Return)
    parts.visits, parts.begun = descents.visits, True
    begin = descents.at.name
    parts.positions.at = parts.positions.values[begin] = Sum(0, frozenset({(begin, 1)}))
    element = parts.binder.local("element")
    parts.binder.bind(lane, descents.row, element, Ref(struct), unit.layout.lanes[lane].element)
    parts.block(tuple(block))
    if parts.positions.sum(last.position) != parts.positions.at:
        raise NotInParts
    parts.flush()
    return parts, "\n".join([f"def {row_function(scope.lanes, lane)}({element}, parts, {depth}):", *parts.function.writer.lines])


def _scope(kernel: Kernel, lanes: Lanes, paths: tuple[str, ...], loads: set[str]) -> ObjectScope:
    return ObjectScope(Locals(words_of(lanes)), lanes, flat=True, loads=loads, name=kernel.name, paths=paths)


def _parts(unit: Unit, kernel: Kernel, scope: ObjectScope, block: Block, written: dict[str, str], depth: int) -> Parts:
    body = with_stored_bools(without_guards(without_positions(counted(without_lengths(block, kernel.sites, scope.lanes.own)))))
    body = counts_asked_first(body, unit.layout)
    objects = Objects(lambda _, __: "message")
    function = Function(scope, kernel, kernel.sites, {}, unit.origins.get("encode", ()), objects, writer=Writer(depth=depth))
    function.read = read_names(without_places(body))
    return Parts(unit, function, scope, body, written)


def _routine(unit: Unit, kernel: Kernel, routine: Routine, scope: ObjectScope, written: dict[str, str]) -> list[str]:
    """A routine that writes from its first parameter on, and gives the position behind: a function of the others that gives the bytes."""
    parts = _parts(unit, kernel, scope, routine.body, written, depth=1)
    if not routine.parameters or len(routine.results) != 1 or any(isinstance(stmt, Expect) for stmt, _ in statements(parts.body)):
        raise NotInParts
    first, *others = routine.parameters
    parts.positions.at = parts.positions.values[first.name] = Sum(0, frozenset({(first, 1)}))
    parameters = ", ".join(scope.locals.identifier(each.name) for each in others)
    parts.block(parts.body)
    if parts.positions.sum(routine.results[0]) != parts.positions.at:
        raise NotInParts
    parts.end("")
    begun = ["    parts = []"] if parts.begun else []
    return [f"def _encode_{routine.name}({parameters}):", *begun, *parts.function.writer.lines]


def _row(unit: Unit, kernel: Kernel, scope: ObjectScope, of: tuple[int, str, RowBody], written: dict[str, str]) -> tuple[Parts, str]:
    """The function for messages of a lane, of a type that contains itself."""
    lane, struct, row = of
    scope.numpy, scope.keeps_long = unit.numpy, True
    parts = _parts(unit, kernel, scope, (*row.block, Return(row.end)), written, depth=1)
    parts.result = "_joined"
    if any(isinstance(stmt, Expect) and not is_behind_message(stmt) and stmt.failure.indices for stmt, _ in statements(parts.body)):
        raise NotInParts  # the function knows of no loop around it
    parts.positions.at = parts.positions.values[row.begin] = Sum(0, frozenset({(row.begin, 1)}))
    element = parts.binder.local("element")
    parts.binder.bind(lane, row.row, element, Ref(struct), unit.layout.lanes[lane].element)
    parts.block(parts.body)
    begun = ["    parts = []"] if parts.begun else []
    return parts, "\n".join([f"def {row_function(scope.lanes, lane)}({element}):", *begun, *parts.function.writer.lines])
