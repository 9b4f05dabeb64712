"""Encoders that stand in the header, where a compiler sees the object, too, and makes no call: of messages that take a few statements.

It is the first body of the kernel, which reads numbers, texts and arrays where the object has them. Where there is no room, or anything
else is wrong, it says so, and the encoder in the source file writes the message anew, and says what it is.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.c.holder.lanes import Given, Lanes
from rosetta_jit.generate.c.printing.function import Callable, Function
from rosetta_jit.generate.c.printing.scope import Scope
from rosetta_jit.generate.c.printing.statements import print_block
from rosetta_jit.generate.c.support import function_names
from rosetta_jit.generate.c.words import C_TYPES
from rosetta_jit.generate.cpp.encoding.messages_within import descents_of
from rosetta_jit.generate.cpp.encoding.reading import reader
from rosetta_jit.generate.cpp.encoding.shown_elements import Shown, shown_elements
from rosetta_jit.generate.cpp.header_checks import MOST, PARAMETERS, SHARED, are_marked, check, is_shared
from rosetta_jit.generate.cpp.objects.always import is_plain, numbers, spans
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.cpp.passes.empty_lists import NOT_EMPTY, of_no_elements
from rosetta_jit.generate.cpp.passes.loops_apart import Apart, loops_apart
from rosetta_jit.generate.cpp.passes.measured_first import measured_first
from rosetta_jit.generate.cpp.passes.numbers_apart import with_numbers_apart
from rosetta_jit.generate.passes.decided import decided
from rosetta_jit.generate.passes.reachable import reached, read_names
from rosetta_jit.generate.passes.roundings import two_roundings
from rosetta_jit.generate.passes.undamaged import undamaged_kernel
from rosetta_jit.generate.unit import Unit, wires_of
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Expr
from rosetta_jit.kernel.passes.fold import folded
from rosetta_jit.kernel.rewrite import with_blocks, with_expressions, with_operands
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Number
from rosetta_jit.model.types import Array, Bytes, String
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.objects.manners import Manners

OBJECT = "given_object"
FEW_LINES = 60
"""What compilers put in place of a call."""
SHARED_BY_LOOPS = ("given_object", "bytes", "end")
"""What functions of loops are given, besides what these need."""
FILL = nodes.Reserve | nodes.Call | nodes.HostCall
LEAVE = FILL | nodes.Return
"""Statements that fill rows or call a function, and those that leave the function."""


@dataclass(frozen=True, slots=True)
class Object:
    """How an encoder reaches what every message has, and where spans begin in its row: of texts and numbers, and of other lists.

    Of these it says how many elements are written at most, which may be none. ``counts`` are fields that are counts, ``named`` is what
    shows lists within others.
    """

    lanes: Lanes
    starts: frozenset[int]
    lists: Mapping[int, int | None]
    counts: Collection[tuple[int, int]]
    named: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Puts:
    """The statements of such an encoder, empty where there is none, and the functions that it calls, as `AtOnce` has them."""

    text: str = ""
    each: tuple[tuple[str, str, str], ...] = ()


def put_at_once(unit: Unit, manners: Manners, lanes: Lanes) -> tuple[str, str, tuple[tuple[str, str, str], ...]]:
    """The statements of such an encoder; of one for messages without elements that have texts; and the functions that it calls.

    There are the second ones where a compiler would call the first ones, as they are many; where those would be too many, they are all.
    """
    if wires_of(unit) or two_roundings((unit.kernels["encode"],)):
        return "", "", ()
    walk = reader(unit, lanes, manners)
    puts, puts_empty = (_printed(unit, _object(walk, is_any_shown=each)) for each in (True, False))
    if puts.text in ("", puts_empty.text):
        return puts_empty.text, "", puts_empty.each
    return puts.text, "" if puts.text.count("\n") <= FEW_LINES else puts_empty.text, puts.each


def _printed(unit: Unit, reached_by: Object) -> Puts:
    body = _body(unit, reached_by)
    if sum(1 for _ in statements(body)) > MOST or not body:
        return Puts()
    kernel, lanes = unit.kernels["encode"], reached_by.lanes
    body, loops = loops_apart(body, lambda lane: f"put_each_{lanes.rows(lane)}")
    routines = {each.name: Callable(each.name, SHARED_BY_LOOPS, fails=False, returns=True) for each in loops}
    text, scope = _function(reached_by, kernel, body, routines)
    each = tuple(_of_loop(reached_by, kernel, loop, routines) for loop in loops)
    is_free = frozenset(scope.parameters) == PARAMETERS and all(map(_is_free, (scope, *(inner for _, inner in each))))
    return Puts(text, tuple(there for there, _ in each)) if is_free else Puts()


def _body(unit: Unit, reached_by: Object) -> Block:
    """The statements that look at the object first; none where they do more than to write it."""
    kernel, lanes, lists = unit.kernels["encode"], reached_by.lanes, reached_by.lists
    descents = descents_of(unit).get("encode")
    kernel = undamaged_kernel(kernel) if descents is None else replace(kernel, bodies=(descents.body,))
    kernel = with_numbers_apart(kernel, unit.layout, lanes.opened)
    empty = sorted(at for at, most in lists.items() if most == 0)
    body = _with_zeros(tuple(_checked(kernel.bodies[0], lists)), {*reached_by.starts, *lists, *(at + 8 for at in empty)})
    body = reached(decided((*map(_is_empty, empty), *of_no_elements(body, () if descents is None else descents.visits))))
    if not _is_straight(body) or _copies(body, {*lanes.opened, *lanes.within}):
        return ()
    return measured_first(body, reached_by.counts)


def _of_loop(reached_by: Object, kernel: Kernel, loop: Apart, routines: Mapping[str, Callable]) -> tuple[tuple[str, str, str], Scope]:
    """The function of a loop: its name, its parameters and its statements."""
    text, scope = _function(reached_by, kernel, loop.body, routines)
    parameters = (f"{C_TYPES[each.type]} {scope.locals.identifier(each.name)}" for each in loop.parameters)
    return (loop.name, ", ".join(parameters), text), scope


def _function(reached_by: Object, kernel: Kernel, body: Block, routines: Mapping[str, Callable]) -> tuple[str, Scope]:
    """Statements as a function has them, and what they need."""
    lanes = reached_by.lanes
    words = lanes.words() | function_names() | {"data", *reached_by.named, *routines}
    scope = Scope(Namespace(words), lanes, set(), set(), set())
    function = Function(scope, kernel.sites, routines, read=read_names(body), otherwise="return -1;")
    function.writer.depth = 2
    for stmt in body:
        if isinstance(stmt, nodes.Require | nodes.Expect | nodes.Let):
            check(function, stmt, function.otherwise, marked=are_marked(body))
        else:
            print_block(function, (stmt,))
    function.writer.lines[:0] = _begun(reached_by, scope, function.writer.lines)
    return function.writer.text(), scope


def _is_free(scope: Scope) -> bool:
    """Whether statements need no more than what such an encoder is given."""
    return frozenset(scope.parameters) <= PARAMETERS and all(map(is_shared, scope.support)) and not scope.tables


def _begun(reached_by: Object, scope: Scope, lines: Collection[str]) -> list[str]:
    """What is declared before the statements: pointers to arrays and lists, and the types of lists within these."""
    lanes, named = reached_by.lanes, _used(reached_by.named, lines)
    shown = {lane for lane in lanes.opened if any(f"{lanes.rows(lane)}[" in each for each in named.values())}
    arrays = [lane for lane in sorted(scope.touched | shown) if lane in lanes.given]
    types = ("const auto " if lane in lanes.opened else f"const {lanes.type(lane)} *const " for lane in arrays)
    names = [f"{type_}{lanes.rows(lane)}" for lane, type_ in zip(arrays, types, strict=True)]
    begun = [f"        {name} = {lanes.member(lane)};" for name, lane in zip(names, arrays, strict=True)]
    return [*begun, *(f"        using {name} = {type_};" for name, type_ in named.items())]


def _used(named: Mapping[str, str], lines: Collection[str]) -> dict[str, str]:
    """The types of lists that lines name, or that those name."""
    used = list[str]()
    for name in reversed([*named]):
        if any(f"{name}::at(" in line for line in (*lines, *(named[each] for each in used))):
            used.append(name)
    return {name: named[name] for name in reversed(used)}


def _object(walk: Walk, *, is_any_shown: bool) -> Object:
    """The same of an encoder's walk; ``is_any_shown``: also lists that are read element by element, however many there are."""
    lanes, elements, lists = walk.lanes, list[Shown](), dict[int, int | None]()
    shown = {(0, offset): f"rosetta_jit::detail::got<$type>({spot.at})" for offset, _, spot in numbers(walk, OBJECT)}
    given, starts, opened = dict[int, Given](), set[int](), set[int]()
    for type_, slot, _, spot in spans(walk, OBJECT):
        if isinstance(type_, String | Bytes | Array) and is_plain(walk, type_, slot.lane):
            at = walk.text("direct", spot)
            given[slot.lane] = Given("", f"rosetta_jit::detail::shown_rows<{lanes.type(slot.lane)}>({at})")
            shown[0, slot.offset + 8] = f"rosetta_jit::detail::count_of({at})"
            starts.add(slot.offset)
        elif isinstance(type_, Array) and type_.fixed is None and not isinstance(walk.unit.layout.lanes[slot.lane].element, Number):
            shown[0, slot.offset + 8] = f"rosetta_jit::detail::count_of({spot.at})"
            each = shown_elements(walk, type_, slot, spot)
            is_shown = each is not None and (is_any_shown or each.most is not None)
            lists[slot.offset] = each.most if each is not None and is_shown else 0
            if each is not None and is_shown:
                given[slot.lane] = Given("", each.first)
                opened.add(slot.lane)
                elements.append(each)
    shown |= {at: text for each in elements for at, text in each.fields.items()}
    counts = {(0, at + 8) for at in (*starts, *lists)}.union(*(each.counts for each in elements))
    arrays = frozenset(lane for each in elements for lane in each.arrays)
    within = {lane: list_ for each in elements for lane, list_ in each.within.items()}
    reached_by = replace(
        lanes, shown=shown, given=given, opened=frozenset(opened), addressed=arrays, within=within, shared=SHARED, row=True
    )
    named = {name: type_ for each in elements for name, type_ in each.named.items()}
    return Object(reached_by, frozenset(starts), lists, counts, named)


