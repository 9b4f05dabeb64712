"""Initial values move into the loop that fills the rows: each round writes those of its own row, without the ones that it overwrites."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import (
    Address,
    Binary,
    Block,
    Call,
    Copy,
    Expr,
    Fill,
    For,
    Get,
    HostCall,
    IsText,
    Local,
    Place,
    SetField,
    Stmt,
)
from rosetta_jit.kernel.rewrite import locals_in, reads_memory, with_blocks, with_bodies
from rosetta_jit.kernel.terms import index, mul
from rosetta_jit.kernel.walk import changed_names, expressions_of, statements, subexpressions
from rosetta_jit.startup.dataclass import replace


def sink(kernel: Kernel) -> Kernel:
    """The kernel with rows emptied in the loops that set them."""

    def block(body: Block) -> Block:
        return _block([with_blocks(stmt, block) for stmt in body], kernel.strides)

    return with_bodies(kernel, tuple(map(block, kernel.bodies)))


def _block(block: list[Stmt], strides: tuple[int, ...]) -> Block:
    for number, stmt in enumerate(block):
        match stmt:
            case Fill(Place(lane, start, 0), size):
                behind = next((later for later in range(number + 1, len(block)) if _touches(block[later], lane)), None)
                loop = block[behind] if behind is not None else None
                if behind is not None and isinstance(loop, For) and _sets_each(loop, lane, start, size, strides[lane]):
                    row = Binary("add", start, Local("i64", loop.variable))
                    emptied = Fill(Place(lane, row), index(strides[lane]), stmt.byte)
                    block[behind] = replace(loop, body=(emptied, *loop.body))
                    return _block(block[:number] + block[number + 1 :], strides)
            case _:
                pass
    return tuple(block)


def _sets_each(loop: For, lane: int, start: Expr, size: Expr, stride: int) -> bool:
    """Whether the rounds of a loop go through the rows that were emptied, one row each."""
    if size != mul(loop.count, stride) or reads_memory(start) or reads_memory(loop.count):
        return False
    if not changed_names(loop.body).isdisjoint(locals_in(start) | locals_in(loop.count)):
        return False
    row = Binary("add", start, Local("i64", loop.variable))
    rows = [each for stmt, _ in statements(loop.body) for each in _rows(stmt, lane)]
    return bool(rows) and all(each == row for each in rows)


def _touches(stmt: Stmt, lane: int) -> bool:
    return any(True for each, _ in statements((stmt,)) for _ in _rows(each, lane))


def _rows(stmt: Stmt, lane: int) -> Iterator[Expr | None]:
    """The rows of a lane that a statement itself names; None for what it may do besides."""
    match stmt:
        case Call() | HostCall():
            yield None
        case SetField(place):
            yield from _row(place, lane)
        case Copy(target, source, _):
            yield from (None for address in (target, source) for _ in _row(address, lane))
        case Fill(target):
            yield from (None for _ in _row(target, lane))
        case _:
            pass
    for whole in expressions_of(stmt):
        for part in subexpressions(whole):
            match part:
                case Get(_, place):
                    yield from _row(place, lane)
                case IsText(address, _):
                    yield from (None for _ in _row(address, lane))
                case _:
                    pass


def _row(address: Address, lane: int) -> Iterator[Expr]:
    if isinstance(address, Place) and address.lane == lane:
        yield address.row
