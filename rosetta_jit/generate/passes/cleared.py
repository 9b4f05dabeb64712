"""Whether the row of a message has to be cleared before its fields are set: a decoder that sets all of them does without."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Fill, Get, Place, Return, SetField, Stmt
from rosetta_jit.kernel.rewrite import with_bodies
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.model.layout import Number, Row, Slot, Span
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.generate.unit import Unit


def slots_of(slot: Slot) -> Iterator[Slot]:
    """The numbers and spans of a row."""
    yield slot
    if isinstance(slot, Row):
        for member in slot.members:
            yield from slots_of(member.slot)
        if slot.unknown is not None:
            yield slot.unknown


def offsets_of(slot: Slot) -> list[int] | None:
    """Where the scalars of a row lie; None where not all of them are there in each."""
    found: list[int] = []
    for each in slots_of(slot):
        match each:
            case Number(offset, _):
                found.append(offset)
            case Span(offset, _):
                found += [offset, offset + 8]
            case Row(_, _, 0, _):
                pass
            case _:
                return None
    return found


def settled(block: Block, lane: int = 0) -> frozenset[tuple[int, str]]:
    """The fields of the message's row that a body sets whatever the message is, before it reads them: by offset and type.

    Or those of the one row of another ``lane`` that a block is for.
    """
    found, read = set[tuple[int, str]](), set[int]()
    for stmt in block:
        for each, _ in statements((stmt,)):
            parts = (part for expr in expressions_of(each) for part in subexpressions(expr))
            read |= {part.place.offset for part in parts if isinstance(part, Get) and part.place.lane == lane}
            if isinstance(each, Return) and each is not block[-1]:
                return frozenset(found)
        if isinstance(stmt, SetField) and stmt.place.lane == lane and stmt.place.offset not in read:
            found.add((stmt.place.offset, type_of(stmt.value)))
    return frozenset(found)


def clears(stmt: Stmt) -> bool:
    """Whether a statement sets the bytes of the message's row to 0."""
    return isinstance(stmt, Fill) and stmt.target == Place(0, index(0)) and stmt.byte == 0


def without_clearing(unit: Unit, unused: Collection[int] = ()) -> Unit:
    """A unit whose decoders do not clear the message's row where they set all of its fields anyway, but for those at ``unused`` offsets.

    After a failure whoever calls them clears it. Decoders of several wires leave what others have set, and stay as they are.
    """
    offsets = offsets_of(unit.layout.root)
    if offsets is None:
        return unit
    wanted = frozenset(offsets).difference(unused)
    decoders = [role for role in ("decode", "borrow") if role in unit.kernels]
    return replace(unit, kernels={**unit.kernels, **{role: _kernel(unit.kernels[role], wanted) for role in decoders}})


def _kernel(kernel: Kernel, wanted: frozenset[int]) -> Kernel:
    return with_bodies(kernel, tuple(_body(body, wanted) for body in kernel.bodies))


def _body(body: Block, wanted: frozenset[int]) -> Block:
    found = frozenset(offset for offset, _ in settled(body))
    return tuple(stmt for stmt in body if not clears(stmt)) if wanted <= found else body
