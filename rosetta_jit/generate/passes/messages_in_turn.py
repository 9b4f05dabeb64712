"""Encoders of messages of types that contain themselves, as functions that call each other in place of a work list (`work_lists`).

let size = get i64 lane 3[(start + i)].96               let next = opened @ (at + 1), 1
let next = write_varint((at + 1), size)                 let behind = visit message 3[start + i] @ next
set lane 3[(start + i)].56 = next                       let end = closed @ (at + 1), next, behind, 1
...                                                     ...

They measure a message where the one around it needs its size, and write it where that has a place for it: so both come upon all messages in
the same order, and upon whatever else has a length, and the scratch lane has all lengths in that order. Who writes need not know them: a
length has as many bytes then as others of its kind had, which a number says, and what it is of moves if it takes more or fewer.
"""

from __future__ import annotations

from rosetta_jit.generate.passes.descents import Descents, NotNested, Visit, placed
from rosetta_jit.generate.passes.undamaged import OWN_ROWS, undamaged
from rosetta_jit.generate.passes.work_lists import is_hidden, measured_rows, without_work_list
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import (
    Assign,
    Binary,
    Block,
    Call,
    Compare,
    Convert,
    Expect,
    Expr,
    Failure,
    Get,
    Let,
    Local,
    Place,
    Require,
    Reserve,
    Return,
    SetField,
    Stmt,
    Var,
)
from rosetta_jit.kernel.rewrite import substituted, with_blocks, with_expressions
from rosetta_jit.kernel.terms import END, add, index, split
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Layout
from rosetta_jit.startup.dataclass import dataclass, field, replace

AT, ROW, DEPTH = Local("i64", "begin_of_message"), Local("i64", "row"), Local("i64", "depth")
DEEPEST = 1_000
"""Messages within each other: each takes some hundred bytes of the stack, of which threads may have little."""

OPENED, CLOSED = "opened\0", "closed\0"
"""Calls of no routine: what has a length begins behind the bytes that are left for it, and ends, which may move what was written."""
DEPTHS = 16
"""Lengths of one field are of as many kinds, by how deep their messages lie within others; deeper ones are taken for those of others."""


def visited_in_turn(kernel: Kernel, layout: Layout) -> Descents:
    """What the kernel of an encoder does, or one that measures; raises NotNested where it has no work list.

    Where a message may lack what it must have, it stays: kernels find the last such row first.
    """
    (body,) = kernel.bodies
    failures = {kernel.sites[each.site].kind: each for each in _failures(body)}
    writes = kernel.direction == "encode"
    too_deep = failures.get("length" if writes else "nesting")  # who cannot write measures, which says what is wrong
    if not layout.recursive or "missing" in failures or too_deep is None:
        raise NotNested
    own, rows = without_work_list(body, layout) if writes else measured_rows(body, layout)
    if not rows:
        raise NotNested
    lengths = _lengths(body, len(layout.lanes))
    found = Descents(AT, ROW, DEPTH, (AT, DEPTH) if writes else (DEPTH,), lengths=None if writes else lengths)
    shallow = Expect(Compare("le", DEPTH, index(DEEPEST)), replace(too_deep, at=AT, indices=()) if writes else too_deep)
    messages = _Written(layout, found.visits, lengths) if writes else _Measured(layout, found.visits, lengths)
    found.body = undamaged((*(() if writes else (Var(lengths.name, index(0)),)), *messages.block(own)), kernel.sites, OWN_ROWS)
    for lane, row in rows.items():
        if not isinstance(row.row, Local):
            raise NotNested
        messages.inside = add(DEPTH, 1)
        block = _with_values((*row.block, Return(row.end)), {row.row.name: index(0), row.begin: AT})
        found.rows[lane] = (shallow, *undamaged(messages.block(block), kernel.sites, OWN_ROWS))
    return found


def _failures(body: Block) -> list[Failure]:
    return [stmt.failure for stmt, _ in statements(body) if isinstance(stmt, Expect)]


def _lengths(body: Block, scratch: int) -> Local:
    """The variable that counts lengths, of which row 1 of the scratch lane has the first number; a new one where there are none."""
    first, variables = Place(scratch, index(1)), {stmt.name for stmt in body if isinstance(stmt, Var)}
    for stmt in body:
        match stmt:
            case Var(name, Get("i64", place)) | SetField(place, Local(_, name)) if place == first and name in variables:
                return Local("i64", name)
            case _:
                pass
    return Local("i64", "lengths")


def _with_values(block: Block, values: dict[str, Expr]) -> Block:
    """A block with values in place of some locals, which it does not set itself."""
    kept = (stmt for stmt in block if not (isinstance(stmt, Let) and stmt.name in values))
    changed = (with_expressions(stmt, lambda expr: substituted(expr, values)) for stmt in kept)
    return tuple(with_blocks(stmt, lambda inner: _with_values(inner, values)) for stmt in changed)


