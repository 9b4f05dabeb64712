"""Encoders that stand in the header, where a compiler sees the object, too, and makes no call: of messages that take a few statements.

It is the first body of the kernel, which reads numbers, texts and arrays where the object has them. Where there is no room, or anything
else is wrong, it says so, and the encoder in the source file writes the message anew, and says what it is.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.c.decided import decided
from rosetta_jit.generate.c.function import Function
from rosetta_jit.generate.c.lanes import Given, Lanes
from rosetta_jit.generate.c.scope import Scope
from rosetta_jit.generate.c.statements import print_block
from rosetta_jit.generate.c.support import function_names
from rosetta_jit.generate.cpp.always import is_plain, numbers
from rosetta_jit.generate.cpp.at_once import MOST, PARAMETERS, SHARED, are_marked, check, is_shared
from rosetta_jit.generate.cpp.empty_lists import NOT_EMPTY, of_no_elements
from rosetta_jit.generate.cpp.few_elements import most_elements
from rosetta_jit.generate.cpp.lists_in_place import spans_of
from rosetta_jit.generate.cpp.measured_first import measured_first
from rosetta_jit.generate.cpp.messages_within import descents_of
from rosetta_jit.generate.cpp.numbers_apart import with_numbers_apart
from rosetta_jit.generate.cpp.shown_elements import shown_elements
from rosetta_jit.generate.cpp.walk import Walk
from rosetta_jit.generate.reachable import reached, read_names
from rosetta_jit.generate.roundings import two_roundings
from rosetta_jit.generate.undamaged import undamaged_kernel
from rosetta_jit.generate.unit import Unit, wires_of
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.nodes import Block, Expr
from rosetta_jit.kernel.passes.fold import folded
from rosetta_jit.kernel.rewrite import with_blocks, with_expressions, with_operands
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Number
from rosetta_jit.model.types import Array, Bytes, String
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.manners import Manners

OBJECT = "given_object"
FILL = nodes.Reserve | nodes.Call | nodes.HostCall
LEAVE = FILL | nodes.Require | nodes.Return
"""Statements that fill rows or call a function, and those that leave the function or ask for room."""


def put_at_once(unit: Unit, manners: Manners, lanes: Lanes) -> str:
    """The statements of such an encoder, empty where there is none."""
    kernel = unit.kernels["encode"]
    if wires_of(unit) or two_roundings((kernel,)):
        return ""
    reached_by, starts, lists = _shown(Walk(unit, lanes, manners, "encode"))
    descents = descents_of(unit).get("encode")
    kernel = undamaged_kernel(kernel) if descents is None else replace(kernel, bodies=(descents.body,))
    kernel = with_numbers_apart(kernel, unit.layout)
    empty = sorted(at for at, most in lists.items() if most == 0)
    body = _with_zeros(tuple(_checked(kernel.bodies[0], lists)), {*starts, *lists, *(at + 8 for at in empty)})
    body = reached(decided((*map(_is_empty, empty), *of_no_elements(body, () if descents is None else descents.visits))))
    if not _is_short(body):
        return ""
    body = measured_first(body, {at + 8 for at in (*starts, *lists)})
    words = lanes.words() | function_names() | {"data"}
    scope = Scope(Namespace(words), reached_by, set(), set(), set())
    function = Function(scope, kernel.sites, {}, read=read_names(body), otherwise="return -1;")
    function.writer.depth = 2
    for stmt in body:
        if isinstance(stmt, nodes.Require | nodes.Expect | nodes.Let):
            check(function, stmt, function.otherwise, marked=are_marked(body))
        else:
            print_block(function, (stmt,))
    arrays = [lane for lane in sorted(scope.touched) if lane in reached_by.given]
    types = ("const auto " if lane in reached_by.opened else f"const {lanes.type(lane)} *const " for lane in arrays)
    names = [f"{type_}{lanes.rows(lane)}" for lane, type_ in zip(arrays, types, strict=True)]
    function.writer.lines[:0] = [f"        {name} = {reached_by.member(lane)};" for name, lane in zip(names, arrays, strict=True)]
    is_free = frozenset(scope.parameters) == PARAMETERS and all(map(is_shared, scope.support)) and not scope.tables
    return function.writer.text() if is_free else ""


def _shown(walk: Walk) -> tuple[Lanes, frozenset[int], dict[int, int]]:
    """How an encoder reaches what every message has, and where spans begin in its row: of texts and numbers, and of other lists.

    Of these it says how many elements are written, which may be none.
    """
    lanes = walk.lanes
    shown = {(0, offset): f"rosetta_jit::detail::got<$type>({spot.at})" for offset, _, spot in numbers(walk, OBJECT)}
    given, starts, lists, opened, arrays = dict[int, Given](), set[int](), dict[int, int](), set[int](), set[int]()
    for type_, slot, spot in spans_of(walk, OBJECT):
        if isinstance(type_, String | Bytes | Array) and is_plain(walk, type_, slot.lane):
            at = walk.text("direct", spot)
            given[slot.lane] = Given("", f"rosetta_jit::detail::shown_rows<{lanes.type(slot.lane)}>({at})")
            shown[0, slot.offset + 8] = f"rosetta_jit::detail::count_of({at})"
            starts.add(slot.offset)
        elif isinstance(type_, Array) and type_.fixed is None and not isinstance(walk.unit.layout.lanes[slot.lane].element, Number):
            shown[0, slot.offset + 8] = f"rosetta_jit::detail::count_of({spot.at})"
            each = shown_elements(walk, type_, slot, spot.at)
            lists[slot.offset] = 0 if each is None else most_elements(lanes.stride(slot.lane))
            if each is not None:
                given[slot.lane] = Given("", each.first)
                shown |= each.fields
                arrays |= each.arrays
                opened.add(slot.lane)
    reached_by = replace(lanes, shown=shown, given=given, opened=frozenset(opened), addressed=frozenset(arrays), shared=SHARED, row=True)
    return reached_by, frozenset(starts), lists


def _is_empty(offset: int) -> nodes.Stmt:
    """The check that a list of the message has no elements: one with some is written by the encoder in the source file."""
    return nodes.Expect(nodes.Compare("eq", nodes.Get("i64", nodes.Place(0, index(0), offset + 8)), index(0)), NOT_EMPTY)


def _checked(body: Block, lists: Mapping[int, int]) -> Iterator[nodes.Stmt]:
    """Statements with checks that lists have few elements: one with more is written there, too. Few are never too many."""
    few = dict[str, int]()
    for stmt in body:
        match stmt:
            case nodes.Let(name, nodes.Get("i64", nodes.Place(0, _, offset))) if most := lists.get(offset - 8, 0):
                few[name] = most
                yield from (stmt, nodes.Expect(nodes.Compare("le", nodes.Local("i64", name), index(most)), NOT_EMPTY))
            case nodes.Expect(nodes.Compare("lt", nodes.Local(_, name), nodes.Const(_, bound))) if few.get(name, bound) < bound:
                pass
            case _:
                yield stmt


def _with_zeros(block: Block, offsets: Collection[int]) -> Block:
    """A block in which fields of the message's row are 0: elements of arrays begin at their lanes' row 0, and lists are empty."""

    def replaced(expr: Expr) -> Expr:
        match expr:
            case nodes.Get("i64", nodes.Place(0, _, offset)) if offset in offsets:
                return index(0)
            case _:
                return folded(with_operands(expr, replaced))

    inner = (with_blocks(stmt, lambda each: _with_zeros(each, offsets)) for stmt in block)
    return tuple(with_expressions(stmt, replaced) for stmt in inner)


def _is_short(body: Block) -> bool:
    """Whether a body has few statements, of which none within others returns, and the last one does."""
    found = [*statements(body)]
    leaves = any(isinstance(stmt, LEAVE if depth > 1 else FILL) for stmt, depth in found)
    return len(found) <= MOST and not leaves and isinstance(body[-1], nodes.Return) and not body[-1].registers
