"""Large blocks that are alike, wherever in a body they stand: messages of one type, mostly, that are several fields of others."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from typing import NamedTuple

from rosetta_jit.backends.llvm import alike_names
from rosetta_jit.backends.llvm.alike import Found, Place, Shared
from rosetta_jit.backends.llvm.outline import Outline, Slot
from rosetta_jit.backends.llvm.rounds import rounds_of
from rosetta_jit.backends.llvm.stretches import joined, tabled
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import (
    Advance,
    Block,
    Call,
    Expect,
    HostCall,
    Local,
    Require,
    Reserve,
    Return,
    Scalar,
    SetField,
    Stmt,
    Switch,
    Used,
    While,
)
from rosetta_jit.kernel.walk import NESTED, blocks_of, flat, parts_of, subexpressions

LEAST = 32
"""Statements of a block from which on places share it: to call a function for less costs more than it saves."""

ALONE = (Return, HostCall)
"""Statements of which no shared block has one: the body ends there, or they are like no others."""


class _Sized(NamedTuple):
    """A block, how many statements it has, and a number that it has in common with those whose statements look the same at first sight."""

    size: int
    look: int
    block: Block


class _Instance(NamedTuple):
    """One of some blocks that may be alike, and its slots."""

    block: Block
    slots: list[Slot]


def with_places(found: Found, kernel: Kernel, body: Block) -> Found:
    """What repeats itself in a body, and the blocks outside it that several places share."""
    taken = {*found.blocks}
    for each in flat(body):
        if isinstance(each, Switch):
            known = {number for cases in found.cases(each) for number in cases.numbers}
            taken.update(id(block) for number, block in each.cases if number in known)
    return Found(dict(found.blocks) | {number: (place,) for number, place in places(kernel, body, taken)}, found.switches)


def places(kernel: Kernel, body: Block, taken: Container[int]) -> Iterator[tuple[int, Place]]:
    """The blocks inside a body that several places share, by their identity: the largest ones, outside those that are ``taken``."""
    sized: list[_Sized] = []
    _measure(body, kernel.strides, taken, sized)
    groups = dict[tuple[int, int], list[Block]]()
    for size, look, block in sorted(sized, key=lambda each: -each.size):
        groups.setdefault((size, look), []).append(block)
    inside = set[int]()
    for group in groups.values():
        blocks = [each for each in group if id(each) not in inside]
        for alike in _alike(kernel, blocks) if len(blocks) > 1 else ():
            for block, place in _places(kernel, alike):
                yield id(block), place
                inside.update(id(inner) for stmt in flat(block) for inner in blocks_of(stmt))


def _measure(block: Block, strides: Sequence[int], taken: Container[int], found: list[_Sized]) -> tuple[int, int]:
    """The statements of a block, and a number of their looks; all large blocks inside that may be shared are ``found``."""
    size, looks = len(block), list[object]()
    for stmt in block:
        looks.append(_look(stmt, strides))
        if type(stmt) not in NESTED:
            continue
        is_whole = not isinstance(stmt, While) or rounds_of(stmt) is None  # else it is printed in parts
        for inner in blocks_of(stmt):
            if id(inner) in taken:
                continue
            count, number = _measure(inner, strides, taken, found)
            size += count
            looks.append(number)
            if is_whole and count >= LEAST:
                found.append(_Sized(count, number, inner))
    return size, hash(tuple(looks))


def _look(stmt: Stmt, strides: Sequence[int]) -> object:
    """What statements of one shape have in common and shows at once: a message in a list has indices and rows that another one has not."""
    match stmt:
        case SetField(place, _):
            return SetField, strides[place.lane]
        case Require(_, _, failure) | Expect(_, failure):
            return type(stmt), len(failure.indices)
        case Call():
            rows = [strides[part.lane] for each in stmt.indices for part in subexpressions(each) if isinstance(part, Used)]
            return stmt.routine, len(stmt.indices), *rows
        case _:
            return type(stmt)


def _alike(kernel: Kernel, blocks: Sequence[Block]) -> list[list[_Instance]]:
    """Those of some blocks that have the same shape, together."""
    groups = dict[object, list[_Instance]]()
    for block in blocks:
        if any(isinstance(each, ALONE) for each in flat(block)):
            continue
        outlines = [Outline(each, kernel.strides, kernel.lanes) for each in block]
        groups.setdefault(tuple([each.shape for each in outlines]), []).append(_Instance(block, joined(each.slots for each in outlines)))
    return [group for group in groups.values() if len(group) > 1]


def _places(kernel: Kernel, group: Sequence[_Instance]) -> list[tuple[Block, Place]]:
    """The places of some blocks that are alike; none where they cannot be one function.

    A lane of the last one may stand for two where that of the first one does not: it is printed then.
    """
    return _printed_last(kernel, group) or _printed_last(kernel, group[::-1])


def _printed_last(kernel: Kernel, group: Sequence[_Instance]) -> list[tuple[Block, Place]]:
    """The same, if the last one is what is printed."""
    rows = [each.slots for each in group]
    names = alike_names.names_around(rows)
    series = None if names is None else tabled(group[-1].block, rows, ())
    if series is None or names is None:
        return []
    every = flat(group[-1].block)
    assigned = {slot.name for slot in rows[-1] if slot.kind == "assigned"}
    types: dict[str, Scalar] = {slot.name: slot.type for slot in rows[-1] if slot.kind == "read"}
    around = names[-1]
    shared = Shared(
        series,
        tuple(Local(types[name], name) for name in around if name not in assigned),
        tuple(name for name in around if name in assigned),
        _hidden(kernel, every),
    )
    return [(each.block, Place(shared, row, here)) for row, (each, here) in enumerate(zip(group, names, strict=True))]


def _hidden(kernel: Kernel, every: Sequence[Stmt]) -> tuple[int, ...]:
    """The hidden lanes whose used lengths some statements read or change."""
    read = (each.lane for each in parts_of(every) if isinstance(each, Used))
    changed = (each.lane for each in every if isinstance(each, Reserve | Advance))
    return tuple(sorted({lane for lane in (*read, *changed) if lane >= kernel.lanes}))