@dataclass(slots=True)
class _Measured:
    """Puts visits in place of what reads the sizes of rows, which get numbers among the other lengths of the message around them."""

    layout: Layout
    visits: dict[str, Visit]
    lengths: Local
    inside: Expr = index(1)

    def block(self, block: Block) -> Block:
        return tuple(each for stmt in block for each in self._stmts(stmt))

    def _stmts(self, stmt: Stmt) -> Block:
        match stmt:
            case Let(name, Get(_, place)) if is_hidden(place, self.layout):
                return self._size(Local("i64", name), place)
            case SetField(place) if is_hidden(place, self.layout):
                return ()
            case Var(name) if name == self.lengths.name:
                return ()
            case _:
                return (with_blocks(stmt, self.block),)

    def _size(self, size: Local, place: Place) -> Block:
        """The size of a message. It has a number before those of lengths in the message itself."""
        number, scratch = Local("i64", f"number\0{size.name}"), len(self.layout.lanes)
        counted = Let(number.name, self.lengths), Reserve(scratch, add(number, 1)), Assign(self.lengths.name, add(number, 1))
        return *counted, _visit(self.visits, place, size, (self.inside, self.lengths)), SetField(Place(scratch, number), size)


@dataclass(frozen=True, slots=True)
class _Opened:
    """What has a length, which lies ``at`` a position of the message: it begins at another one."""

    at: Expr
    begin: Local
    kind: Expr
    failure: Failure


@dataclass(slots=True)
class _Written:
    """Puts visits in place of what says where rows begin, and leaves room for their sizes, and for other lengths, that are not known.

    ``rows`` are the sizes of rows by their places, ``sizes`` the numbers of all whose value is not known, ``opened`` what has them and
    goes on, ``ends`` where messages end that had them.
    """

    layout: Layout
    visits: dict[str, Visit]
    lengths: Local
    inside: Expr = index(1)
    rows: dict[tuple[int, Expr], str] = field(default_factory=dict[tuple[int, Expr], str])
    sizes: dict[str, int] = field(default_factory=dict[str, int])
    opened: dict[str, _Opened] = field(default_factory=dict[str, _Opened])
    ends: dict[str, Local] = field(default_factory=dict[str, Local])

    def block(self, block: Block) -> Block:
        found, moved, before = list[Stmt](), dict[Local, Expr](), {*self.opened}
        for each in block:
            found += self._stmts(placed(each, moved), moved)
        if {*self.opened} - before:
            raise NotNested
        return tuple(found)

    def _stmts(self, stmt: Stmt, moved: dict[Local, Expr]) -> Block:
        match stmt:
            case Let(name, Get(_, place)) if place.lane == len(self.layout.lanes) or is_hidden(place, self.layout):
                self.sizes.setdefault(name, len(self.sizes))
                self.rows[place.lane, place.row] = name
                return ()
            case Let(_, Local(_, name)) | Let(name) | Var(name) | Assign(name) if name == self.lengths.name:
                return ()
            case Call(_, (at, Convert(_, Local(_, size))), (begin,), (site,)) if size in self.sizes:
                kind = add(self.inside, DEPTHS * self.sizes[size])
                self.opened[size] = _Opened(at, begin, kind, Failure(site, at, stmt.indices))
                return Call(OPENED, (at, kind), (begin,), ()), Expect(Compare("le", begin, END), self.opened[size].failure)
            case SetField(place, begin) if is_hidden(place, self.layout):
                return self._message(place, begin)
            case Require(_, Local(_, size)) if size in self.ends:
                return ()
            case Let(name, Binary("add", _, Local(_, size))) if size in self.ends:
                return (Let(name, self.ends[size]),)
            case Expect(Compare("eq", written, Local(_, size))) if size in self.opened:
                return self._closed(size, written, moved)
            case _:
                return (with_blocks(stmt, self.block),)

    def _message(self, place: Place, begin: Expr) -> Block:
        """A message, whose size is known then; the end of a group has none before it."""
        size, behind = self.rows[place.lane, place.row], Local("i64", f"behind\0{len(self.visits)}")
        visit = _visit(self.visits, place, behind, (begin, self.inside))
        if size not in self.opened:
            self.ends[size] = behind
            return (visit,)
        closed, self.ends[size] = self._end(size, behind)
        return visit, *closed

    def _closed(self, size: str, written: Expr, moved: dict[Local, Expr]) -> Block:
        """The end of what is no message of such a type; positions behind it move with it."""
        begin = self.opened[size].begin
        match written:
            case Binary("sub", behind, first) if first == begin:
                pass
            case _:
                behind = add(begin, written)
        closed, end = self._end(size, behind)
        base, more = split(behind)
        if not isinstance(base, Local):
            raise NotNested
        moved[base] = add(end, -more)
        return closed

    def _end(self, size: str, behind: Expr) -> tuple[Block, Local]:
        opened, end = self.opened.pop(size), Local("i64", f"end\0{size}")
        closed = Call(CLOSED, (opened.at, opened.begin, behind, opened.kind), (end,), ())
        return (closed, Expect(Compare("ge", end, index(0)), opened.failure)), end


def _visit(visits: dict[str, Visit], place: Place, result: Local, arguments: tuple[Expr, ...]) -> Call:
    match place.row:
        case Binary("add", Local() as start, number):
            pass
        case Local() as start:
            number = index(0)
        case _:
            raise NotNested
    name = f"message\0{len(visits)}"
    visits[name] = Visit(place.lane, start, index(1), None, None, index(0), number)
    return Call(name, arguments, (result,), ())
