"""Lists of structs and of texts: kernels work on the elements where the object has them, as far as these are what rows are.

An encoder *views* a list: a row is made of an element when the kernel reads it, and no list of rows is put together.
A decoder *takes* a list where its elements lie in memory as the rows do: they are the rows. Elements that do not lie so are set one by one.
Only a compiler knows how a class lies in memory: `lies` of a generated struct asks it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.c.holder.rows import Struct as RowStruct
from rosetta_jit.generate.c.holder.rows import members_of, path_to
from rosetta_jit.generate.cpp.objects.always import spans
from rosetta_jit.generate.cpp.objects.between import between
from rosetta_jit.generate.cpp.objects.spots import Direct, Listed, Spot
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.unit import Unit, kind_of
from rosetta_jit.kernel.nodes import Advance, Block, Capacity, Copy, Expr, Get, HostCall, Place, Reserve, Stmt, Used
from rosetta_jit.kernel.walk import expressions_of, extents_of, statements, subexpressions
from rosetta_jit.model.layout import Number, Row, Slot, Span
from rosetta_jit.model.types import Array, Bytes, String, Struct, Type
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes


def viewed(walk: Walk, at: str) -> list[Listed]:
    """The lists that an encoder views; ``walk`` knows the lanes whose texts it takes by their addresses."""
    own = [each for each in _lists(walk, at) if is_readable(walk, each.element, walk.unit.layout.lanes[each.direct.lane].element)]

    def is_read(node: Stmt | Expr) -> bool:
        """Whether a row is read, by a member that it has, or bytes of it are copied to the message."""
        match node:
            case Get(type_, place):
                element = walk.lanes.all[place.lane].element if place.lane < walk.lanes.own else None
                return element is not None and path_to(element, place.offset, type_) is not None
            case Copy(target, _):
                return not isinstance(target, Place)
            case _:
                return isinstance(node, Used)

    other = _other_uses(walk.unit, ("encode", "size"), is_read) if own else set[int]()
    return [each for each in own if each.direct.lane not in other]


def taken(walk: Walk, at: str) -> list[Listed]:
    """The lists of structs that have numbers alone, which a decoder fills where they are."""
    return [each for each in _lists(walk, at) if laid_out(walk, each)]


def _lists(walk: Walk, at: str) -> Iterator[Listed]:
    unit = walk.unit
    for type_, span, row, spot in spans(walk, at):
        layout = unit.layout.lanes[span.lane]
        if isinstance(type_, Array) and not isinstance(layout.element, Number) and layout.links is None:
            yield Listed(Direct(span.lane, row, Spot(walk.text("direct", spot), spot.owner, spot.field)), type_.element)


def is_readable(walk: Walk, type_: Type, slot: Slot) -> bool:
    """Whether a row can be made of an element without memory for anything that it contains."""
    match walk.unit.schema.resolve(type_), slot:
        case _, Number():
            return True
        case ((String() | Bytes() | Array()), Span(_, lane)):
            return lane in walk.addressed or lane in walk.within
        case Struct(fields=fields), Row(members=members, unknown=None):
            parts = zip(fields, members, strict=True)
            return all(member.presence is None and is_readable(walk, each.type, member.slot) for each, member in parts)
        case _:
            return False


# --- what kernels do with lanes ------------------------------------------------------------------------------------------------------


def _other_uses(unit: Unit, kinds: tuple[str, ...], allowed: Callable[[Stmt | Expr], bool]) -> set[int]:
    """The lanes that kernels of some kinds use in another way than is allowed."""
    kernels = [kernel for role, kernel in unit.kernels.items() if kind_of(role) in kinds]
    blocks = [block for kernel in kernels for block in (*kernel.bodies, *(routine.body for routine in kernel.routines))]
    return {lane for block in blocks for node in nodes_of(block) if not allowed(node) for lane in lanes_of(node)}


def nodes_of(block: Block) -> Iterator[Stmt | Expr]:
    """The statements of a block, and their expressions."""
    for stmt, _ in statements(block):
        yield stmt
        for expr in expressions_of(stmt):
            yield from subexpressions(expr)


def lanes_of(node: Stmt | Expr) -> set[int]:
    """The lanes that a statement or expression names itself."""
    if isinstance(node, Reserve | Advance | Used | Capacity):
        return {node.lane}
    named = [getattr(node, name, None) for name in ("place", "target", "source", "address")]
    named += [each.address for each in extents_of(node)] if isinstance(node, HostCall) else []
    return {each.lane for each in named if isinstance(each, Place)}


# --- what is printed -----------------------------------------------------------------------------------------------------------------


def laid_out(walk: Walk, listed: Listed) -> list[tuple[str, str]]:
    """The numbers of an element, as its class and as rows reach them; none where it has anything else, or gaps."""
    found = [*numbers_of(walk, listed.element, listed.direct.lane)]
    covered = sum(each.size for each in found)
    return [(each.field, each.member) for each in found] if covered == walk.lanes.stride(listed.direct.lane) else []


@dataclass(frozen=True, slots=True)
class NumberOf:
    """A number of an element, as its class and as rows reach it, and which bytes of a row it is."""

    field: str
    member: str
    offset: int
    size: int


def numbers_of(walk: Walk, type_: Type, lane: int) -> Iterator[NumberOf]:
    """Those of the elements of a lane."""
    yield from _numbers(walk, type_, walk.unit.layout.lanes[lane].element, walk.lanes.all[lane].element, NumberOf("", "", 0, 0))


def _numbers(walk: Walk, type_: Type, slot: Slot, element: object, around: NumberOf) -> Iterator[NumberOf]:
    resolved = walk.unit.schema.resolve(type_)
    if not isinstance(resolved, Struct) or not isinstance(slot, Row) or not isinstance(element, RowStruct):
        return
    for each, name, member, own in zip(resolved.fields, walk.names(resolved), slot.members, members_of(element), strict=True):
        inner = walk.text("laid out", Spot("", around.field, name))
        row, offset = f"{around.member}{own.identifier}", around.offset + own.offset
        if inner and member.presence is None and isinstance(member.slot, Number):
            yield NumberOf(inner.lstrip("."), row, offset, own.size)
        elif inner:
            yield from _numbers(walk, each.type, member.slot, own.type, NumberOf(inner, f"{row}.", offset, own.size))


def row_struct(walk: Walk, listed: Listed, container: str = "") -> str:
    """A struct with what is known of an element: whether it lies in memory as a row does, and the row of it.

    And what shows a list that is reached by its address, if that is a ``container``.
    """
    lane = listed.direct.lane
    lanes, type_ = walk.lanes, walk.lanes.type(lane)
    walk.writer, walk.depth, walk.in_rows = Writer(depth=2), 0, 1
    between(walk, listed.element, walk.unit.layout.lanes[lane].element, lanes.all[lane].element, "row", Spot("element"))
    lies = [f"ROSETTA_JIT_LIES(Element, {field}, {type_}, {member})" for field, member in laid_out(walk, listed)]
    lines = [f"/* Elements of `{walk.unit.layout.lanes[lane].name}` and rows. */", f"struct {row_name(lanes, lane)} {{"]
    lines += ["    template <class Element> static constexpr bool lies()", "    {"]
    if lies:
        lines.append(f"        if constexpr (rosetta_jit::detail::may_lie<Element, {type_}>) {{")
        lines.append("            return " + " &&\n                   ".join(lies) + ";")
        lines.append("        }")
    lines += ["        return false;", "    }", ""]
    filled = walk.writer.text().splitlines()
    element = "const Element &element" if filled else "const Element &"
    lines += [f"    template <class Element> ROSETTA_JIT_INLINE static {type_} of({element})", "    {"]
    lines += [f"        {type_} row = {{}};", *filled, "        return row;", "    }"]
    if container:
        lines += ["", f"    using list = rosetta_jit::detail::view<{type_}, {container}, {row_name(lanes, lane)}>;"]
    lines += ["};", ""]
    return "\n".join(lines)


def row_name(lanes: Lanes, lane: int) -> str:
    """The name of the struct."""
    return f"{lanes.prefix}_{lanes.rows(lane)}_row"
