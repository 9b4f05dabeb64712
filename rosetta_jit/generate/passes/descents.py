"""The loop over states in which kernels visit messages of types that contain themselves, as blocks that visit each other.

while (state >= 0):                             kids    ...
  switch state:                                         visit kids, count @ (at + 8)
  case 2:                                               ...
    ...
    if (count > 0):
      expect (depth < 64)
      set lane 2[start].72 = here
      set lane 2[start].80 = 3
      set lane 2[start].88 = (count + -1)
      depth = (depth + 1)
      here = start
      at = (at + 8)
      state = 2
    else:
      at = (at + 8)
      state = 3
  case 3:
    ...
"""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.generate.passes.reachable import read_names
from rosetta_jit.kernel.nodes import (
    Advance,
    Assign,
    Binary,
    Block,
    Call,
    Compare,
    Const,
    Expect,
    Expr,
    Fill,
    If,
    Let,
    Local,
    Place,
    Reserve,
    Return,
    SetField,
    Stmt,
    Switch,
    Used,
    Var,
    While,
)
from rosetta_jit.kernel.passes.fold import TRUE, folded
from rosetta_jit.kernel.rewrite import with_blocks, with_expressions, with_operands
from rosetta_jit.kernel.terms import add, index, split
from rosetta_jit.kernel.visits import Stack, entered, goes_back, gone, stack_of
from rosetta_jit.model.layout import Layout
from rosetta_jit.startup.dataclass import dataclass, field

DONE = -1


class NotNested(Exception):  # noqa: N818 - no error: such a loop stays one
    """A loop that is no descent from rows to the rows in them."""


@dataclass(frozen=True, slots=True)
class Visit:
    """All rows of an array, ``count`` of them from ``start`` on: in a decoder the span at ``place`` says so.

    ``shallow`` checks the depth around them, ``depth`` is how deep they are. With a ``number`` it is one of them alone.
    """

    lane: int
    start: Expr
    count: Expr
    shallow: Expect | None
    place: Place | None
    depth: Expr
    number: Expr | None = None


@dataclass(slots=True)
class Descents:
    """What is done for the message, and for each ``row`` of a lane, at a position and a ``depth``, as far as they are ``given``.

    ``visits`` are the calls of no routine, by name: their arguments are where the rows begin in the message and how many there are, their
    result is where they end. A visit of one message alone has the arguments that its function is given; what measures it gives its size.
    ``left`` has the lanes whose rows all messages within others share, by number, ``lengths`` counts sizes that are known so far.
    """

    at: Local
    row: Local
    depth: Local
    given: tuple[Local, ...]
    body: Block = ()
    rows: dict[int, Block] = field(default_factory=dict[int, "Block"])
    visits: dict[str, Visit] = field(default_factory=dict[str, Visit])
    left: dict[int, int] = field(default_factory=dict[int, int])
    lengths: Local | None = None

    def behind(self) -> frozenset[str]:
        """The locals that are places behind rows, and other numbers that are 0 or more."""
        return frozenset({self.at.name, self.depth.name, *self.visits})


def descended(block: Block, layout: Layout) -> Descents:
    """The parts of a body; raises NotNested where its loop is none of these."""
    loops = [number for number, each in enumerate(block) if isinstance(each, While)]
    if not layout.recursive or len(loops) != 1:
        raise NotNested
    (number,) = loops
    before, loop, after = block[:number], block[number], block[number + 1 :]
    stack = stack_of(before)
    match loop:
        case While(Binary("and", Compare("ge", asked), _), (Switch(switched, cases), Assign())) if stack is not None:
            at, depth = stack.at, stack.depth
        case _:
            raise NotNested
    if not asked == switched == stack.state or not all(isinstance(each, Fill | Var | Let | Expect) for each in before):
        raise NotNested
    found = Descents(at, stack.row, depth, (at, depth))
    reader = _Reader(dict(cases), found, stack)
    own, end = reader.chain(0, index(0), index(0))
    while reader.pending:
        lane, entry = reader.pending.popitem()
        found.rows[lane] = ()
        rows, behind = reader.chain(entry, at, depth)
        found.rows[lane] = (*rows, Return(behind))
    fills = tuple(each for each in before if isinstance(each, Fill))
    found.body = (*fills, *own, *_at(after, {at: end}))
    return found


