"""What encoders read of an object in place: texts, bytes and numbers by their addresses, and the message's row, which is a local variable.

A lane is *addressed* where its rows are the characters of strings, or the numbers of arrays, anywhere in the object: the start of a span is
an address then.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.generate.unit import Unit, kind_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Copy, Fill, Get, Local, Place, SetField, Stmt
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.model.layout import Number, Row, Slot, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bytes, Enum, Map, Optional, Ref, String, Struct, Type, Union

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.objects.walk import Walk


def addressed_lanes(unit: Unit, direct: frozenset[int]) -> frozenset[int]:
    """The lanes of texts, bytes and numbers that encoders copy from, and look at in no other way; ``direct`` ones are reached already."""
    kernels = [kernel for role, kernel in unit.kernels.items() if kind_of(role) in ("encode", "size")]
    return frozenset(_texts(unit)) - direct - {lane for kernel in kernels for lane in _taken_apart(kernel)}


def _texts(unit: Unit) -> Iterator[int]:
    """The lanes of bytes, of texts whose characters are bytes, and of arrays whose numbers are as rows have them."""
    pending: list[tuple[Type, Slot]] = [(Ref(unit.type), unit.layout.root)]
    seen = set[int]()
    while pending:
        type_, slot = pending.pop()
        resolved = unit.schema.resolve(type_.value if isinstance(type_, Optional) else type_)
        if isinstance(slot, Span):
            if slot.lane in seen:
                continue
            seen.add(slot.lane)
        match resolved, slot:
            case Struct(fields=fields), Row(members=members):
                pending += zip((each.type for each in fields), (member.slot for member in members), strict=True)
            case Union(cases=cases), Variant(members=members):
                pending += zip((each.type for each in cases), (member.slot for member in members), strict=True)
            case (Bytes(), Span(_, lane)) | (String("utf-8" | "octets"), Span(_, lane)):
                yield lane
            case Array(element), Span(_, lane) if isinstance(number := unit.layout.lanes[lane].element, Number):
                if number.scalar != "bool" and not isinstance(unit.schema.resolve(element), Enum):
                    yield lane
            case Array(element), Span(_, lane):
                pending.append((element, unit.layout.lanes[lane].element))
            case Map(key, value), Span(_, lane):
                pending.append((map_entry(key, value), unit.layout.lanes[lane].element))
            case Struct(), Span(_, lane):
                pending.append((type_, unit.layout.lanes[lane].element))
            case _:
                pass


def _taken_apart(kernel: Kernel) -> Iterator[int]:
    """The lanes of which a kernel reads single rows, or which it changes; of rows that are no bytes it must copy all from the first one."""
    blocks = (*kernel.bodies, *(routine.body for routine in kernel.routines))
    for stmt, _ in (each for block in blocks for each in statements(block)):
        yield from _changed(stmt)
        if isinstance(stmt, Copy) and isinstance(stmt.source, Place) and not isinstance(stmt.source.row, Local | Get):
            yield from (lane for lane in (stmt.source.lane,) if kernel.strides[lane] > 1)
        for part in (part for expr in expressions_of(stmt) for part in subexpressions(expr)):
            if isinstance(part, Get):
                yield part.place.lane


def _changed(stmt: Stmt) -> Iterator[int]:
    match stmt:
        case SetField(place) | Copy(Place() as place) | Fill(Place() as place):
            yield place.lane
        case _:
            return


def is_local(walk: Walk, hidden: frozenset[int]) -> bool:
    """Whether the row of a message that is written can be a local: nothing needs it after it is written, and no element is copied."""
    return not hidden and not walk.takes
