"""Lists within lists that an encoder reads where the object has them: the row of an element has the address of its list, and its count.

These are lists of structs, texts and lists; and lists of numbers that a kernel reads one by one, because it swaps their bytes or converts
them from the types of the class. Two conditions hold. The class has the elements themselves, not pointers to them as protoc's classes do:
an encoder measures a message and then writes it, and would follow each pointer twice, which takes longer than to make rows. And kernels
reach the elements by nothing but the address in the row, or a local that has it (`generate.c.within`).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from string import Template

from rosetta_jit.generate.c.holder.rows import path_to
from rosetta_jit.generate.c.holder.within import Within, element_of
from rosetta_jit.generate.c.printing.varint_loops import rounds_of
from rosetta_jit.generate.cpp.objects.lists import is_readable, lanes_of, nodes_of, row_name
from rosetta_jit.generate.cpp.objects.spots import Direct, Listed, ListWithin, Spot
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.passes.undamaged import undamaged_kernel
from rosetta_jit.generate.unit import Unit, kind_of, wires_of
from rosetta_jit.kernel.nodes import Assign, Block, Copy, Expr, For, Get, Let, Place, Stmt, Var, While
from rosetta_jit.model.layout import Number, Row, Slot, Span
from rosetta_jit.model.types import Array, Ref, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, replace

HOLDER = "std::declval<const holder &>()"
ELEMENT = Template("std::declval<const rosetta_jit::detail::element_type<decltype($list)> &>()")


@dataclass(frozen=True, slots=True)
class _Uses:
    """What a function of a kernel does that reads objects: all that names a lane, by the lane; what locals are, by their names.

    ``changed`` are locals that may change, ``in_rounds`` lanes that another function reads one number after another.
    """

    by_lane: Mapping[int, list[Stmt | Expr]]
    locals: Mapping[str, list[Expr]]
    changed: frozenset[str]
    in_rounds: frozenset[int]


def lists_within(walk: Walk) -> dict[int, ListWithin]:
    """Those that an encoder reads, by their lanes; ``walk`` knows the lanes whose texts it takes by their addresses."""
    root = (Ref(walk.unit.type), walk.unit.layout.root, Spot(HOLDER))
    candidates = [] if wires_of(walk.unit) else [*_within(walk, *root, 0, set())]
    if not candidates or not {"encode", "size"} & set(map(kind_of, walk.unit.kernels)):
        return {}
    uses, found = [*map(_uses, _blocks(walk.unit))], dict[int, ListWithin]()
    for each, lane, offset in candidates:
        slot = walk.unit.layout.lanes[each.direct.lane].element
        if (
            is_readable(replace(walk, within=found), each.element, slot)
            and (within := _found_by(walk, each, lane, offset, uses)) is not None
        ):
            found[each.direct.lane] = ListWithin(each, within)
    return found


def _blocks(unit: Unit) -> Iterator[Block]:
    """The blocks of these kernels, as they are printed."""
    for kernel in (undamaged_kernel(kernel) for role, kernel in unit.kernels.items() if kind_of(role) in ("encode", "size")):
        yield from (*kernel.bodies, *(routine.body for routine in kernel.routines))


def _uses(block: Block) -> _Uses:
    by_lane, known = defaultdict[int, list[Stmt | Expr]](list), defaultdict[str, list[Expr]](list)
    changed, in_rounds = set[str](), set[int]()
    for node in nodes_of(block):
        for lane in lanes_of(node):
            by_lane[lane].append(node)
        match node:
            case Let(name, value):
                known[name].append(value)
            case Var(name) | Assign(name) | For(name):
                changed.add(name)
            case While() if rounds_of(node) is not None:
                in_rounds |= {lane for inner in nodes_of((node,)) for lane in lanes_of(inner)}
            case _:
                pass
    return _Uses(by_lane, known, frozenset(changed), frozenset(in_rounds))


def _within(walk: Walk, type_: Type, slot: Slot, spot: Spot, lane: int, visited: set[int]) -> Iterator[tuple[Listed, int, int]]:
    """Lists that elements of lists have, the innermost ones first, and where their spans lie: ``lane`` has the row of a value.

    So do messages that contain their own type, each of which is ``visited`` once.
    """
    resolved = walk.unit.schema.resolve(type_)
    match resolved, slot:
        case Struct(), Row(members=members):
            for each, name, member in zip(resolved.fields, walk.names(resolved), members, strict=True):
                if member.presence is None:
                    yield from _within(walk, each.type, member.slot, walk.member_of(spot.at, name), lane, visited)
        case Array(element), Span(offset, own) if walk.unit.layout.lanes[own].links is None:
            at, inner = walk.text("direct", spot), walk.unit.layout.lanes[own].element
            if not isinstance(inner, Number):
                yield from _within(walk, element, inner, Spot(ELEMENT.substitute(list=at)), own, visited)
            if lane and own not in walk.addressed and walk.text("laid out", spot):
                yield Listed(Direct(own, "", Spot(at)), element), lane, offset
        case ((Array() | Struct()), Span(_, own)) if own in walk.visited - visited:
            visited.add(own)
            element = resolved.element if isinstance(resolved, Array) else type_
            at = Spot(f"std::declval<const {walk.lanes.objects(own)}::type &>()")
            yield from _within(walk, element, walk.unit.layout.lanes[own].element, at, own, visited)
        case _:
            return


def _found_by(walk: Walk, listed: Listed, lane: int, offset: int, uses: Collection[_Uses]) -> Within | None:
    """How kernels find the elements of a list; None where they do more than to read fields of its rows and copy rows to the message.

    Locals have the address of a list in functions of their own: elsewhere one of the same name may be anything.
    """
    own = listed.direct.lane
    within = Within(f"{row_name(walk.lanes, own)}::list", lane, offset, frozenset())
    starts = [frozenset(_starts(each, within)) for each in uses]
    within = replace(within, starts=frozenset[str]().union(*starts))
    is_found = all(
        own not in each.in_rounds and all(_is_read(walk, node, within, names) for node in each.by_lane.get(own, ()))
        for each, names in zip(uses, starts, strict=True)
    )
    return within if is_found else None


def _starts(uses: _Uses, within: Within) -> Iterator[str]:
    """The locals of a function that have the address of a list."""
    return (name for name, values in uses.locals.items() if name not in uses.changed and all(map(within.is_start, values)))


def _is_read(walk: Walk, node: Stmt | Expr, within: Within, starts: frozenset[str]) -> bool:
    """Whether a field of a row is read, or rows are copied to the message, in a function in which ``starts`` have addresses of lists."""
    match node:
        case Get(type_, Place(lane, row, offset)):
            element = walk.lanes.all[lane].element
            is_member = element is not None and path_to(element, offset, type_) is not None
        case Copy(target, Place(_, row, _)):
            is_member = not isinstance(target, Place)
        case _:
            return False
    found = element_of(row, replace(within, starts=starts))
    return is_member and found is not None and found == element_of(row, within)
