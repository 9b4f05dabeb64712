"""Fields that lie side by side in the message and in a row become one move, and what is moved over a whole row need not be emptied before.

Only numbers that both have in the same byte order, on a machine that has it, too: the low byte first. What a For does with its elements
is left as it is: LLVM does it for several of them at once.
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.limits import MAX_PIECE, MAX_PIECES
from rosetta_jit.kernel.rewrite import reads_memory, with_blocks, with_bodies
from rosetta_jit.kernel.terms import add, index, split, type_of
from rosetta_jit.kernel.walk import expressions_of, subexpressions
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class _Move:
    """So many bytes between a row, from ``offset``, and the message, from ``at`` behind ``base``."""

    is_decoding: bool
    lane: int
    row: nodes.Expr
    base: nodes.Expr
    offset: int
    at: int
    size: int

    def is_followed_by(self, other: _Move) -> bool:
        """Whether both are one move: the other one begins where this one ends, on both sides."""
        ours = self.is_decoding, self.lane, self.row, self.base, self.offset + self.size, self.at + self.size
        return ours == (other.is_decoding, other.lane, other.row, other.base, other.offset, other.at)


def join(kernel: ir.Kernel) -> ir.Kernel:
    """The kernel with one move where fields lie side by side."""

    def block(body: nodes.Block) -> nodes.Block:
        return _uncovered(tuple(_joined([stmt if isinstance(stmt, nodes.For) else with_blocks(stmt, block) for stmt in body])))

    return with_bodies(kernel, tuple(map(block, kernel.bodies)))


def _joined(block: list[nodes.Stmt]) -> Iterator[nodes.Stmt]:
    run: list[tuple[_Move, nodes.Stmt]] = []
    for stmt in block:
        move = _move(stmt)
        if run and (move is None or not run[-1][0].is_followed_by(move)):
            yield from _together(run)
            run = []
        if move is None:
            yield stmt
        else:
            run.append((move, stmt))
    yield from _together(run)


def _move(stmt: nodes.Stmt) -> _Move | None:
    """A statement as a move, if it is one of so many bytes."""
    match stmt:
        case nodes.SetField(place, nodes.Load(type_, at, order)) if type_ != "bool" and (order == "<" or nodes.WIDTH[type_] == 1):
            return _between(place, at, nodes.WIDTH[type_], is_decoding=True)
        case nodes.Store(at, nodes.Get(type_, place), order) if type_ != "bool" and (order == "<" or nodes.WIDTH[type_] == 1):
            return _between(place, at, nodes.WIDTH[type_], is_decoding=False)
        case nodes.Copy(nodes.Place() as place, nodes.Wire(at), nodes.Const(_, size)):
            return _between(place, at, int(size), is_decoding=True)
        case nodes.Copy(nodes.Wire(at), nodes.Place() as place, nodes.Const(_, size)):
            return _between(place, at, int(size), is_decoding=False)
        case _:
            return None


def _between(place: nodes.Place, at: nodes.Expr, size: int, *, is_decoding: bool) -> _Move | None:
    if reads_memory(at) or reads_memory(place.row):
        return None
    base, begin = split(at)
    return _Move(is_decoding, place.lane, place.row, base, place.offset, begin, size)


def _together(run: list[tuple[_Move, nodes.Stmt]]) -> Iterator[nodes.Stmt]:
    """The moves of a run as few: one, or some of a size that a processor moves without a loop."""
    if len(run) < 2:
        yield from (stmt for _, stmt in run)
        return
    first, size = run[0][0], sum(move.size for move, _ in run)
    piece = MAX_PIECE if size <= MAX_PIECES * MAX_PIECE else size
    for begin in range(0, size, piece):
        yield _copy(first, begin, min(piece, size - begin))


def _copy(first: _Move, begin: int, size: int) -> nodes.Copy:
    """The move of some bytes of a run, from so many bytes behind its first."""
    place, wire = nodes.Place(first.lane, first.row, first.offset + begin), nodes.Wire(add(first.base, first.at + begin))
    return nodes.Copy(place, wire, index(size)) if first.is_decoding else nodes.Copy(wire, place, index(size))


def _uncovered(block: nodes.Block) -> nodes.Block:
    """A block without what empties bytes of a row that are then all set, by statements that only check, name values, or set fields."""
    return tuple(stmt for number, stmt in enumerate(block) if not _is_covered(block, number))


_WITHOUT_LANES = nodes.Require | nodes.Expect | nodes.Let | nodes.Var | nodes.Assign
"""Statements that have to do with lanes where their expressions read them, and nowhere else."""


def _is_covered(block: nodes.Block, number: int) -> bool:
    """Whether a statement is one that empties bytes, all of which are set behind it."""
    match block[number]:
        case nodes.Fill(nodes.Place() as place, nodes.Const(_, size)) if not reads_memory(place.row):
            free = [(place.offset, place.offset + int(size))]
        case _:
            return False
    for later in range(number + 1, len(block)):
        stmt = block[later]
        covered = _span(stmt, place)
        if covered is not None:
            free = [each for span in free for each in _without(span, covered)]
        elif not isinstance(stmt, _WITHOUT_LANES) or any(map(_reads_lanes, expressions_of(stmt))):
            return False
        if not free:
            return True
    return False


def _span(stmt: nodes.Stmt, place: nodes.Place) -> tuple[int, int] | None:
    """The bytes of a row that a statement sets, from where to where; None if it may do anything else with lanes."""
    match stmt:
        case nodes.SetField(nodes.Place(place.lane, place.row, offset), value) if not _reads_lanes(value):
            return offset, offset + nodes.WIDTH[type_of(value)]
        case nodes.Copy(nodes.Place(place.lane, place.row, offset), nodes.Wire(_), nodes.Const(_, size)):
            return offset, offset + int(size)
        case _:
            return None


def _reads_lanes(value: nodes.Expr) -> bool:
    return any(isinstance(part, nodes.Get | nodes.IsText | nodes.Nearest) for part in subexpressions(value))


def _without(span: tuple[int, int], covered: tuple[int, int]) -> Iterator[tuple[int, int]]:
    """What is left of a span."""
    (begin, end), (low, high) = span, covered
    if begin < min(low, end):
        yield begin, min(low, end)
    if max(high, begin) < end:
        yield max(high, begin), end
