"""A decoder that sets the elements of lists where the object has them: their rows are counted from the first one of each list.

It must open a list before it sets elements of it, in the same block or around it, and do nothing else with their rows. What the message
itself has must be set whatever the message is: nothing may be left of another one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import TypeGuard

from rosetta_jit.generate.c.holder.lanes import Straight
from rosetta_jit.generate.c.printing.straight import size_left
from rosetta_jit.generate.passes.aligned import as_printed
from rosetta_jit.generate.passes.cleared import settled
from rosetta_jit.generate.passes.positions import bound_in, difference
from rosetta_jit.generate.passes.reachable import read_names
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import (
    Address,
    Advance,
    Assign,
    Binary,
    Block,
    Const,
    Copy,
    Expr,
    For,
    Get,
    HostCall,
    If,
    Let,
    Load,
    Place,
    Require,
    Reserve,
    SetField,
    Stmt,
    Switch,
    Used,
    Var,
    Wire,
)
from rosetta_jit.kernel.rewrite import locals_in, with_blocks, with_bodies
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import expressions_of, extents_of, statements, subexpressions
from rosetta_jit.startup.dataclass import replace

Fields = Mapping[tuple[int, int], Straight]
FEW = 1024
"""As many elements of an array of a fixed count, outside of loops, as are never too many."""


def in_place(kernel: Kernel, fields: Fields, subject: int = 0) -> Kernel | None:
    """The decoder that sets these fields in place, those of all elements and the lists themselves; None if it cannot.

    Its bodies are for the message, or for a row of another lane, their ``subject``: then they may set no other field of that.
    """
    lanes = frozenset(each.lane for each in fields.values() if each.lane) | ({subject} - {0})
    routines = (stmt for routine in kernel.routines for stmt, _ in statements(routine.body))
    if any(lanes & (_used(stmt) | _set(stmt)) for stmt in routines):
        return None
    own = {offset for lane, offset in fields if lane == subject}
    if not all(own <= {offset for offset, _ in settled(body, subject)} for body in kernel.bodies):
        return None
    bodies = [_Body(fields, lanes, subject, body) for body in kernel.bodies]
    found = tuple(each.block(body, {}) for each, body in zip(bodies, kernel.bodies, strict=True))
    return with_bodies(kernel, found) if all(each.is_in_place for each in bodies) else None


def without_asking(kernel: Kernel, lanes: frozenset[int]) -> Kernel:
    """A decoder that asks for no room for lists whose elements are known to be in the message, or few: these are never too many."""

    def kept(block: Block, sure: int = FEW) -> Block:
        """A block that is done for an element of so many bytes, which are there, or once, with a few elements that need none."""
        there, found = dict[Expr, int](), list[Stmt]()
        for stmt in block:
            bound = bound_in(stmt)
            there = {count: size for count, size in there.items() if bound.isdisjoint(locals_in(count))} | _made_sure(stmt)
            if isinstance(stmt, Reserve) and stmt.lane in lanes and (stmt.count in there or _is_within(stmt.count, sure)):
                continue
            each = there.get(stmt.count, 0) if isinstance(stmt, For) else sure if isinstance(stmt, If | Switch) else 0
            found.append(with_blocks(stmt, lambda inner, each=each: kept(inner, each)))
        return tuple(found)

    return with_bodies(kernel, tuple(map(kept, kernel.bodies)))


def without_counting(kernel: Kernel, given: Collection[int]) -> Kernel:
    """A decoder that does not count the rows of lanes which it asks nothing about; what ``given`` lanes count is how long they become."""
    elsewhere = {lane for routine in kernel.routines for lane in _asked(routine.body)}

    def uncounted(body: Block) -> Block:
        asked = elsewhere.union(_asked(body), given)

        def kept(block: Block) -> Block:
            return tuple(with_blocks(stmt, kept) for stmt in block if not (isinstance(stmt, Advance) and stmt.lane not in asked))

        return kept(body)

    return with_bodies(kernel, tuple(map(uncounted, kernel.bodies)))


def _asked(block: Block) -> Iterator[int]:
    """The lanes of which anything needs to know how many rows are in use."""
    read = read_names(as_printed(block))
    for stmt, _ in statements(block):
        if isinstance(stmt, Reserve):
            yield stmt.lane
        if not (isinstance(stmt, Let | Var | Assign) and stmt.name not in read):
            yield from (part.lane for expr in expressions_of(stmt) for part in subexpressions(expr) if isinstance(part, Used))


def _made_sure(stmt: Stmt) -> dict[Expr, int]:
    """How many elements a statement makes sure of in the message, and how many bytes each has."""
    match stmt:
        case Require(_, Binary("mul", count, Const(_, int(size)))) if size > 0:
            return {count: size}
        case Require(_, count):
            return {count: 1}
        case _:
            return {}


def _is_within(count: Expr, size: int) -> bool:
    """Whether so many elements may lie in so many bytes."""
    return isinstance(count, Const) and count.value <= size


def _used(stmt: Stmt) -> set[int]:
    """The lanes whose rows a statement uses, but for the field that it sets."""
    named = [] if isinstance(stmt, SetField) else [getattr(stmt, name, None) for name in ("target", "source")]
    named += [each.address for each in extents_of(stmt)] if isinstance(stmt, HostCall) else []
    for part in (part for expr in expressions_of(stmt) for part in subexpressions(expr)):
        named += [getattr(part, name, None) for name in ("place", "address")]
    return {each.lane for each in named if isinstance(each, Place)}


def _read_from_message(stmt: Stmt, before: Stmt | None) -> Stmt:
    """A local that is a number which has just been set: it is read where that was, as in LCM the count of a list that follows."""
    match stmt, before:
        case Let(_, Get(type_, place)), SetField(same, Load(read) as number) if place == same and type_ == read:
            return replace(stmt, value=number)
        case _:
            return stmt


def _set(stmt: Stmt) -> set[int]:
    return {stmt.place.lane} if isinstance(stmt, SetField) else set()


class _Body:
    """One body of a decoder being rewritten: the fields that it has set so far, and whether all is as it must be."""

    def __init__(self, fields: Fields, lanes: frozenset[int], subject: int, body: Block) -> None:
        self._fields, self._lanes, self._subject = fields, lanes, subject
        changing = (stmt for stmt, _ in statements(body) if isinstance(stmt, Assign | For))
        self._changed = frozenset(each.name if isinstance(each, Assign) else each.variable for each in changing)
        self._seen, self._fails = set[tuple[int, int]](), False

    @property
    def is_in_place(self) -> bool:
        return not self._fails and self._seen == set(self._fields)

    def block(self, block: Block, opened: dict[int, Expr]) -> Block:
        """A block; ``opened`` are the lists that are open in it, and the first row of each."""
        rest, found = iter(map(_read_from_message, block, (None, *block))), list[Stmt]()
        for stmt in rest:
            if isinstance(stmt, Copy) and self._is_copied(stmt.target) and isinstance(stmt.source, Wire):
                found.append(replace(stmt, target=self._placed(stmt.target, opened)))
                continue
            self._fails |= bool(self._lanes & _used(stmt))
            if isinstance(stmt, SetField):
                found += self._field(stmt, rest, opened)
            else:
                found.append(with_blocks(stmt, lambda inner: self.block(inner, dict(opened))))
        return tuple(found)

    def _is_copied(self, target: Address) -> TypeGuard[Place]:
        """Whether numbers are copied to their place."""
        straight = self._fields.get((target.lane, target.offset)) if isinstance(target, Place) else None
        if straight is None or not straight.copied or not isinstance(target, Place):
            return False
        self._seen.add((target.lane, target.offset))
        return True

    def _field(self, stmt: SetField, rest: Iterator[Stmt], opened: dict[int, Expr]) -> tuple[Stmt, ...]:
        """The statement, and the one behind it where both set a span."""
        lane, offset = stmt.place.lane, stmt.place.offset
        straight = self._fields.get((lane, offset))
        if straight is None:
            self._fails |= lane in self._lanes
            return (stmt,)
        self._seen.add((lane, offset))
        place = self._placed(stmt.place, opened)
        if not straight.is_span:
            return (replace(stmt, place=place),)
        count = next(rest, None)
        if not isinstance(count, SetField) or count.place != Place(lane, stmt.place.row, offset + 8) or self._lanes & _used(count):
            self._fails = True
            return (stmt,)
        start = stmt.value
        if straight.text:
            self._fails |= size_left(count.value) is None
        else:
            self._fails |= bool(locals_in(start) & self._changed)
            opened[straight.lane], start = start, index(0)
        return replace(stmt, place=place, value=start), replace(count, place=replace(place, offset=offset + 8))

    def _placed(self, place: Place, opened: dict[int, Expr]) -> Place:
        """A place of an opened list, by the number of its element."""
        if place.lane == self._subject:
            return place
        number = difference(place.row, opened[place.lane]) if place.lane in opened else None
        self._fails |= number is None
        return place if number is None else replace(place, row=number)
