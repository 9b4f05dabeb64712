"""Memory that nothing writes in between is read once.

The lowering reads a field of the holder wherever a rule names it. To the proof each read is a new value, because others may change
memory; what was checked of one read says nothing of the next, until both are one. Whoever sets a field leaves the others of its lane
as they are.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from itertools import count

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import (
    Address,
    Block,
    Call,
    Const,
    Copy,
    Expr,
    Fill,
    Get,
    HostCall,
    Let,
    Load,
    Local,
    Place,
    SetField,
    Stmt,
    Store,
    While,
)
from rosetta_jit.kernel.rewrite import locals_in, substituted, with_blocks, with_bodies, with_expressions, with_operands
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import NESTED, blocks_of, bound_names, changed_names, every_statement, flat, parts_of
from rosetta_jit.startup.dataclass import dataclass, field

MESSAGE = -1
"""Stands for the message among the numbers of the lanes."""

EVERYWHERE = -1
"""Stands for all bytes of a memory among the offsets in the rows of a lane."""

WIDEST = 8
"""The largest width of a scalar: what lies farther away in a row is another one."""

READS, PLAIN = frozenset((Load, Get)), frozenset((Const, Local))
"""What reads memory, and what has nothing inside."""

WRITERS = frozenset((Call, Store, SetField, Copy, Fill, HostCall))
"""What may write to memory."""

_Bytes = tuple[int, int]
"""What is written: the number of a memory, and at which offset of its rows."""


@dataclass(frozen=True, slots=True)
class _Known:
    """What has been read of each memory, the locals that hold it, and all that was learnt of that in its order."""

    read: dict[int, dict[Expr, Local]] = field(default_factory=dict[int, "dict[Expr, Local]"])
    news: list[tuple[int, Expr]] = field(default_factory=list["tuple[int, Expr]"])

    def of(self, memory: int) -> dict[Expr, Local]:
        """What has been read of a memory."""
        return self.read.setdefault(memory, {})

    def learn(self, memory: int, read: Expr, local: Local) -> None:
        """A local holds what has been read."""
        self.read[memory][read] = local
        self.news.append((memory, read))

    def unlearn(self, mark: int) -> None:
        """Forget what was learnt since there were so many ``news``."""
        while len(self.news) > mark:
            memory, read = self.news.pop()
            self.read.get(memory, {}).pop(read, None)


@dataclass(frozen=True, slots=True)
class _Names:
    """The variables of a body, the names that are taken in the kernel, those made here, and the memory that each routine writes.

    ``lets`` are the statements that name what the statement that is looked at is the first to read.
    """

    variables: set[str]
    taken: set[str]
    written: Mapping[str, set[_Bytes]]
    made: set[str] = field(default_factory=set[str])
    numbers: Iterator[int] = field(default_factory=lambda: count(1))
    lets: list[Stmt] = field(default_factory=list["Stmt"])

    def fresh(self) -> str:
        name = next(name for number in self.numbers if (name := f"read_{number}") not in self.taken)
        self.taken.add(name)
        self.made.add(name)
        return name

    def taken_lets(self) -> Block:
        """The ``lets``, of which none is left."""
        lets = tuple(self.lets)
        self.lets.clear()
        return lets


def reuse(kernel: Kernel) -> Kernel:
    """The kernel with a name for what it would read more than once."""
    taken = {name for stmt in every_statement(kernel) for name in bound_names(stmt)}
    written: dict[str, set[_Bytes]] = {}
    for routine in kernel.routines:
        written[routine.name] = _written_in(routine.body, written)
    return with_bodies(kernel, tuple(_body(body, taken, written) for body in kernel.bodies))


def _body(body: Block, taken: set[str], written: Mapping[str, set[_Bytes]]) -> Block:
    reads = [part for part in parts_of(flat(body)) if type(part) in READS]
    if len(set(reads)) == len(reads):
        return body
    names = _Names(changed_names(body), taken, written)
    known = _Known()
    result = _block(body, known, names, _naming(known, names))
    uses = Counter([part.name for part in parts_of(flat(result)) if type(part) is Local])
    single = {name for name in names.made if uses[name] == 1}
    return _inlined(result, names.made, single, {}) if single else result


# --- names for reads ---------------------------------------------------------------------------------------------------


def _block(block: Block, known: _Known, names: _Names, named: Callable[[Expr], Expr]) -> Block:
    result: list[Stmt] = []
    for stmt in block:
        if type(stmt) in NESTED:
            _forget(known, {each for inner in blocks_of(stmt) for each in _written_in(inner, names.written)})
        result += _statement(stmt, known, names, named)
        if type(stmt) in WRITERS:
            _forget(known, _written(stmt, names.written))
    return tuple(result)


def _statement(stmt: Stmt, known: _Known, names: _Names, named: Callable[[Expr], Expr]) -> Block:
    """A statement, behind names for what it is the first to read."""
    changed: Stmt
    match stmt:
        case Let(name, Load() | Get() as read):
            value = with_operands(read, named)
            seen = known.of(_source(value))
            if value not in seen and names.variables.isdisjoint(locals_in(value)):
                known.learn(_source(value), value, Local(type_of(value), name))
                return (*names.taken_lets(), Let(name, value))
            return (*names.taken_lets(), Let(name, seen.get(value, value)))
        case While():
            # Its condition is asked in each round: no name before the loop can stand for it.
            changed = stmt
        case _:
            changed = with_expressions(stmt, named)
    lets = names.taken_lets()
    if type(changed) not in NESTED:
        return (*lets, changed)
    return (*lets, with_blocks(changed, lambda inner: _branch(inner, known, names, named)))


def _branch(block: Block, known: _Known, names: _Names, named: Callable[[Expr], Expr]) -> Block:
    """A block that may run or not: what is read in it is forgotten behind it. What it writes has been forgotten before."""
    mark = len(known.news)
    result = _block(block, known, names, named)
    known.unlearn(mark)
    return result


def _naming(known: _Known, names: _Names) -> Callable[[Expr], Expr]:
    """Gives an expression with names in place of what it reads; what is read for the first time gets its name in ``names.lets``.

    One for a body: a function that calls itself is garbage in a cycle, of which each statement would leave one.
    """

    def named(expr: Expr) -> Expr:
        if type(expr) in PLAIN:
            return expr
        changed = with_operands(expr, named)
        if not isinstance(changed, Load | Get) or not names.variables.isdisjoint(locals_in(changed)):
            return changed
        local = known.of(_source(changed)).get(changed)
        if local is None:
            local = Local(changed.type, names.fresh())
            known.learn(_source(changed), changed, local)
            names.lets.append(Let(local.name, changed))
        return local

    return named


def _source(read: Expr) -> int:
    """The memory that a read depends on. Reads inside it have names of their own."""
    return read.place.lane if isinstance(read, Get) else MESSAGE


# --- what is written ---------------------------------------------------------------------------------------------------


def _written_in(block: Block, routines: Mapping[str, set[_Bytes]]) -> set[_Bytes]:
    return {each for stmt in flat(block) if type(stmt) in WRITERS for each in _written(stmt, routines)}


def _written(stmt: Stmt, routines: Mapping[str, set[_Bytes]]) -> set[_Bytes]:
    """What a statement itself writes."""
    match stmt:
        case Call(routine):
            return routines[routine]
        case Store():
            return {(MESSAGE, EVERYWHERE)}
        case SetField(place, _):
            return {(place.lane, place.offset)}
        case Copy(target, _, _) | Fill(target, _, _):
            return {(_memory(target), EVERYWHERE)}
        case HostCall():
            return set() if stmt.target is None else {(_memory(stmt.target.address), EVERYWHERE)}
        case _:
            return set()


def _memory(address: Address) -> int:
    return address.lane if isinstance(address, Place) else MESSAGE


def _forget(known: _Known, written: set[_Bytes]) -> None:
    """Forget what has been read of bytes that are written. Fields of a row do not overlap, whichever row it is."""
    for memory, offset in written:
        if offset == EVERYWHERE:
            known.read.pop(memory, None)
        elif memory in known.read:
            known.read[memory] = {read: local for read, local in known.read[memory].items() if not _may_overlap(read, offset)}


def _may_overlap(read: Expr, offset: int) -> bool:
    return not isinstance(read, Get) or abs(read.place.offset - offset) < WIDEST


# --- names for nothing -------------------------------------------------------------------------------------------------


def _inlined(block: Block, made: set[str], single: set[str], values: dict[str, Expr]) -> Block:
    """The block without names that are used once: in the statement for which they were ``made``, or for others that are."""
    result: list[Stmt] = []
    for stmt in block:
        if isinstance(stmt, Let) and stmt.name in single:
            values[stmt.name] = substituted(stmt.value, values)
            continue
        changed = with_expressions(stmt, partial(substituted, values=values)) if values else stmt
        if values and not (isinstance(stmt, Let) and stmt.name in made):
            values = {}
        result.append(with_blocks(changed, lambda inner: _inlined(inner, made, single, {})) if type(changed) in NESTED else changed)
    return tuple(result)