def _copies(body: Block, lanes: Collection[int]) -> bool:
    """Whether rows of lanes are copied, or bytes of them: the elements of an object need not lie so."""
    copied = (stmt.source for stmt, _ in statements(body) if isinstance(stmt, nodes.Copy))
    return any(isinstance(source, nodes.Place) and source.lane in lanes for source in copied)


def _is_empty(offset: int) -> nodes.Stmt:
    """The check that a list of the message has no elements: one with some is written by the encoder in the source file."""
    return nodes.Expect(nodes.Compare("eq", nodes.Get("i64", nodes.Place(0, index(0), offset + 8)), index(0)), NOT_EMPTY)


def _checked(body: Block, lists: Mapping[int, int | None]) -> Iterator[nodes.Stmt]:
    """Statements with checks that lists have few elements: one with more is written there, too. Few are never too many."""
    few = dict[str, int]()
    for stmt in body:
        match stmt:
            case nodes.Let(name, nodes.Get("i64", nodes.Place(0, _, offset))) if most := lists.get(offset - 8):
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


def _is_straight(body: Block) -> bool:
    """Whether a body calls nothing, and returns at its end alone, but where anything is wrong."""
    found = [*statements(body)]
    leaves = any(isinstance(stmt, LEAVE if depth > 1 else FILL) for stmt, depth in found)
    return not leaves and isinstance(body[-1], nodes.Return) and not body[-1].registers