class _Reader:
    """Follows states; ``pending`` are the lanes of which rows are visited with the states that begin them."""

    def __init__(self, cases: dict[int, Block], found: Descents, stack: Stack) -> None:
        self.cases, self.found, self.stack, self.pending = cases, found, stack, dict[int, int]()

    def chain(self, number: int, at: Expr, depth: Expr) -> tuple[list[Stmt], Expr]:
        """The statements of a state, and of those that follow in the same row; and where they end in the message."""
        stmts: list[Stmt] = []
        while number != DONE and not goes_back(self.stack, self.cases.get(number, ())):
            block = _at(self.cases.pop(number, ()), {self.found.at: at, self.found.depth: depth})
            match block:
                case (*own, If(Compare("gt", count, Const(_, 0)), visit, none)):
                    at, number = self._gone(none)
                    stmts += self._visit(own, count, visit, at, number)
                    at = Local("i64", [*self.found.visits][-1])
                case (*own, Assign() as first, Assign() as last):
                    stmts += own
                    at, number = self._gone((first, last))
                case _:
                    raise NotNested
        if any(isinstance(each, Assign) and each.name in self._variables() for each in stmts):
            raise NotNested
        return stmts, at

    def _variables(self) -> set[str]:
        return {each.name for each in (self.stack.at, self.stack.state, self.stack.row, self.stack.depth)}

    def _gone(self, block: Sequence[Stmt]) -> tuple[Expr, int]:
        """Where a state ends in the message, and the one behind it."""
        if (found := gone(self.stack, block)) is None:
            raise NotNested
        return found

    def _visit(self, own: Sequence[Stmt], count: Expr, visit: Block, at: Expr, then: int) -> list[Stmt]:
        """A state up to where rows are visited, and that."""
        found = self.found
        checks = [each for each in visit if isinstance(each, Expect)]
        rows, (behind, entry) = entered(self.stack, visit[len(checks) : -2]), self._gone(visit[-2:])
        if rows is None or (rows.then, rows.count) != (then, count):
            raise NotNested
        lane, start, depth = rows.lane, rows.start, rows.depth
        if behind != at or len(checks) > 1:
            raise NotNested
        if lane not in found.rows:
            self.pending[lane] = entry
        shallow = next((each for each in checks if folded(each.condition) != TRUE), None)
        stmts, place = _without_span(own, lane, start, count)
        if place is not None and any(each.lane == lane and each.place and each.place.lane == place.lane for each in found.visits.values()):
            raise NotNested
        name, begin = f"behind\0{len(found.visits)}", f"begin\0{len(found.visits)}"
        found.visits[name] = Visit(lane, start, count, shallow, place, depth)
        return [*stmts, Let(begin, at), Call(name, (Local("i64", begin), count), (Local("i64", name),), ())]


def _without_span(stmts: Sequence[Stmt], lane: int, start: Expr, count: Expr) -> tuple[list[Stmt], Place | None]:
    """Statements without those that take rows of a lane, and that say which; and the place where they said so."""
    if not isinstance(start, Local) or not any(each == Let(start.name, Used(lane)) for each in stmts):
        return [*stmts], None
    places = [each.place for each in stmts if isinstance(each, SetField) and each.value == start]
    if len(places) != 1:
        raise NotNested
    (place,) = places
    behind = Place(place.lane, place.row, place.offset + 8)
    gone = (Reserve(lane, count), Let(start.name, Used(lane)), Advance(lane, count), SetField(place, start), SetField(behind, count))
    kept = [each for each in stmts if each not in gone]
    if len(stmts) - len(kept) != len(gone) or start.name in read_names(tuple(kept)):
        raise NotNested
    return kept, place


def _at(block: Block, values: dict[Local, Expr]) -> Block:
    """A block with values in place of some locals; those that stand for a place near another one go with them."""
    found: list[Stmt] = []
    for stmt in block:
        moved = placed(stmt, values)
        match moved:
            case Let(name, Const("i64") as place):
                values[Local("i64", name)] = place
            case Let(name, Local() | Binary("add", Local(), Const()) as place) if split(place)[0] in values.values():
                values[Local("i64", name)] = place
            case _:
                found.append(moved)
    return tuple(found)


def placed(stmt: Stmt, values: dict[Local, Expr]) -> Stmt:
    """A statement with values in place of some locals."""

    def put(expr: Expr) -> Expr:
        if isinstance(expr, Local):
            return values.get(expr, expr)
        match found := with_operands(expr, put):
            case Binary("add", left, Const("i64", value)):
                return add(left, int(value))
            case _:
                return found

    return with_blocks(with_expressions(stmt, put), lambda block: tuple(placed(each, values) for each in block))
