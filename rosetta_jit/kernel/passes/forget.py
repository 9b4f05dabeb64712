"""Stores to hidden lanes that nothing reads go: the bytes of fields that no rule reads stay in the message.

Hidden lanes hold what a message was staged in, and end with the message. Of one that a body neither writes nor asks anything about, it
needs no rows either.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from functools import partial

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import (
    WIDTH,
    Address,
    Advance,
    Block,
    Capacity,
    Copy,
    Fill,
    Get,
    HostCall,
    IsText,
    Nearest,
    Place,
    Reserve,
    SetField,
    Stmt,
    Used,
)
from rosetta_jit.kernel.rewrite import with_blocks, with_bodies
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class _Read:
    """What is asked of hidden lanes: some are read as bytes, of others fields, by the offsets of their bytes within a row; ``named`` are
    all that anything but Reserve and Advance names.
    """

    hidden: range
    whole: set[int]
    fields: defaultdict[int, set[int]]
    named: set[int]

    def is_forgotten(self, stmt: Stmt) -> bool:
        """Whether a statement writes what nobody reads, or counts rows that nobody asks for."""
        match stmt:
            case SetField(Place(lane, _, offset), value) if lane in self.hidden and lane not in self.whole:
                return self.fields[lane].isdisjoint(range(offset, offset + WIDTH[type_of(value)]))
            case Copy(Place(lane)) | Fill(Place(lane)):
                return lane in self.hidden and lane not in self.whole and not self.fields[lane]
            case Reserve(lane) | Advance(lane):
                return lane in self.hidden and lane not in self.named
            case _:
                return False


def forget(kernel: Kernel) -> Kernel:
    """The kernel without what it writes and never reads. What a size kernel writes the encoder reads, which runs on the same lanes."""
    if kernel.direction == "size":
        return kernel
    detail_lanes = {site.detail_lane for site in kernel.sites if site.detail_lane is not None}
    shared = [stmt for routine in kernel.routines for stmt, _ in statements(routine.body)]

    def block(body: Block) -> Block:
        every = [*shared, *(stmt for stmt, _ in statements(body))]
        return _block(body, _read(range(kernel.lanes, len(kernel.strides)), detail_lanes, every))

    return with_bodies(kernel, tuple(map(block, kernel.bodies)))


def _block(block: Block, read: _Read) -> Block:
    return tuple(with_blocks(stmt, partial(_block, read=read)) for stmt in block if not read.is_forgotten(stmt))


def _read(hidden: range, detail_lanes: set[int], every: Iterable[Stmt]) -> _Read:
    found = _Read(hidden, set(detail_lanes), defaultdict(set), set(detail_lanes))
    for stmt in every:
        sources, targets = _addresses(stmt)
        found.whole.update(sources)
        found.named.update(sources, targets)
        for expr in expressions_of(stmt):
            for part in subexpressions(expr):
                match part:
                    case Get(type_, Place(lane, _, offset)):
                        found.fields[lane].update(range(offset, offset + WIDTH[type_]))
                        found.named.add(lane)
                    case IsText(Place(lane)) | Nearest(Place(lane)):
                        found.whole.add(lane)
                        found.named.add(lane)
                    case Used(lane) | Capacity(lane):
                        found.named.add(lane)
                    case _:
                        pass
    return found


def _addresses(stmt: Stmt) -> tuple[list[int], list[int]]:
    """Lanes that a statement reads bytes of, besides its expressions, and those that it writes to."""
    match stmt:
        case Copy(target, source):
            return _lanes(source), _lanes(target)
        case Fill(target) | SetField(target):
            return [], _lanes(target)
        case HostCall():
            target = [] if stmt.target is None else _lanes(stmt.target.address)
            return _lanes(*(extent.address for extent in stmt.inputs)), target
        case _:
            return [], []


def _lanes(*addresses: Address) -> list[int]:
    return [each.lane for each in addresses if isinstance(each, Place)]
