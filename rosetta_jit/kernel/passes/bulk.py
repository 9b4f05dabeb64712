"""Loops that move one element a round become one move: of a row, and of all rows where they lie end to end."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.arithmetic import FLOATS, constant, to_bytes
from rosetta_jit.kernel.passes.fold import FALSE, TRUE, folded
from rosetta_jit.kernel.rewrite import reads_memory, with_blocks, with_bodies
from rosetta_jit.kernel.terms import index, mul, split, type_of
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.kernel.passes import affine
    from rosetta_jit.kernel.passes.affine import Affine, Rounds
else:
    affine = Late("rosetta_jit.kernel.passes.affine")

Move = nodes.Copy | nodes.Fill


@dataclass(frozen=True, slots=True)
class _Stretch:
    """What the rounds of a loop move: the first round's move, the bytes from one round to the next at each address, and a round's size.

    ``checks`` hold in the last round if all rounds lie end to end, and then in every one.
    """

    first: Move
    steps: tuple[nodes.Expr, ...]
    size: nodes.Expr
    checks: tuple[nodes.Expr, ...] = ()


def bulk(kernel: ir.Kernel) -> ir.Kernel:
    """The kernel with moves in place of loops of smaller moves."""

    def block(body: nodes.Block) -> nodes.Block:
        return tuple(part for stmt in body for part in _statement(with_blocks(stmt, block), kernel.strides))

    return with_bodies(kernel, tuple(map(block, kernel.bodies)))


def bulk_of_bytes(kernel: ir.Kernel) -> ir.Kernel:
    """The same with loops over single bytes alone: these are right whatever order a machine has the bytes of larger numbers in."""

    def block(body: nodes.Block) -> nodes.Block:
        return tuple(part for stmt in body for part in _of_bytes(with_blocks(stmt, block), kernel.strides))

    return with_bodies(kernel, tuple(map(block, kernel.bodies)))


def _of_bytes(stmt: nodes.Stmt, strides: tuple[int, ...]) -> nodes.Block:
    return _statement(stmt, strides) if isinstance(stmt, nodes.For) and all(map(_keeps_order, stmt.body)) else (stmt,)


def _keeps_order(stmt: nodes.Stmt) -> bool:
    """Whether a statement moves no number of several bytes between the message and a lane."""
    match stmt:
        case nodes.SetField(_, value) | nodes.Store(_, value):
            return nodes.WIDTH[type_of(value)] == 1 or isinstance(value, nodes.Const)
        case _:
            return True


def group(kernel: ir.Kernel) -> ir.Kernel:
    """The kernel with moves in place of short loops whose rounds are known to lie end to end: the bytes of a channel, not yet a row."""

    def block(body: nodes.Block) -> nodes.Block:
        return tuple(part for stmt in body for part in short(with_blocks(stmt, block)))

    def short(stmt: nodes.Stmt) -> nodes.Block:
        made = _statement(stmt, kernel.strides) if isinstance(stmt, nodes.For) and isinstance(stmt.count, nodes.Const) else (stmt,)
        match made:
            case [nodes.If(_, (nodes.Copy() | nodes.Fill(),), ())]:
                return made
            case _:
                return (stmt,)

    return with_bodies(kernel, tuple(map(block, kernel.bodies)))


def _statement(stmt: nodes.Stmt, strides: tuple[int, ...]) -> nodes.Block:
    if not isinstance(stmt, nodes.For) or reads_memory(stmt.count):
        return (stmt,)
    rounds = affine.rounds_of(stmt)
    move = _only_move(tuple(each for each in stmt.body if not isinstance(each, nodes.Expect)), rounds)
    stretch = _stretch(move, rounds, strides) if move is not None else None
    if stretch is None:
        return (stmt,)
    checks = [_last(each.condition, stmt, stretch, rounds) for each in stmt.body if isinstance(each, nodes.Expect)]
    known = tuple(check for check in checks if check is not None)
    return _joined(stmt, replace(stretch, checks=known)) if len(known) == len(checks) else (stmt,)


def _last(condition: nodes.Expr, loop: nodes.For, stretch: _Stretch, rounds: Rounds) -> nodes.Expr | None:
    """A comparison of what grows with the bytes moved, in the last round, where each round begins where the last one ended."""
    match condition:
        case nodes.Compare("lt" | "le" as op, left, right) if type_of(left) == "i64":
            value, bound = rounds.affine(left), rounds.fixed(right)
            if value is None or bound is None or value.step not in stretch.steps:
                return None
            moved = nodes.Binary("sub", mul(loop.count, stretch.size), stretch.size)
            return nodes.Compare(op, nodes.Binary("add", value.base, moved), bound)
        case _:
            return None


def _joined(loop: nodes.For, stretch: _Stretch) -> nodes.Block:
    """A loop as one move: always, never, or if at run time each round begins where the last one ended."""
    adjoin = [folded(nodes.Compare("eq", step, stretch.size)) for step in stretch.steps]
    if FALSE in adjoin:
        return (loop,)
    whole = nodes.If(nodes.Compare("gt", loop.count, index(0)), (replace(stretch.first, size=mul(loop.count, stretch.size)),))
    open_questions = [question for question in adjoin if question != TRUE] + [*stretch.checks]
    if not open_questions:
        return (whole,)
    condition: nodes.Expr = nodes.Fits("mul", loop.count, stretch.size)
    for question in open_questions:
        condition = nodes.Binary("and", condition, question)
    return (nodes.If(condition, (whole,), (loop,)),)


# --- what a round moves ------------------------------------------------------------------------------------------------


def _only_move(body: nodes.Block, rounds: Rounds) -> Move | None:
    """The move of a body that only computes besides."""
    effects = [stmt for stmt in body if not isinstance(stmt, nodes.Let)]
    match effects:
        case [nodes.If(nodes.Compare("gt", _, nodes.Const(_, 0)), (nodes.Copy() | nodes.Fill() as move,), ())]:
            # Where there is nothing to move, none of the rounds moves anything.
            return move
        case [only]:
            return _move(only, rounds)
        case _:
            copies = [move for stmt in effects if isinstance(move := _move(stmt, rounds), nodes.Copy)]
            return _end_to_end(copies, rounds) if copies and len(copies) == len(effects) else None


def _move(stmt: nodes.Stmt, rounds: Rounds) -> Move | None:
    match stmt:
        case nodes.Copy() | nodes.Fill():
            return stmt
        case nodes.SetField(place, value):
            return _assigned(place, value, "<", rounds)
        case nodes.Store(at, value, order):
            return _assigned(nodes.Wire(at), value, order, rounds)
        case _:
            return None


def _end_to_end(copies: list[nodes.Copy], rounds: Rounds) -> nodes.Copy | None:
    """Copies as one, if each begins where another one ends, on both sides: the fields of a struct that both sides have alike."""
    placed: list[tuple[int, int, nodes.Copy]] = []
    for each in copies:
        there, here = _distance(copies[0].target, each.target, rounds), _distance(copies[0].source, each.source, rounds)
        if there is None or there != here or not isinstance(each.size, nodes.Const):
            return None
        placed.append((there, there + int(each.size.value), each))
    placed.sort(key=lambda each: each[0])
    if any(end != begin for (_, end, _), (begin, _, _) in pairwise(placed)):
        return None
    return replace(placed[0][2], size=index(placed[-1][1] - placed[0][0]))


def _distance(one: nodes.Address, other: nodes.Address, rounds: Rounds) -> int | None:
    """How many bytes further an address is than another one, if that is known."""
    match one, other:
        case nodes.Wire(at), nodes.Wire(to):
            (here, near), (there, far) = _origin(at, rounds), _origin(to, rounds)
        case nodes.Place(lane, row, near), nodes.Place(same, to, far) if lane == same:
            here, there = rounds.affine(row), rounds.affine(to)
        case _:
            return None
    return far - near if here is not None and here == there else None


def _origin(at: nodes.Expr, rounds: Rounds) -> tuple[Affine | None, int]:
    """A position without the constant that is added to it, and that."""
    found = rounds.affine(at)
    if found is None:
        return None, 0
    base, number = split(found.base)
    return affine.Affine(base, found.step), number


def _assigned(target: nodes.Address, value: nodes.Expr, order: nodes.Order, rounds: Rounds) -> Move | None:
    """An assignment of a scalar as a move of its bytes, if it changes none of them."""
    size = nodes.WIDTH[type_of(value)]
    match _moved(value, rounds):
        case nodes.Load(type_, at, from_order) if type_ != "bool" and isinstance(target, nodes.Place) and _is_same(order, from_order, size):
            return nodes.Copy(target, nodes.Wire(at), index(size))
        case nodes.Get(type_, place) if type_ != "bool" and isinstance(target, nodes.Wire) and _is_same(order, "<", size):
            return nodes.Copy(target, place, index(size))
        case nodes.Const(type_, number) if len(data := set(to_bytes(type_, constant(type_, number)))) == 1:
            return nodes.Fill(target, index(size), data.pop())
        case _:
            return None


def _is_same(order: nodes.Order, other: nodes.Order, size: int) -> bool:
    return order == other or size == 1


def _moved(value: nodes.Expr, rounds: Rounds) -> nodes.Expr:
    """The access or constant that a value has its bytes from."""
    while True:
        match value:
            case nodes.Local(_, name) if name in rounds.lets:
                value = rounds.lets[name]
            case nodes.Convert(type_, operand) if _keeps_bytes(type_, type_of(operand)):
                value = operand
            case _:
                return value


def _keeps_bytes(target: nodes.Scalar, source: nodes.Scalar) -> bool:
    return nodes.WIDTH[target] == nodes.WIDTH[source] and not {target, source} & {*FLOATS, "bool"}


# --- where the rounds lie ----------------------------------------------------------------------------------------------


def _stretch(move: Move, rounds: Rounds, strides: tuple[int, ...]) -> _Stretch | None:
    """The moves of all rounds, if they lie a fixed distance apart."""
    size, target = rounds.fixed(move.size), _along(move.target, rounds, strides)
    if size is None or target is None:
        return None
    if isinstance(move, nodes.Fill):
        return _Stretch(replace(move, target=target[0]), (target[1],), size)
    source = _along(move.source, rounds, strides)
    # Within a lane the rounds may build on each other.
    if source is None or (isinstance(move.target, nodes.Place) and isinstance(move.source, nodes.Place)):
        return None
    return _Stretch(nodes.Copy(target[0], source[0], size), (target[1], source[1]), size)


def _along(address: nodes.Address, rounds: Rounds, strides: tuple[int, ...]) -> tuple[nodes.Address, nodes.Expr] | None:
    """An address in the first round, and how many bytes further it is in the next."""
    match address:
        case nodes.Wire(at):
            found = rounds.affine(at)
            return (nodes.Wire(found.base), found.step) if found is not None else None
        case nodes.Place(lane, row, offset):
            found = rounds.affine(row)
            return (nodes.Place(lane, found.base, offset), mul(found.step, strides[lane])) if found is not None else None
