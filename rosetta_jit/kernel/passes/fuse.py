"""Loops over the same elements, one behind the other, become one: what both read, or fill side by side, goes through the caches once.

    copy [at] = lane 1[start].0, count
    for element < count:
      sum = (sum + i64(get u8 lane 1[(start + element)].0))

becomes a loop that copies each element and adds it. Only loops are joined that LLVM makes vectors of: together they are one, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.limits import MAX_PASSED, MAX_STREAMS
from rosetta_jit.kernel.nodes import (
    WIDTH,
    Address,
    Advance,
    Block,
    Compare,
    Copy,
    Expect,
    Expr,
    Fill,
    For,
    Get,
    If,
    IsText,
    Let,
    Load,
    Local,
    Nearest,
    Place,
    Require,
    Reserve,
    Scalar,
    SetField,
    Stmt,
    Store,
    Var,
    Wire,
)
from rosetta_jit.kernel.passes.accesses import MESSAGE, Access, accesses_of, starts_at, stay_apart
from rosetta_jit.kernel.rewrite import names_in, names_read, reads_memory, substituted, with_blocks, with_bodies, with_expressions
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.kernel.traits import is_for_vectors
from rosetta_jit.kernel.walk import changed_names, flat, parts_of
from rosetta_jit.startup.dataclass import replace

PASSED = (Let, Var, Expect, Require, Reserve, Advance, SetField, Store, Fill)
"""What a loop may be run behind that has nothing to do with it. If it fails, what the loop would have left is nobody's business."""

UNSIGNED: Mapping[int, Scalar] = {1: "u8", 2: "u16", 4: "u32", 8: "u64"}


def fuse(kernel: Kernel) -> Kernel:
    """The kernel with one loop in place of some that go through the same memory."""
    return with_bodies(kernel, tuple(_body(body, kernel.strides) for body in kernel.bodies))


def _body(body: Block, strides: Sequence[int]) -> Block:
    lets = {stmt.name: stmt.value for stmt in flat(body) if type(stmt) is Let and not reads_memory(stmt.value)}

    def block(inner: Block) -> Block:
        return _block(tuple(with_blocks(stmt, block) for stmt in inner), strides, lets)

    return block(body)


def _block(block: Block, strides: Sequence[int], lets: Mapping[str, Expr]) -> Block:
    result: list[Stmt] = []
    for stmt in block:
        result.append(stmt)
        while (found := _fused(result, strides, lets)) is not None:
            number, loop = found
            result[-1] = loop
            del result[number]
    return tuple(result)


def _fused(block: Sequence[Stmt], strides: Sequence[int], lets: Mapping[str, Expr]) -> tuple[int, For] | None:
    """The last statement as one loop with an earlier one, and which that is."""
    last = block[-1]
    if not isinstance(last, For) or reads_memory(last.count) or not is_for_vectors(last.body):
        return None
    accesses = accesses_of(last, strides)
    if accesses is None:
        return None
    passed: list[Stmt] = []
    for number in range(len(block) - 2, max(-1, len(block) - 2 - MAX_PASSED), -1):
        for loop in _loops(block[number], last, accesses, strides):
            if _can_be_one(loop, last, accesses, strides, lets) and _may_wait(loop, passed, strides):
                return number, _together(loop, last)
        if not isinstance(block[number], PASSED):
            return None
        passed.append(block[number])
    return None


def _loops(stmt: Stmt, like: For, accesses: Sequence[Access], strides: Sequence[int]) -> Iterator[For]:
    """A statement as a loop of as many rounds as another one: itself, or a copy that moves an element each round."""
    match stmt:
        case For(_, count, body) if count == like.count and is_for_vectors(body):
            yield stmt
        case Copy(target, source, size):
            for each in accesses:
                is_alike = size == mul(like.count, each.width) and each.width == each.step
                if is_alike and any(starts_at(address, each, strides) for address in (target, source)):
                    yield For(like.variable, like.count, (_element(target, source, UNSIGNED[each.width], Local("i64", like.variable)),))
                    return
        case If(Compare("gt", count, zero), (Copy() as copy,), ()) if count == like.count and zero == index(0):
            yield from _loops(copy, like, accesses, strides)
        case _:
            pass


def _element(target: Address, source: Address, type_: Scalar, number: Local) -> Stmt:
    """The move of one element of a copy."""
    match source:
        case Wire(at):
            value = Load(type_, add(at, mul(number, WIDTH[type_])), "<")
        case Place(lane, row, offset):
            value = Get(type_, Place(lane, add(row, number), offset))
    match target:
        case Wire(at):
            return Store(add(at, mul(number, WIDTH[type_])), value, "<")
        case Place(lane, row, offset):
            return SetField(Place(lane, add(row, number), offset), value)


def _can_be_one(first: For, last: For, accesses: Sequence[Access], strides: Sequence[int], lets: Mapping[str, Expr]) -> bool:
    """Whether loops of as many rounds share memory, and do the same when each round of both is run at once."""
    others = accesses_of(first, strides)
    if others is None or not any(one.is_beside(other) for one, other in product(others, accesses)):
        return False
    if len({each.stream for each in (*others, *accesses)}) > MAX_STREAMS:
        return False
    if not changed_names(first.body).isdisjoint(names_read(last.body)) or not changed_names(last.body).isdisjoint(names_read(first.body)):
        return False
    return all(stay_apart(one, other, last.count, lets) for one, other in product(others, accesses))


def _may_wait(loop: For, passed: Sequence[Stmt], strides: Sequence[int]) -> bool:
    """Whether a loop does the same behind statements as before them."""
    accesses = accesses_of(loop, strides) or ()
    touches = {each.where for each in accesses}
    writes = {each.where for each in accesses if each.writes}
    written = _written(passed)
    is_apart = writes.isdisjoint(_read(passed)) and written.isdisjoint(touches)
    return is_apart and names_in(passed).isdisjoint(changed_names(loop.body))


def _read(stmts: Sequence[Stmt]) -> Iterator[int]:
    """The lanes that statements read, and the message."""
    for part in parts_of(stmts):
        match part:
            case Get(_, Place(lane)) | IsText(Place(lane)) | Nearest(Place(lane)):
                yield lane
            case Load() | IsText() | Nearest():
                yield MESSAGE
            case _:
                pass


def _written(stmts: Sequence[Stmt]) -> set[int]:
    """The lanes that statements write, and the message."""
    found: set[int] = set()
    for stmt in stmts:
        match stmt:
            case SetField(Place(lane)) | Fill(Place(lane)):
                found.add(lane)
            case Store() | Fill():
                found.add(MESSAGE)
            case _:
                pass
    return found


def _together(first: For, last: For) -> For:
    """One loop that runs a round of each."""
    same = {last.variable: Local("i64", first.variable)}

    def renamed(stmt: Stmt) -> Stmt:
        return with_expressions(stmt, lambda expr: substituted(expr, same))

    return replace(first, body=(*first.body, *map(renamed, last.body)))
