"""Sequences that an encoder leaves out where they are empty: it asks for that first, and takes them out of the object where they are not.

let start = get .names.start                if (get .names.count > 0):              if len(target.names):
let count = get .names.count                  let start = get .names.start              names = target.names
for i < count:                                let count = get .names.count              for element in names:
  ...                                         for i < count:                                ...
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from rosetta_jit.generate.python.passes.defaults import reads_of
from rosetta_jit.generate.python.passes.presence import places_read
from rosetta_jit.generate.python.passes.slots import spans_of
from rosetta_jit.kernel.nodes import Block, Compare, Const, Expr, For, Get, If, Let, Local, Place, Stmt
from rosetta_jit.kernel.rewrite import with_blocks
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import blocks_of, expressions_of
from rosetta_jit.model.layout import Layout


def counts_asked_first(block: Block, layout: Layout) -> Block:
    """A body that asks whether a sequence is empty before it does anything else with it, where nothing else needs its length."""
    return _asked_first(block, layout, reads_of(block))


def _asked_first(block: Block, layout: Layout, reads: Counter[str]) -> Block:
    found: list[Stmt] = []
    for old in block:
        stmt = with_blocks(old, lambda inner: _asked_first(inner, layout, reads))
        name, then = _for_any(stmt)
        let, own = next((each for each in found if isinstance(each, Let) and each.name == name), None), reads_of((old,))
        if let is None or not _is_count(let.value, layout) or own[let.name] != reads[let.name]:
            found.append(stmt)
            continue
        assert isinstance(let.value, Get)
        lets = [each for each in found if each is let or _is_start_of(each, let.value.place, own, reads)]
        found = [each for each in found if each not in lets]
        kept = (each for each in lets if each is not let or reads_of(then)[let.name])
        found.append(If(Compare("gt", let.value, index(0)), (*kept, *then), ()))
    return tuple(found)


def _for_any(stmt: Stmt) -> tuple[str, Block]:
    """The local for a count, and what a statement does if that is not 0: it does nothing else."""
    match stmt:
        case If(Compare("gt" | "ne", Local("i64", name), Const(_, 0)), then, ()):
            return name, then
        case For(_, Local("i64", name), _):
            return name, (stmt,)
        case _:
            return "", ()


def _is_count(value: Expr, layout: Layout) -> bool:
    """Whether a value is the number of elements of a sequence."""
    match value:
        case Get("i64", Place(lane, _, offset)) if lane < len(layout.lanes):
            return offset - 8 in spans_of(layout, lane)
        case _:
            return False


def _is_start_of(stmt: Stmt, count: Place, own: Counter[str], reads: Counter[str]) -> bool:
    """Whether a statement says where the sequence of a count starts, which nothing reads but those of which ``own`` are the reads."""
    match stmt:
        case Let(name, Get(_, Place(lane, row, offset))):
            return (lane, row, offset + 8) == (count.lane, count.row, count.offset) and own[name] == reads[name]
        case _:
            return False


def asked_count(condition: Expr) -> Place | None:
    """The number of elements, or another integer, of which a condition says that it is not 0."""
    match condition:
        case Compare("gt" | "ne", Get("i64", place), Const(_, 0)):
            return place
        case _:
            return None


def taken_late(block: Block) -> frozenset[tuple[int, int]]:
    """The sequences of rows, by lane and offset, with which a body has to do nowhere but where it has asked whether they have elements."""
    asked, elsewhere = set[tuple[int, int]](), set[tuple[int, int]]()
    for place, is_asked, is_known in _counts(block, frozenset()):
        if is_asked:
            asked.add((place.lane, place.offset - 8))
        elif not is_known:
            elsewhere |= {(place.lane, place.offset), (place.lane, place.offset - 8)}
    return frozenset(asked - elsewhere)


def _counts(block: Block, known: frozenset[Place]) -> Iterator[tuple[Place, bool, bool]]:
    """The fields that a block reads, with whether it asks if they are 0, and whether it has: ``known`` are those not 0."""
    for stmt in block:
        asked = asked_count(stmt.condition) if isinstance(stmt, If) else None
        for place in () if asked is not None else (place for expr in expressions_of(stmt) for place in places_read(expr)):
            yield place, False, bool({place, Place(place.lane, place.row, place.offset + 8)} & known)
        if asked is not None:
            yield asked, True, False
            yield from _counts(stmt.then, known | {asked}) if isinstance(stmt, If) else ()
            yield from _counts(stmt.otherwise, known) if isinstance(stmt, If) else ()
            continue
        for inner in blocks_of(stmt):
            yield from _counts(inner, known)
