"""Rows within rows, visited depth first by one loop: the statements that go from row to row, as lowering writes and as backends read them.

    set lane 2[start].72 = here             entering: the first of some rows keeps the row around it,
    set lane 2[start].80 = 3                the state that goes on there,
    set lane 2[start].88 = (count + -1)     and how many neighbours follow
    depth = (depth + 1)
    here = start
    at = (at + 8)                           going: to a place in the message, and a state of the loop
    state = 2

A backend that calls functions in place of the loop asks `entered`, `gone` and `goes_back`: what they know stands beside what writes it.
"""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.kernel.nodes import Assign, Binary, Block, Compare, Const, Expr, Get, If, Let, Local, Place, SetField, Stmt, Var
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Stack:
    """The variables of the loop: the place in the message, the state, the row at hand, and how many rows are around it."""

    at: Local
    state: Local
    row: Local
    depth: Local


@dataclass(frozen=True, slots=True)
class Entered:
    """Rows of a lane, ``count`` of them from ``start`` on, with the depth around them, and the state behind them."""

    lane: int
    start: Expr
    count: Expr
    depth: Expr
    then: int


def going(stack: Stack, at: Expr, state: int) -> Block:
    """On to another state."""
    return Assign(stack.at.name, at), Assign(stack.state.name, index(state))


def gone(stack: Stack, block: Sequence[Stmt]) -> tuple[Expr, int] | None:
    """Where in the message a block goes on, and with which state, if it does no more than that."""
    match block:
        case (Assign(name, at), Assign(state, Const(_, number))) if (name, state) == (stack.at.name, stack.state.name):
            return at, int(number)
        case _:
            return None


def entering(stack: Stack, words: Sequence[Place], start: Expr, count: Expr, then: int) -> Block:
    """To the first of some rows, which keeps in its ``words`` how to go on behind them."""
    kept = (stack.row, index(then), Binary("sub", count, index(1)))
    fields = tuple(SetField(place, value) for place, value in zip(words, kept, strict=True))
    return *fields, Assign(stack.depth.name, add(stack.depth, 1)), Assign(stack.row.name, start)


def entered(stack: Stack, block: Sequence[Stmt]) -> Entered | None:
    """The rows to which a block goes, if it does no more than that."""
    match block:
        case (
            SetField(Place(lane, start), around),
            SetField(Place(), Const(_, then)),
            SetField(Place(), Binary("add", count, Const(_, -1)) | Binary("sub", count, Const(_, 1))),
            Assign(deeper, depth),
            Assign(here, begun),
        ) if (around, deeper, here, begun) == (stack.row, stack.depth.name, stack.row.name, start):
            return Entered(lane, start, count, depth, int(then))
        case _:
            return None


def going_back(stack: Stack, words: Sequence[Expr]) -> Block:
    """From the last of some rows, out of whose words come the row around them and the state there."""
    row, state = words
    return Assign(stack.depth.name, add(stack.depth, -1)), Assign(stack.state.name, state), Assign(stack.row.name, row)


def goes_back(stack: Stack, block: Sequence[Stmt]) -> bool:
    """Whether a block ends a row: it asks how many neighbours follow, and goes on with the next one, or with the row around."""
    variables = {stack.state.name, stack.row.name}
    match block:
        case (Let(name, Get()), If(Compare("gt", Local(_, same), _), (*_, Assign(a), Assign(b)), (*_, Assign(c), Assign(d)))):
            return name == same and {a, b} == {c, d} == variables
        case _:
            return False


def stack_of(block: Sequence[Stmt]) -> Stack | None:
    """The variables that a body begins with, if these are all: of the stack, and the number of rounds."""
    names = [Local("i64", each.name) for each in block if isinstance(each, Var)]
    match names:
        case [at, state, row, depth, _]:
            return Stack(at, state, row, depth)
        case _:
            return None
