"""Lists of structs of numbers whose elements lie in the message without gaps: where they lie so in an object, all are copied at once.

Rows may have gaps that messages have not: three floats are a row of 16 bytes. Only a compiler knows how a class lies in memory: `lies` of a
generated struct asks it. Lists that lie in memory as rows do are copied in any case (`lists`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from rosetta_jit.generate.c.holder.lanes import Packed
from rosetta_jit.generate.c.words import C_ROWS
from rosetta_jit.generate.cpp.decoding.lists_in_place import Opened
from rosetta_jit.generate.cpp.objects.lists import NumberOf, numbers_of
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import WIDTH, Binary, Const, Expr, For, Let, Load, Local, Place, Scalar, SetField, Stmt
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.walk import statements
from rosetta_jit.startup.dataclass import dataclass

COPY = "rosetta_jit::detail::copy_elements"


@dataclass(frozen=True, slots=True)
class _Element:
    """An element in the message: how many bytes it has, and which number lies where, by its place in a row."""

    lane: int
    at: Expr
    size: int
    numbers: Mapping[int, tuple[Scalar, int]]

    def lies_as(self, other: _Element) -> bool:
        """Whether another one has the same numbers in the same places."""
        return (self.size, self.numbers) == (other.size, other.numbers)


def packed_lists(walk: Walk, kernel: Kernel, lists: Iterable[Opened]) -> dict[For, Packed]:
    """The loops of a decoder that set such lists."""
    found = _found(walk, kernel, lists)
    return {stmt: Packed(each.lane, each.at, each.size, _lies(walk, each.lane), COPY) for stmt, each, _ in found}


def packed_structs(walk: Walk, kernel: Kernel, lists: Iterable[Opened]) -> str:
    """What is known of their elements."""
    found = {each.lane: _struct(walk, each, fields) for _, each, fields in _found(walk, kernel, lists)}
    return "\n".join(text for _, text in sorted(found.items()))


def _found(walk: Walk, kernel: Kernel, lists: Iterable[Opened]) -> list[tuple[For, _Element, list[NumberOf]]]:
    """Such loops, their elements, and the numbers of these; where several set one list, it lies in all their messages alike."""
    loops = [*_loops(kernel)]
    found = [(stmt, each, _fields(walk, lists, each)) for stmt, each in loops]
    return [each for each in found if each[2] and all(other.lies_as(each[1]) for _, other in loops if other.lane == each[1].lane)]


def _lies(walk: Walk, lane: int) -> str:
    return f"{_name(walk, lane)}::lies<rosetta_jit::detail::in_order<decltype({walk.lanes.rows(lane)})>>()"


def _name(walk: Walk, lane: int) -> str:
    return f"{walk.lanes.prefix}_{walk.lanes.rows(lane)}_in_message"


def _struct(walk: Walk, element: _Element, fields: list[NumberOf]) -> str:
    numbers = [(each.field, *element.numbers[each.offset]) for each in fields]
    lies = [f"ROSETTA_JIT_LIES_AT(Element, {field}, {at}, {C_ROWS[type_]})" for field, type_, at in numbers]
    lines = [
        f"/* Elements of `{walk.unit.layout.lanes[element.lane].name}` in a message. */",
        f"struct {_name(walk, element.lane)} {{",
        "    template <class Element> static constexpr bool lies()",
        "    {",
        f"        if constexpr (rosetta_jit::detail::may_lie<Element, unsigned char[{element.size}]>) {{",
        "            return " + " &&\n                   ".join(lies) + ";",
        "        }",
        "        return false;",
        "    }",
        "};",
        "",
    ]
    return "\n".join(lines)


def _fields(walk: Walk, lists: Iterable[Opened], element: _Element) -> list[NumberOf]:
    """The numbers of an element of an opened list, if these are all that it has, and the message has them without gaps."""
    type_ = next((each.structs[element.lane] for each in lists if element.lane in each.structs), None)
    fields = [] if type_ is None else [*numbers_of(walk, type_, element.lane)]
    is_whole = {each.offset for each in fields} == set(element.numbers) and sum(each.size for each in fields) == element.size
    return fields if is_whole and not _has_gaps(element) else []


def _has_gaps(element: _Element) -> bool:
    end = 0
    for type_, at in sorted(element.numbers.values(), key=lambda each: each[1]):
        if at != end:
            return True
        end += WIDTH[type_]
    return end != element.size


def _loops(kernel: Kernel) -> Iterator[tuple[For, _Element]]:
    """The loops that do nothing but set numbers of rows from numbers of the message, one row behind another."""
    for stmt in (stmt for body in kernel.bodies for stmt, _ in statements(body)):
        match stmt:
            case For(variable, _, (Let(item, Binary("add", one, other)), *rest)):
                for at, step in ((one, other), (other, one)):
                    element = _element(at, _size(step, variable), [_number(each, variable, item) for each in rest])
                    if element is not None and variable not in locals_in(at):
                        yield stmt, element
            case _:
                pass


def _size(step: Expr, variable: str) -> int:
    """How many bytes there are from one element to the next; 0 where an expression does not say that."""
    match step:
        case Binary("mul", Local(_, name), Const(_, size)) if name == variable:
            return int(size)
        case _:
            return 0


def _element(at: Expr, size: int, numbers: list[tuple[int, int, Scalar, int] | None]) -> _Element | None:
    """What such statements set."""
    found = [each for each in numbers if each is not None]
    if not size or len(found) < len(numbers) or len({lane for lane, *_ in found}) != 1:
        return None
    return _Element(found[0][0], at, size, {offset: (type_, behind) for _, offset, type_, behind in found})


def _number(stmt: Stmt, variable: str, item: str) -> tuple[int, int, Scalar, int] | None:
    """Of a statement that sets a number of the loop's row: lane, offset there, type, and place in the element."""
    match stmt:
        case SetField(Place(lane, Local(_, row), offset), Load(type_, Local(_, at), "<")) if (row, at) == (variable, item):
            return lane, offset, type_, 0
        case SetField(Place(lane, Local(_, row), offset), Load(type_, Binary("add", Local(_, at), Const(_, behind)), "<")):
            return (lane, offset, type_, int(behind)) if (row, at) == (variable, item) else None
        case _:
            return None
