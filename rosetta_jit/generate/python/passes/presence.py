"""What an encoder's kernel asks of an object: whether a field is there, which case of a union it has, how long a message within another is.

presence    ((get u64 lane 0[0].0 & 4) != 0)        a field that may be None is not
case        (get i64 lane 0[0].88 == 2)             of a union
length      let size = get i64 lane 14[n].0         measured before; behind the message:  expect ((at - begin) == size)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeGuard

from rosetta_jit.kernel.ir import Site
from rosetta_jit.kernel.nodes import (
    Assign,
    Binary,
    Block,
    Compare,
    Const,
    Expect,
    Expr,
    Get,
    If,
    Let,
    Local,
    Place,
    Stmt,
    Var,
)
from rosetta_jit.kernel.rewrite import locals_in, with_blocks
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions

CHANGED = "the holder changed while it was written"


def bit_tested(condition: Expr, words: Mapping[str, Place]) -> tuple[Place, int] | None:
    """The presence word and the bit that a condition asks for; ``words`` are the fields that locals are."""
    match condition:
        case Compare("ne", Binary("and", word, Const(_, bit)), Const(_, 0)):
            place = _place(word, words)
            return None if place is None else (place, int(bit))
        case _:
            return None


def case_tested(condition: Expr, words: Mapping[str, Place]) -> tuple[Place, int] | None:
    """The discriminator and the number of the case that a condition asks for."""
    match condition:
        case Compare("eq", which, Const(_, number)):
            place = _place(which, words)
            return None if place is None else (place, int(number))
        case _:
            return None


def words_tested(block: Block) -> frozenset[str]:
    """The locals for presence words of which a block asks for one bit each time: objects say by themselves what they have."""
    words = {stmt.name: stmt.value.place for stmt, _ in statements(block) if isinstance(stmt, Let) and _is_word(stmt.value)}
    found = set(words)
    for stmt, _ in statements(block):
        for expr in expressions_of(stmt):
            tested = bit_tested(expr, words) if isinstance(stmt, If | Expect) else None
            if tested is None or tested[1].bit_count() != 1:
                found -= locals_in(expr)
    return frozenset(found)


def _is_word(value: Expr) -> TypeGuard[Get]:
    return isinstance(value, Get) and value.type == "u64"


def _place(value: Expr, words: Mapping[str, Place]) -> Place | None:
    match value:
        case Get(_, place):
            return place
        case Local(_, name):
            return words.get(name)
        case _:
            return None


def places_read(expr: Expr) -> Iterator[Place]:
    """The fields whose values an expression reads: not those of which it asks for one bit."""
    if (tested := bit_tested(expr, {})) is not None and tested[1].bit_count() == 1:
        yield from (place for part in subexpressions(tested[0].row) for place in _read(part))
        return
    for part in subexpressions(expr):
        yield from _read(part)


def _read(part: Expr) -> Iterator[Place]:
    if isinstance(part, Get):
        yield part.place


def without_lengths(block: Block, sites: Sequence[Site], hidden: int) -> Block:
    """A block in which lengths of messages are measured again: without the numbers of lengths in the lanes from ``hidden`` on.

    Behind a message an Expect is left that compares its length with itself.
    """
    lets = [stmt for stmt, _ in statements(block) if isinstance(stmt, Let | Var | Assign)]
    measured = {each.name: each.value.place.row for each in lets if isinstance(each.value, Get) and each.value.place.lane >= hidden}
    numbers = {name for row in measured.values() for name in locals_in(row)}
    numbers |= {name for each in lets if each.name in numbers for name in locals_in(each.value)}
    return _without(block, sites, frozenset(measured), frozenset(numbers))


def is_behind_message(stmt: Expect) -> bool:
    """Whether a statement says no more than that a message within another is complete."""
    match stmt.condition:
        case Compare("eq", Local(_, name), Local(_, same)):
            return name == same
        case _:
            return False


def _without(block: Block, sites: Sequence[Site], measured: frozenset[str], numbers: frozenset[str]) -> Block:
    found: list[Stmt] = []
    for stmt in block:
        match stmt:
            case Expect(Compare("eq", _, Local(_, name) as size), failure) if name in measured:
                found.append(Expect(Compare("eq", size, size), failure))
            case Expect(_, failure) if sites[failure.site].detail == CHANGED:
                pass
            case Let(name, _) | Var(name, _) | Assign(name, _) if name in numbers:
                pass
            case _:
                found.append(with_blocks(stmt, lambda inner: _without(inner, sites, measured, numbers)))
    return tuple(found)
