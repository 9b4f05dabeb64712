"""Positions of an encoder in its message, as sums in a normal form: two positions are the same if their sums are equal."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator
from itertools import count

from rosetta_jit.kernel.nodes import (
    WIDTH,
    Binary,
    Block,
    Call,
    Compare,
    Const,
    Copy,
    Expect,
    Expr,
    Failure,
    Fill,
    For,
    If,
    Local,
    Require,
    Return,
    SetField,
    Stmt,
    Store,
    While,
    Wire,
)
from rosetta_jit.kernel.rewrite import locals_in, with_blocks
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.startup.dataclass import dataclass, field, replace


class NotInParts(Exception):  # noqa: N818 - no error: such an encoder is printed otherwise
    """An encoder that does not write its message from front to back, or that needs rows of lanes."""


@dataclass(frozen=True, slots=True)
class Sum:
    """A constant and terms that are not known, each with its factor."""

    constant: int = 0
    terms: frozenset[tuple[Hashable, int]] = frozenset()

    def plus(self, other: Sum, times: int = 1) -> Sum:
        """The sum of it and a multiple of another."""
        found = dict(self.terms)
        for term, factor in other.terms:
            found[term] = found.get(term, 0) + times * factor
        return Sum(self.constant + times * other.constant, frozenset(each for each in found.items() if each[1]))


@dataclass(slots=True)
class Positions:
    """The values of integers so far, and the position behind all that is written; ``fresh`` numbers what is not known."""

    at: Sum = field(default_factory=Sum)
    values: dict[str, Sum] = field(default_factory=dict[str, Sum])
    variables: set[str] = field(default_factory=set[str])
    fresh: Iterator[int] = field(default_factory=count)

    def new(self) -> Sum:
        """A value of which nothing is known."""
        return Sum(0, frozenset({(next(self.fresh), 1)}))

    def sum(self, expr: Expr) -> Sum:
        """The value of an expression."""
        match expr:
            case Const(_, value):
                return Sum(int(value))
            case Local(_, name) if name in self.values:
                return self.values[name]
            case Binary("add", left, right):
                return self.sum(left).plus(self.sum(right))
            case Binary("sub", left, right):
                return self.sum(left).plus(self.sum(right), -1)
            case Binary("mul", Const(_, factor), other) | Binary("mul", other, Const(_, factor)):
                return Sum().plus(self.sum(other), int(factor))
            case _ if locals_in(expr) & self.variables:
                return self.new()
            case _:
                return Sum(0, frozenset({(expr, 1)}))

    def constant(self, name: str, value: Expr) -> None:
        """A local that does not change."""
        self.values[name] = self.sum(value)

    def variable(self, name: str, value: Expr) -> None:
        """A local that is set, perhaps again."""
        self.values[name] = self.sum(value)
        self.variables.add(name)

    def written(self, at: Expr, size: Sum) -> None:
        """Bytes at a place, which has to be the one behind what was written."""
        if self.sum(at) != self.at:
            raise NotInParts
        self.at = self.at.plus(size)

    def branch(self) -> Positions:
        """The same, which goes on by itself."""
        return replace(self, values=dict(self.values), variables=set(self.variables))

    def join(self, branches: list[Positions]) -> None:
        """Go on behind branches, one of which was taken."""
        if not branches:
            return
        first, *others = branches
        for name in [*self.values]:
            if any(each.values[name] != first.values[name] for each in others):
                held = all(each.values[name] == each.at for each in branches)
                self.values[name] = self.new()
                if held:
                    self.at = self.values[name]
                    for each in branches:
                        each.at = self.at
            else:
                self.values[name] = first.values[name]
        if any(each.at != first.at for each in others):
            raise NotInParts
        self.at = first.at

    def loop(self, changed: Iterable[str]) -> str | None:
        """Begin a round of a loop that changes variables; gives the one that says where it has got to."""
        names = [name for name in changed if name in self.values]
        holds = next((name for name in names if self.values[name] == self.at), None)
        for name in names:
            self.values[name] = self.new()
        if holds is not None:
            self.at = self.values[holds]
        return holds


def known_width(block: Block) -> int:
    """How many bytes a block writes of which the number is fixed."""
    found = 0
    for stmt in block:
        match stmt:
            case Store(_, value):
                found += WIDTH[type_of(value)]
            case Copy(Wire(), _, Const(_, size)) | Fill(Wire(), Const(_, size)):
                found += int(size)
            case For(_, Const(_, count), inner):
                found += int(count) * known_width(inner)
            case _:
                pass
    return found


def without_positions(block: Block) -> Block:
    """A block whose failures say no place: errors of encoders have none; and without checks of room: there is always some."""
    found: list[Stmt] = []
    for stmt in block:
        match stmt:
            case Require():
                pass
            case Expect(condition, Failure(site, _, indices)):
                found.append(Expect(condition, Failure(site, index(0), indices)))
            case _:
                found.append(with_blocks(stmt, without_positions))
    return tuple(found)


def without_places(block: Block) -> Block:
    """A block in which nothing is read for the sake of places in the message alone."""
    found: list[Stmt] = []
    for stmt in block:
        match stmt:
            case Store(_, value, order):
                found.append(Store(index(0), value, order))
            case Copy(Wire(), source, _):
                found.append(Copy(Wire(index(0)), source, index(0)))
            case If(Compare("gt", _, Const(_, 0)), (Copy(Wire()) as copy,), ()):
                found += without_places((copy,))  # a copy of nothing does nothing
            case Fill(Wire(), size, byte):
                found.append(Fill(Wire(index(0)), size, byte))
            case Return(_, registers):
                found.append(Return(index(0), registers))
            case SetField(place, _):
                found.append(SetField(place, index(0)))  # where a message of a type that contains itself begins
            case Call():
                found.append(replace(stmt, arguments=(index(0), *stmt.arguments[1:])))
            case While(condition, inner, _, _):
                found.append(While(condition, without_places(inner), (), index(0)))
            case _:
                found.append(with_blocks(stmt, without_places))
    return tuple(found)
