"""Bits of a field that are set one after another are set at once, by the last statement: those that say which fields of a message are set.

In a row that was emptied before, they are all that the field has: it is written and not read. As in `hoist`, what a failed kernel leaves
in the holder is nobody's business, so that checks between the statements do not matter.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import (
    WIDTH,
    Address,
    Binary,
    Block,
    Call,
    Const,
    Copy,
    Expr,
    Fill,
    Get,
    HostCall,
    IsText,
    Nearest,
    Place,
    Scalar,
    SetField,
    Stmt,
)
from rosetta_jit.kernel.passes.reuse import EVERYWHERE, WIDEST
from rosetta_jit.kernel.rewrite import locals_in, may_return, reads_memory, with_blocks, with_bodies
from rosetta_jit.kernel.walk import changed_names, expressions_of, statements, subexpressions
from rosetta_jit.startup.dataclass import dataclass, field


@dataclass(frozen=True, slots=True)
class _Set:
    """The bits that a field has got, by the statement at a place of the block, and whether it has no others."""

    bits: int
    at: int
    is_all: bool


@dataclass(slots=True)
class _Known:
    """What is known between two statements of a block: bits that were set, and rows that were emptied, up to which byte of them."""

    sets: dict[Place, _Set] = field(default_factory=dict["Place", "_Set"])
    empty: dict[Place, int] = field(default_factory=dict["Place", int])

    def forget(self, lane: int, offset: int) -> None:
        """Somebody reads or writes such a field, of any row."""
        self.sets = {place: each for place, each in self.sets.items() if not _meets(place, lane, offset)}
        if offset == EVERYWHERE:
            self.empty = {place: size for place, size in self.empty.items() if place.lane != lane}
        else:
            self.empty = {place: min(size, offset) if place.lane == lane else size for place, size in self.empty.items()}

    def add(self, stmt: SetField, type_: Scalar, bits: int, at: int) -> tuple[SetField, int | None]:
        """What sets these bits with those before, at a place of the block, and the place of the statement that need not any more."""
        place, before = stmt.place, self.sets.get(stmt.place)
        emptied = self.empty.get(Place(place.lane, place.row), 0)
        is_all = before.is_all if before is not None else emptied >= place.offset + WIDTH[type_]
        every = Const(type_, bits if before is None else bits | before.bits)
        self.forget(place.lane, place.offset)
        self.sets[place] = _Set(int(every.value), at, is_all)
        changed = SetField(place, every if is_all else Binary("or", Get(type_, place), every))
        return changed, None if before is None else before.at


def _meets(place: Place, lane: int, offset: int) -> bool:
    return place.lane == lane and (offset == EVERYWHERE or abs(place.offset - offset) < WIDEST)


def collect(kernel: Kernel) -> Kernel:
    """The kernel with fewer statements that set bits."""
    return with_bodies(kernel, tuple(_block(body, changed_names(body)) for body in kernel.bodies))


def _block(block: Block, variables: set[str]) -> Block:
    inside = [with_blocks(stmt, lambda inner: _block(inner, variables)) for stmt in block]
    return _with_sets(inside, variables) if any(map(_sets_bits, inside)) else tuple(inside)


def _sets_bits(stmt: Stmt) -> bool:
    return isinstance(stmt, SetField) and isinstance(stmt.value, Binary) and stmt.value.op == "or"


def _with_sets(block: Sequence[Stmt], variables: set[str]) -> Block:
    result: list[Stmt | None] = []
    known = _Known()
    for stmt in block:
        kept: Stmt = stmt
        match stmt:
            case Fill(Place(lane, row, 0) as place, Const(_, size), 0) if _stays(row, variables):
                known.forget(lane, EVERYWHERE)
                known.empty[place] = int(size)
            case SetField(place, Binary("or", Get(type_, same), Const(_, bits))) if same == place and _stays(place.row, variables):
                kept, needless = known.add(stmt, type_, int(bits), len(result))
                if needless is not None:
                    result[needless] = None
            case _:
                touched = _touched(stmt)
                known = _Known() if touched is None else known
                for lane, offset in touched or ():
                    known.forget(lane, offset)
        result.append(kept)
    return tuple(stmt for stmt in result if stmt is not None)


def _stays(row: Expr, variables: set[str]) -> bool:
    """Whether it is the same row further on."""
    return not reads_memory(row) and locals_in(row).isdisjoint(variables)


def _touched(stmt: Stmt) -> set[tuple[int, int]] | None:
    """The fields that a statement reads or writes, by their lanes and offsets; None where it may be any, or where the kernel may end."""
    if may_return((stmt,)):
        return None
    found: set[tuple[int, int]] = set()
    for each, _ in statements((stmt,)):
        match each:
            case Call() | HostCall():
                return None
            case SetField(place):
                found.add((place.lane, place.offset))
            case Copy(target, source):
                found.update(_lanes(target, source))
            case Fill(target):
                found.update(_lanes(target))
            case _:
                pass
        for whole in expressions_of(each):
            for part in subexpressions(whole):
                match part:
                    case Get(_, place):
                        found.add((place.lane, place.offset))
                    case IsText(address) | Nearest(address):
                        found.update(_lanes(address))
                    case _:
                        pass
    return found


def _lanes(*addresses: Address) -> Iterator[tuple[int, int]]:
    return ((each.lane, EVERYWHERE) for each in addresses if isinstance(each, Place))
