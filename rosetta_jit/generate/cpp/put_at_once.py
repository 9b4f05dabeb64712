"""Encoders that stand in the header, where a compiler sees the object, too, and makes no call: of messages that take a few statements.

It is the first body of the kernel, which reads numbers, texts and arrays where the object has them. Where there is no room, or anything
else is wrong, it says so, and the encoder in the source file writes the message anew, and says what it is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.c.decided import decided
from rosetta_jit.generate.c.lanes import Given, Lanes
from rosetta_jit.generate.c.scope import Scope
from rosetta_jit.generate.c.statements import Function, print_block
from rosetta_jit.generate.c.support import function_names
from rosetta_jit.generate.cpp.always import is_plain, numbers
from rosetta_jit.generate.cpp.at_once import MOST, PARAMETERS, SHARED, are_marked, check, is_shared
from rosetta_jit.generate.cpp.empty_lists import NOT_EMPTY, of_no_elements
from rosetta_jit.generate.cpp.lists_in_place import spans_of
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
LEAVE = FILL | nodes.Require | nodes.Expect | nodes.Return
"""Statements that fill rows or call a function, and those that may leave the function."""


def put_at_once(unit: Unit, manners: Manners, lanes: Lanes) -> str:
    """The statements of such an encoder, empty where there is none."""
    kernel = unit.kernels["encode"]
    if wires_of(unit) or two_roundings((kernel,)):
        return ""
    reached_by, starts, lists = _shown(Walk(unit, lanes, manners, "encode"))
    body = _with_zeros(undamaged_kernel(kernel).bodies[0], starts | lists | {at + 8 for at in lists})
    body = reached(decided((*map(_is_empty, sorted(lists)), *(of_no_elements(body) if lists else body))))
    if not _is_short(body):
        return ""
    words = lanes.words() | function_names() | {"data"}
    scope = Scope(Namespace(words), reached_by, set(), set(), set())
    function = Function(scope, kernel.sites, {}, read=read_names(body))
    function.writer.depth = 2
    for stmt in body:
        if isinstance(stmt, nodes.Require | nodes.Expect | nodes.Let):
            check(function, stmt, "return -1;", marked=are_marked(body))
        else:
            print_block(function, (stmt,))
    arrays = [lane for lane in sorted(scope.touched) if lane in reached_by.given]
    names = [f"const {lanes.type(lane)} *const {lanes.rows(lane)}" for lane in arrays]
    function.writer.lines[:0] = [f"        {name} = {reached_by.member(lane)};" for name, lane in zip(names, arrays, strict=True)]
    is_free = frozenset(scope.parameters) == PARAMETERS and all(map(is_shared, scope.support)) and not scope.tables
    return function.writer.text() if is_free else ""


def _shown(walk: Walk) -> tuple[Lanes, frozenset[int], frozenset[int]]:
    """How an encoder reaches what every message has, and where spans begin in its row: of texts and numbers, and of other lists."""
    lanes = walk.lanes
    shown = {offset: f"rosetta_jit::detail::got<$type>({spot.at})" for offset, _, spot in numbers(walk, OBJECT)}
    given, starts, lists = dict[int, Given](), set[int](), set[int]()
    for type_, slot, spot in spans_of(walk, OBJECT):
        if isinstance(type_, String | Bytes | Array) and is_plain(walk, type_, slot.lane):
            at = walk.text("direct", spot)
            given[slot.lane] = Given("", f"rosetta_jit::detail::shown_rows<{lanes.type(slot.lane)}>({at})")
            shown[slot.offset + 8] = f"rosetta_jit::detail::count_of({at})"
            starts.add(slot.offset)
        elif isinstance(type_, Array) and type_.fixed is None and not isinstance(walk.unit.layout.lanes[slot.lane].element, Number):
            shown[slot.offset + 8] = f"rosetta_jit::detail::count_of({spot.at})"
            lists.add(slot.offset)
    return replace(lanes, shown=shown, given=given, shared=SHARED, row=True), frozenset(starts), frozenset(lists)


def _is_empty(offset: int) -> nodes.Stmt:
    """The check that a list of the message has no elements: one with some is written by the encoder in the source file."""
    return nodes.Expect(nodes.Compare("eq", nodes.Get("i64", nodes.Place(0, index(0), offset + 8)), index(0)), NOT_EMPTY)


def _with_zeros(block: Block, offsets: frozenset[int]) -> Block:
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
    """Whether a body has few statements, of which none within others leaves it, and the last one returns."""
    found = [*statements(body)]
    leaves = any(isinstance(stmt, LEAVE if depth > 1 else FILL) for stmt, depth in found)
    return len(found) <= MOST and not leaves and isinstance(body[-1], nodes.Return) and not body[-1].registers
