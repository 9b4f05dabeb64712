"""Loops that move one element a round become one move: of a row, and of all rows where they lie end to end."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

from rosetta_jit.kernel.arithmetic import FLOATS, constant, to_bytes
from rosetta_jit.kernel.ir import (
    WIDTH,
    Binary,
    Compare,
    Const,
    Convert,
    Copy,
    Expect,
    Fill,
    Fits,
    For,
    Get,
    If,
    Let,
    Load,
    Local,
    Place,
    SetField,
    Store,
    Wire,
)
from rosetta_jit.kernel.passes.affine import Affine, rounds_of
from rosetta_jit.kernel.passes.fold import FALSE, TRUE, folded
from rosetta_jit.kernel.rewrite import reads_memory, with_blocks, with_bodies
from rosetta_jit.kernel.terms import index, mul, split, type_of
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Address, Block, Expr, Kernel, Order, Scalar, Stmt
    from rosetta_jit.kernel.passes.affine import Rounds

Move = Copy | Fill


@dataclass(frozen=True, slots=True)
class _Stretch:
    """What the rounds of a loop move: the first round's move, the bytes from one round to the next at each address, and a round's size.

    ``checks`` hold in the last round if all rounds lie end to end, and then in every one.
    """

    first: Move
    steps: tuple[Expr, ...]
    size: Expr
    checks: tuple[Expr, ...] = ()


def bulk(kernel: Kernel) -> Kernel:
    """The kernel with moves in place of loops of smaller moves."""

    def block(body: Block) -> Block:
        return tuple(part for stmt in body for part in _statement(with_blocks(stmt, block), kernel.strides))

    return with_bodies(kernel, tuple(map(block, kernel.bodies)))


def bulk_of_bytes(kernel: Kernel) -> Kernel:
    """The same with loops over single bytes alone: these are right whatever order a machine has the bytes of larger numbers in."""

    def block(body: Block) -> Block:
        return tuple(part for stmt in body for part in _of_bytes(with_blocks(stmt, block), kernel.strides))

    return with_bodies(kernel, tuple(map(block, kernel.bodies)))


def _of_bytes(stmt: Stmt, strides: tuple[int, ...]) -> Block:
    return _statement(stmt, strides) if isinstance(stmt, For) and all(map(_keeps_order, stmt.body)) else (stmt,)


def _keeps_order(stmt: Stmt) -> bool:
    """Whether a statement moves no number of several bytes between the message and a lane."""
    match stmt:
        case SetField(_, value) | Store(_, value):
            return WIDTH[type_of(value)] == 1 or isinstance(value, Const)
        case _:
            return True


def group(kernel: Kernel) -> Kernel:
    """The kernel with moves in place of short loops whose rounds are known to lie end to end: the bytes of a channel, not yet a row."""

    def block(body: Block) -> Block:
        return tuple(part for stmt in body for part in short(with_blocks(stmt, block)))

    def short(stmt: Stmt) -> Block:
        made = _statement(stmt, kernel.strides) if isinstance(stmt, For) and isinstance(stmt.count, Const) else (stmt,)
        match made:
            case [If(_, (Copy() | Fill(),), ())]:
                return made
            case _:
                return (stmt,)

    return with_bodies(kernel, tuple(map(block, kernel.bodies)))


def _statement(stmt: Stmt, strides: tuple[int, ...]) -> Block:
    if not isinstance(stmt, For) or reads_memory(stmt.count):
        return (stmt,)
    rounds = rounds_of(stmt)
    move = _only_move(tuple(each for each in stmt.body if not isinstance(each, Expect)), rounds)
    stretch = _stretch(move, rounds, strides) if move is not None else None
    if stretch is None:
        return (stmt,)
    checks = [_last(each.condition, stmt, stretch, rounds) for each in stmt.body if isinstance(each, Expect)]
    known = tuple(check for check in checks if check is not None)
    return _joined(stmt, replace(stretch, checks=known)) if len(known) == len(checks) else (stmt,)


def _last(condition: Expr, loop: For, stretch: _Stretch, rounds: Rounds) -> Expr | None:
    """A comparison of what grows with the bytes moved, in the last round, where each round begins where the last one ended."""
    match condition:
        case Compare("lt" | "le" as op, left, right) if type_of(left) == "i64":
            value, bound = rounds.affine(left), rounds.fixed(right)
            if value is None or bound is None or value.step not in stretch.steps:
                return None
            moved = Binary("sub", mul(loop.count, stretch.size), stretch.size)
            return Compare(op, Binary("add", value.base, moved), bound)
        case _:
            return None


def _joined(loop: For, stretch: _Stretch) -> Block:
    """A loop as one move: always, never, or if at run time each round begins where the last one ended."""
    adjoin = [folded(Compare("eq", step, stretch.size)) for step in stretch.steps]
    if FALSE in adjoin:
        return (loop,)
    whole = If(Compare("gt", loop.count, index(0)), (replace(stretch.first, size=mul(loop.count, stretch.size)),))
    open_questions = [question for question in adjoin if question != TRUE] + [*stretch.checks]
    if not open_questions:
        return (whole,)
    condition: Expr = Fits("mul", loop.count, stretch.size)
    for question in open_questions:
        condition = Binary("and", condition, question)
    return (If(condition, (whole,), (loop,)),)


# --- what a round moves ------------------------------------------------------------------------------------------------


def _only_move(body: Block, rounds: Rounds) -> Move | None:
    """The move of a body that only computes besides."""
    effects = [stmt for stmt in body if not isinstance(stmt, Let)]
    match effects:
        case [If(Compare("gt", _, Const(_, 0)), (Copy() | Fill() as move,), ())]:
            # Where there is nothing to move, none of the rounds moves anything.
            return move
        case [only]:
            return _move(only, rounds)
        case _:
            copies = [move for stmt in effects if isinstance(move := _move(stmt, rounds), Copy)]
            return _end_to_end(copies, rounds) if copies and len(copies) == len(effects) else None


def _move(stmt: Stmt, rounds: Rounds) -> Move | None:
    match stmt:
        case Copy() | Fill():
            return stmt
        case SetField(place, value):
            return _assigned(place, value, "<", rounds)
        case Store(at, value, order):
            return _assigned(Wire(at), value, order, rounds)
        case _:
            return None


def _end_to_end(copies: list[Copy], rounds: Rounds) -> Copy | None:
    """Copies as one, if each begins where another one ends, on both sides: the fields of a struct that both sides have alike."""
    placed: list[tuple[int, int, Copy]] = []
    for each in copies:
        there, here = _distance(copies[0].target, each.target, rounds), _distance(copies[0].source, each.source, rounds)
        if there is None or there != here or not isinstance(each.size, Const):
            return None
        placed.append((there, there + int(each.size.value), each))
    placed.sort(key=lambda each: each[0])
    if any(end != begin for (_, end, _), (begin, _, _) in pairwise(placed)):
        return None
    return replace(placed[0][2], size=index(placed[-1][1] - placed[0][0]))


def _distance(one: Address, other: Address, rounds: Rounds) -> int | None:
    """How many bytes further an address is than another one, if that is known."""
    match one, other:
        case Wire(at), Wire(to):
            (here, near), (there, far) = _origin(at, rounds), _origin(to, rounds)
        case Place(lane, row, near), Place(same, to, far) if lane == same:
            here, there = rounds.affine(row), rounds.affine(to)
        case _:
            return None
    return far - near if here is not None and here == there else None


def _origin(at: Expr, rounds: Rounds) -> tuple[Affine | None, int]:
    """A position without the constant that is added to it, and that."""
    found = rounds.affine(at)
    if found is None:
        return None, 0
    base, number = split(found.base)
    return Affine(base, found.step), number


def _assigned(target: Address, value: Expr, order: Order, rounds: Rounds) -> Move | None:
    """An assignment of a scalar as a move of its bytes, if it changes none of them."""
    size = WIDTH[type_of(value)]
    match _moved(value, rounds):
        case Load(type_, at, from_order) if type_ != "bool" and isinstance(target, Place) and _is_same(order, from_order, size):
            return Copy(target, Wire(at), index(size))
        case Get(type_, place) if type_ != "bool" and isinstance(target, Wire) and _is_same(order, "<", size):
            return Copy(target, place, index(size))
        case Const(type_, number) if len(data := set(to_bytes(type_, constant(type_, number)))) == 1:
            return Fill(target, index(size), data.pop())
        case _:
            return None


def _is_same(order: Order, other: Order, size: int) -> bool:
    return order == other or size == 1


def _moved(value: Expr, rounds: Rounds) -> Expr:
    """The access or constant that a value has its bytes from."""
    while True:
        match value:
            case Local(_, name) if name in rounds.lets:
                value = rounds.lets[name]
            case Convert(type_, operand) if _keeps_bytes(type_, type_of(operand)):
                value = operand
            case _:
                return value


def _keeps_bytes(target: Scalar, source: Scalar) -> bool:
    return WIDTH[target] == WIDTH[source] and not {target, source} & {*FLOATS, "bool"}


# --- where the rounds lie ----------------------------------------------------------------------------------------------


def _stretch(move: Move, rounds: Rounds, strides: tuple[int, ...]) -> _Stretch | None:
    """The moves of all rounds, if they lie a fixed distance apart."""
    size, target = rounds.fixed(move.size), _along(move.target, rounds, strides)
    if size is None or target is None:
        return None
    if isinstance(move, Fill):
        return _Stretch(replace(move, target=target[0]), (target[1],), size)
    source = _along(move.source, rounds, strides)
    # Within a lane the rounds may build on each other.
    if source is None or (isinstance(move.target, Place) and isinstance(move.source, Place)):
        return None
    return _Stretch(Copy(target[0], source[0], size), (target[1], source[1]), size)


def _along(address: Address, rounds: Rounds, strides: tuple[int, ...]) -> tuple[Address, Expr] | None:
    """An address in the first round, and how many bytes further it is in the next."""
    match address:
        case Wire(at):
            found = rounds.affine(at)
            return (Wire(found.base), found.step) if found is not None else None
        case Place(lane, row, offset):
            found = rounds.affine(row)
            return (Place(lane, found.base, offset), mul(found.step, strides[lane])) if found is not None else None
