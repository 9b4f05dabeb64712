r"""Bools that have a byte each in the message: a byte is 0 or 1, and the struct module reads and writes many of them by one call.

for i in range(count):                              i = count - len(data[4 : 4 + count].lstrip(b"\0\1"))
    item = i + 4                                    if i < count:
    code = data[item]                                   item = i + 4
    if not (0 <= code <= 1):                            raise _Failed(7, item, (i,))
        raise _Failed(7, item, (i,))                flags = [*_unpack(f"{count}?", data, 4)]
    flags.append(code != 0)

code = data[0]                                      if data[:8].lstrip(b"\0\1"):
if code > 1:                                            code = data[0]
    raise _Failed(7, 0)                                 if code > 1:
first = code != 0                                           raise _Failed(7, 0)
code_2 = data[1]                                        ...
...                                                 first, second, ... = _load_8T(data, 0)
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.generate.python.passes.defaults import reads_of
from rosetta_jit.generate.python.passes.groups import based, without
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import locals_in, with_blocks
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import expressions_of, statements
from rosetta_jit.startup.dataclass import dataclass

LEAST = 8
"""Bools side by side from which on one call takes less time than each by itself."""


@dataclass(frozen=True, slots=True)
class Flags:
    """Bools that lie side by side in the message, from a place on: what reads and checks each, and the fields that they are."""

    at: nodes.Expr
    checks: nodes.Block
    fields: tuple[nodes.SetField, ...]


@dataclass(frozen=True, slots=True)
class Bools:
    """An array of bools that a loop copies between a lane and the message: its first row and its place.

    A decoder fails, behind ``before``, at the first byte that is neither 0 nor 1, as ``check`` says.
    """

    first: nodes.Place
    base: nodes.Expr
    before: nodes.Block = ()
    check: nodes.Expect | None = None


def bools_read(loop: nodes.For) -> Bools | None:
    """What a loop of a decoder reads, if each round is a byte that is 0 or 1."""
    match loop.body:
        case (
            *before,
            nodes.Let(code, nodes.Convert("i64", nodes.Load("u8", at))),
            nodes.Expect(condition) as check,
            nodes.SetField(place, nodes.Compare("ne", nodes.Local(_, same), nodes.Const(_, 0))),
        ) if code == same and _is_flag(condition, code):
            return _bools(loop, place, at, tuple(before), check)
        case _:
            return None


def bools_written(loop: nodes.For) -> Bools | None:
    """What a loop of an encoder writes, if each round is a bool as a byte."""
    match loop.body:
        case (*before, nodes.Store(at, nodes.Convert("u8", nodes.Get("bool", place)))):
            return _bools(loop, place, at, tuple(before), None)
        case _:
            return None


def _bools(loop: nodes.For, place: nodes.Place, at: nodes.Expr, before: nodes.Block, check: nodes.Expect | None) -> Bools | None:
    names = {each.name: each.value for each in before if isinstance(each, nodes.Let)}
    resolved = names.get(at.name, at) if isinstance(at, nodes.Local) else at
    row, base = without(place.row, loop.variable, 1), without(resolved, loop.variable, 1)
    if len(names) != len(before) or len(names) > 1 or place.offset or row is None or base is None:
        return None
    return None if {*names} & (locals_in(row) | locals_in(base)) else Bools(nodes.Place(place.lane, row), base, before, check)


def _is_flag(condition: nodes.Expr, name: str) -> bool:
    """Whether a condition says that a local is 0 or 1."""
    local = nodes.Local("i64", name)
    return condition == nodes.Binary("and", nodes.Compare("ge", local, index(0)), nodes.Compare("le", local, index(1)))


def with_flags(block: nodes.Block) -> Iterator[Flags | nodes.Block]:
    """The statements of a decoder's block, of which those are together that read many bools side by side."""
    begin = number = 0
    while number < len(block):
        places = list[nodes.Expr]()
        while (at := _flag_at(block[number : number + 3])) is not None and (not places or _is_behind(at, places[-1])):
            places.append(at)
            number += 3
        first = number - 3 * len(places)
        run = block[first:number]
        if len(places) >= LEAST and not _used_elsewhere(run, block):
            if first > begin:
                yield block[begin:first]
            checks = tuple(each for each in run if not isinstance(each, nodes.SetField))
            yield Flags(places[0], checks, tuple(each for each in run if isinstance(each, nodes.SetField)))
            begin = number
        number += 0 if places else 1
    if begin < len(block):
        yield block[begin:]


def _flag_at(stmts: nodes.Block) -> nodes.Expr | None:
    """Where the byte lies that three statements read as a bool, if they do."""
    match stmts:
        case (
            nodes.Let(code, nodes.Convert("i64", nodes.Load("u8", at))),
            nodes.Expect(condition),
            nodes.SetField(_, nodes.Compare("ne", nodes.Local(_, same), nodes.Const(_, 0))),
        ) if code == same and _is_flag(condition, code):
            return at
        case _:
            return None


def _is_behind(at: nodes.Expr, other: nodes.Expr) -> bool:
    (base, offset), (base_2, offset_2) = based(at), based(other)
    return base == base_2 and offset == offset_2 + 1


def _used_elsewhere(run: nodes.Block, block: nodes.Block) -> bool:
    """Whether other statements of a block read a local that a run of them sets."""
    own, all_reads = reads_of(run), reads_of(block)
    return any(own[each.name] != all_reads[each.name] for each in run if isinstance(each, nodes.Let))


def with_bytes(block: nodes.Block) -> nodes.Block:
    """A decoder's block in which bytes that have to be 0 or 1 are read without a sign."""
    found: list[nodes.Stmt] = []
    for number, stmt in enumerate(block):
        after = block[number + 1] if number + 1 < len(block) else None
        match stmt, after:
            case nodes.Let(name, nodes.Convert("i64", nodes.Load("i8", at, order))), nodes.Expect(condition) if _is_flag(condition, name):
                found.append(nodes.Let(name, nodes.Convert("i64", nodes.Load("u8", at, order))))
            case _:
                found.append(with_blocks(stmt, with_bytes))
    return tuple(found)


def with_stored_bools(block: nodes.Block) -> nodes.Block:
    """An encoder's block in which bools are written as bytes where it makes integers of them first."""
    readers: dict[str, int] = {}
    for stmt, _ in statements(block):
        for name in {name for expr in expressions_of(stmt) for name in locals_in(expr)}:
            readers[name] = readers.get(name, 0) + 1
    return _with_stored(block, readers)


def _with_stored(block: nodes.Block, readers: dict[str, int]) -> nodes.Block:
    found: list[nodes.Stmt] = []
    for stmt in block:
        match found[-1] if found else None, stmt:
            case nodes.Let(name, nodes.Convert("i64", nodes.Get("bool") as flag)), nodes.Store(at, stored, order) if (
                stored in _bytes_of(name) and readers[name] == 1
            ):
                found[-1] = nodes.Store(at, nodes.Convert("u8", flag), order)
            case _:
                found.append(with_blocks(stmt, lambda inner: _with_stored(inner, readers)))
    return tuple(found)


def _bytes_of(name: str) -> tuple[nodes.Expr, ...]:
    """A local as a byte, with a sign or without."""
    return nodes.Convert("u8", nodes.Local("i64", name)), nodes.Convert("i8", nodes.Local("i64", name))
