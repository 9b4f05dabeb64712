"""Messages with many lists and maps: where none has come, their object is of a class that says so, until somebody asks for one.

if any_lists:                                           if type(target) is not _M_without_lists:
    made.texts = texts if has_texts else []                 if len(target.texts):
    made.numbers = numbers if has_numbers else []               ...
else:                                                       if len(target.numbers):
    _set_class(made, _M_without_lists)                          ...
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.python.passes.asked import asked_count
from rosetta_jit.generate.python.passes.direct import LateRow
from rosetta_jit.generate.python.passes.late_fields import UNKNOWN
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


def class_without_lists(unit: Unit, scope: Scope, identifier: str) -> str:
    """The class of objects of which no list has come; nothing where their lists are made whatever comes."""
    lists = lists_of_message(unit)
    is_late = bool(lists) and scope.attributes is not None and all(scope.direct.late_at(each) is not None for each in lists)
    return name_without_lists(identifier) if is_late else ""


def name_without_lists(identifier: str) -> str:
    """What the class of objects of a class, of which no list has come, is called."""
    return f"_{identifier}_without_lists"


def said_to_come(scope: Scope, number: int) -> list[str]:
    """The locals that say of a late field, by its number, that it has come."""
    late = scope.direct.fields[number]
    is_list = isinstance(late.slot, Span) and late.name != UNKNOWN
    return [scope.has_field(late.name), *([scope.any_lists()] if scope.without_lists and is_list else [])]


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
            f"    _set_class(made, {name_without_lists(identifier)})",
            "    return made",
        ]
    )


def fields_besides(late: LateRow) -> Iterator[tuple[str, Field, Member]]:
    """The fields of rows that are no lists, by their attributes."""
    rows = zip(member_names(late.struct), late.struct.fields, late.slot.members, strict=True)
    yield from (each for each in rows if each[2].slot not in late.lists)


def runs_of_lists(block: Block, lists: Collection[tuple[int, int]], read: Collection[str]) -> Iterator[tuple[Place | None, Block]]:
    """The statements of a block, in runs: those that do nothing where a row has none of some lists, with that row, and others.

    ``lists`` are the fields for their numbers of elements, by lane and offset, ``read`` the locals that are printed.
    """
    row: Place | None = None
    runs: list[tuple[Place | None, list[Stmt]]] = []
    for stmt in block:
        match stmt:
            case If(condition, _, ()) if (count := asked_count(condition)) and (count.lane, count.offset) in lists:
                row = Place(count.lane, count.row)
            case Var(name, _) if name not in read:
                pass
            case _:
                row = None
        if not runs or runs[-1][0] != row:
            runs.append((row, []))
        runs[-1][1].append(stmt)
    yield from ((row, tuple(run)) for row, run in runs)
