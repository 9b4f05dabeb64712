"""Lists within lists that an encoder reads where the object has them: a row of an element has the address of its list, and their count.

That is so of lists of structs, texts and lists, whatever has them; and of numbers that a kernel reads one by one, as it turns their bytes
round, or as a class has them as others. Each row of them must be found by such an address, which a local has or a row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from string import Template

from rosetta_jit.generate.c.rows import path_to
from rosetta_jit.generate.c.varint_loops import rounds_of
from rosetta_jit.generate.c.within import Within, element_of
from rosetta_jit.generate.cpp.lists import Listed, is_readable, lanes_of, nodes_of, row_name
from rosetta_jit.generate.cpp.spots import Direct, Spot
from rosetta_jit.generate.cpp.walk import Walk
from rosetta_jit.generate.undamaged import undamaged_kernel
from rosetta_jit.generate.unit import Unit, kind_of, wires_of
from rosetta_jit.kernel.nodes import Assign, Block, Copy, Expr, For, Get, Let, Place, Stmt, Var, While
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Number, Row, Slot, Span
from rosetta_jit.model.types import Array, Ref, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, replace

HOLDER = "std::declval<const holder &>()"
ELEMENT = Template("std::declval<const rosetta_jit::detail::element_type<decltype($list)> &>()")


@dataclass(frozen=True, slots=True)
class ListWithin:
    """Such a list: what its elements are, and how kernels find it."""

    listed: Listed
    within: Within


def lists_within(walk: Walk) -> list[ListWithin]:
    """Those that an encoder reads; ``walk`` knows the lanes whose texts it takes by their addresses."""
    if wires_of(walk.unit) or not {"encode", "size"} & set(map(kind_of, walk.unit.kernels)):
        return []
    blocks, found = [*_blocks(walk.unit)], list[ListWithin]()
    for each, lane, offset in _within(walk, Ref(walk.unit.type), walk.unit.layout.root, Spot(HOLDER), 0):
        slot = walk.unit.layout.lanes[each.direct.lane].element
        known = replace(walk, within=frozenset(inner.listed.direct.lane for inner in found))
        if is_readable(known, each.element, slot) and (within := _found_by(walk, each, lane, offset, blocks)) is not None:
            found.append(ListWithin(each, within))
    return found


def _blocks(unit: Unit) -> Iterator[Block]:
    """What kernels do that read objects, as it is printed."""
    for kernel in (undamaged_kernel(kernel) for role, kernel in unit.kernels.items() if kind_of(role) in ("encode", "size")):
        yield from (*kernel.bodies, *(routine.body for routine in kernel.routines))


def _within(walk: Walk, type_: Type, slot: Slot, spot: Spot, lane: int) -> Iterator[tuple[Listed, int, int]]:
    """Lists that elements of lists have, the innermost ones first, and where their spans lie: ``lane`` has the row of a value."""
    resolved = walk.unit.schema.resolve(type_)
    match resolved, slot:
        case Struct(), Row(members=members):
            for each, name, member in zip(resolved.fields, walk.names(resolved), members, strict=True):
                if member.presence is None:
                    yield from _within(walk, each.type, member.slot, walk.member_of(spot.at, name), lane)
        case Array(element), Span(offset, own) if walk.unit.layout.lanes[own].links is None:
            at, inner = walk.text("direct", spot), walk.unit.layout.lanes[own].element
            if not isinstance(inner, Number):
                yield from _within(walk, element, inner, Spot(ELEMENT.substitute(list=at)), own)
            is_number = isinstance(inner, Number)
            if lane and own not in walk.addressed and (not is_number or walk.text("laid out", spot)):
                yield Listed(Direct(own, "", Spot(at)), element), lane, offset
        case _:
            return


def _found_by(walk: Walk, listed: Listed, lane: int, offset: int, blocks: Iterable[Block]) -> Within | None:
    """How kernels find the elements of a list; None where they use them in another way."""
    own = listed.direct.lane
    within = Within(f"{row_name(walk.lanes, own)}::list", lane, offset, frozenset())
    starts, others = set[str](), set[str]()
    for stmt in (stmt for block in blocks for stmt, _ in statements(block)):
        match stmt:
            case Let(name, value) if within.is_start(value):
                starts.add(name)
            case Let(name) | Var(name) | Assign(name) | For(name):
                others.add(name)
            case _:
                pass
    within = replace(within, starts=frozenset(starts - others))
    element = walk.lanes.all[own].element
    return within if all(_is_found(within, own, block, lambda get: _is_member(get, element)) for block in blocks) else None


def _is_member(get: Get, element: object) -> bool:
    return path_to(element, get.place.offset, get.type) is not None  # type: ignore[arg-type]


def _is_found(within: Within, lane: int, block: Block, is_member: Callable[[Get], bool]) -> bool:
    """Whether all that a block does with a lane is to read fields of its rows, or to copy rows to the message."""

    def is_read(node: Stmt | Expr) -> bool:
        match node:
            case Get(_, place):
                return is_member(node) and element_of(place.row, within) is not None
            case Copy(target, Place(_, row, _)):
                return not isinstance(target, Place) and element_of(row, within) is not None
            case _:
                return False

    at_once = (each for each, _ in statements(block) if isinstance(each, While) and rounds_of(each) is not None)
    in_rounds = {used for each in at_once for node in nodes_of((each,)) for used in lanes_of(node)}
    return lane not in in_rounds and all(is_read(node) for node in nodes_of(block) if lane in lanes_of(node))
