"""Messages with many lists and maps, in groups: where none of one comes, the class of the object says so, until somebody asks for one.

lacks = 3                                               lacks = _lacking.get(type(target), 0)
if any_lists_0:                                         if not lacks & 1:
    lacks -= 1                                              if len(target.texts):
    made.texts = texts if has_texts else []                     ...
    made.numbers = numbers if has_numbers else []           if len(target.numbers):
...                                                             ...
if lacks:                                               if not lacks & 2:
    _set_class(made, _M_without_lists[lacks])               ...
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.python.passes.asked import asked_count
from rosetta_jit.generate.python.passes.direct import LateRow, groups_of
from rosetta_jit.generate.python.printing.classes import TAKEN, member_names, numpy_scalar
from rosetta_jit.generate.python.printing.scope import Scope
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.nodes import Block, If, Place, Stmt, Var
from rosetta_jit.model.layout import Member, Row, Span
from rosetta_jit.model.types import Array, Field, Map, Struct

PRICE_OF_ARRAY = 3
"""How many lists take as much time to make as an array of numpy."""
LEAST = 24
"""Lists of a type from which on it takes less time to make none of them."""
LACKS = "lacks"
"""The local that says which groups of lists an object lacks."""


def lists_of_message(unit: Unit) -> tuple[Span, ...]:
    """The lists and maps of the message, if it has many, and nothing else that is made for each object."""
    root, slot = unit.schema.types[unit.type], unit.layout.root
    assert isinstance(root, Struct)
    return lists_of(root, slot, unit, LEAST) if isinstance(slot, Row) else ()


def lists_of(struct: Struct, slot: Row, unit: Unit, least: int) -> tuple[Span, ...]:
    """The lists and maps of a struct, if it has as many as ``least``, and nothing else that is made for each object."""
    found, price = list[Span](), 0
    for each, member in zip(struct.fields, slot.members, strict=True):
        match each.type, member.slot:
            case Array(element, length), Span() as span if not isinstance(length, int):
                found.append(span)
                price += PRICE_OF_ARRAY if numpy_scalar(element, unit) else 1
            case Map(), Span() as span:
                found.append(span)
                price += 1
            case type_, _ if member.presence is None and isinstance(unit.schema.resolve(type_), Array | Struct):
                return ()
            case _:
                pass
    return tuple(found) if price >= least else ()


def late_lists(unit: Unit, scope: Scope) -> tuple[tuple[Span, ...], ...]:
    """The groups of lists that the object of a message may lack; nothing where its lists are made whatever comes."""
    lists = lists_of_message(unit)

    def is_late(span: Span) -> bool:
        """Whether a local says that the list has come: its own, or the number of its messages, whose type contains itself."""
        return scope.direct.late_at(span) is not None or unit.layout.lanes[span.lane].links is not None

    return groups_of(lists) if scope.attributes is not None and all(map(is_late, lists)) else ()


def name_without_lists(identifier: str) -> str:
    """What the table of the classes of objects of a class, of which some lists have not come, is called."""
    return f"_{identifier}_without_lists"


def said_to_come(scope: Scope, number: int) -> list[str]:
    """The locals that say of a late field, by its number, that it has come."""
    late = scope.direct.fields[number]
    groups = (group for group, lists in enumerate(scope.lists) if any(each is late.slot for each in lists))
    return [scope.has_field(late.name), *map(scope.any_lists, groups)]


def maker_without_lists(identifier: str) -> str:
    """What the function is called that makes an object of a class, of which no list has come."""
    return f"_new_{identifier}"


def print_maker(late: LateRow, identifier: str) -> str:
    """The function that makes the object of a row, of which it gets all but the lists."""
    scope = Namespace(TAKEN | {identifier})
    names = [name for name, *_ in fields_besides(late)]
    names += ["unknown_fields"] if late.slot.unknown is not None else []
    return "\n".join(
        [
            f"def {maker_without_lists(identifier)}({', '.join(map(scope.identifier, names))}):",
            f"    made = _new({identifier})",
            *(f"    made.{name} = {scope.identifier(name)}" for name in names),
            f"    _set_class(made, {name_without_lists(identifier)}[{(1 << len(groups_of(late.lists))) - 1}])",
            "    return made",
        ]
    )


def set_groups(made: str, identifier: str, groups: Sequence[tuple[str, Sequence[str]]]) -> Iterator[str]:
    """The lines that set those groups of an object's lists that it has, given what says so and what sets them, and its class."""
    yield f"{LACKS} = {(1 << len(groups)) - 1}"
    for number, (has, lines) in enumerate(groups):
        yield f"if {has}:"
        yield from (f"    {line}" for line in (f"{LACKS} -= {1 << number}", *lines))
    yield from (f"if {LACKS}:", f"    _set_class({made}, {name_without_lists(identifier)}[{LACKS}])")


def fields_besides(late: LateRow) -> Iterator[tuple[str, Field, Member]]:
    """The fields of rows that are no lists, by their attributes."""
    rows = zip(member_names(late.struct), late.struct.fields, late.slot.members, strict=True)
    yield from (each for each in rows if each[2].slot not in late.lists)


def runs_of_lists(
    block: Block, lists: Mapping[tuple[int, int], int], read: Collection[str]
) -> Iterator[tuple[tuple[Place, int] | None, Block]]:
    """The statements of a block, in runs: those that do nothing where a row lacks a group of lists, with that row and group, and others.

    ``lists`` are the groups of the fields for their numbers of elements, by lane and offset, ``read`` the locals that are printed.
    """
    row: tuple[Place, int] | None = None
    runs: list[tuple[tuple[Place, int] | None, list[Stmt]]] = []
    for stmt in block:
        match stmt:
            case If(condition, _, ()) if (count := asked_count(condition)) and (count.lane, count.offset) in lists:
                row = Place(count.lane, count.row), lists[count.lane, count.offset]
            case Var(name, _) if name not in read:
                pass
            case _:
                row = None
        if not runs or runs[-1][0] != row:
            runs.append((row, []))
        runs[-1][1].append(stmt)
    yield from ((row, tuple(run)) for row, run in runs)
