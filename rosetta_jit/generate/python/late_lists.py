"""Messages with many lists and maps: where none has come, their object is of a class that says so, until somebody asks for one.

if any_lists:                                           if type(target) is not _M_without_lists:
    made.texts = texts if has_texts else []                 if len(target.texts):
    made.numbers = numbers if has_numbers else []               ...
else:                                                       if len(target.numbers):
    _set_class(made, _M_without_lists)                          ...
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from itertools import groupby

from rosetta_jit.generate.python.asked import asked_count
from rosetta_jit.generate.python.classes import numpy_scalar
from rosetta_jit.generate.python.late_fields import UNKNOWN
from rosetta_jit.generate.python.scope import Scope
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.nodes import Block, If, Place, Stmt, Var
from rosetta_jit.kernel.terms import index
from rosetta_jit.model.layout import Row, Span
from rosetta_jit.model.types import Array, Map, Struct

PRICE_OF_ARRAY = 3
"""How many lists take as much time to make as an array of numpy."""
LEAST = 24
"""Lists of a type from which on it takes less time to make none of them."""


def lists_of(unit: Unit) -> tuple[Span, ...]:
    """The lists and maps of the message, if it has many, and nothing else that is made for each object."""
    root, slot = unit.schema.types[unit.type], unit.layout.root
    assert isinstance(root, Struct)
    found, price = list[Span](), 0
    for each, member in zip(root.fields, slot.members if isinstance(slot, Row) else (), strict=isinstance(slot, Row)):
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
    return tuple(found) if price >= LEAST else ()


def class_without_lists(unit: Unit, scope: Scope, identifier: str) -> str:
    """The class of objects of which no list has come; nothing where their lists are made whatever comes."""
    lists = lists_of(unit)
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


def runs_of_lists(block: Block, lists: Collection[Span], read: Collection[str]) -> Iterator[tuple[bool, Block]]:
    """The statements of a block, in runs: those that do nothing where a message has none of some lists, and others.

    ``read`` are the locals that are printed.
    """
    places = {Place(0, index(0), each.offset + 8) for each in lists}

    def is_of_lists(stmt: Stmt) -> bool:
        match stmt:
            case If(condition, _, ()):
                return asked_count(condition) in places
            case Var(name, _):
                return name not in read
            case _:
                return False

    for are_of_lists, run in groupby(block, is_of_lists):
        stmts = tuple(run)
        yield are_of_lists and any(isinstance(each, If) for each in stmts), stmts
