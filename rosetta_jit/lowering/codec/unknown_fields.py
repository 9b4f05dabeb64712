"""Fields that a schema does not know: skipped by their wire type, groups to their matching end."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import (
    Assign,
    Binary,
    Capacity,
    Compare,
    Const,
    Convert,
    Expect,
    Expr,
    Get,
    If,
    Place,
    Reserve,
    SetField,
    Switch,
    Used,
    While,
)
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.lowering.codec.varint import read_length, read_tag, read_varint
from rosetta_jit.lowering.limits import MAX_GROUPS
from rosetta_jit.lowering.writer import MESSAGE, Contract, block

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Block, Local
    from rosetta_jit.lowering.codec.fields import HolderFields
    from rosetta_jit.lowering.writer import Where, Writer

VARINT, FIXED64, DELIMITED, GROUP, END_GROUP, FIXED32 = 0, 1, 2, 3, 4, 5


def skip_unknown(writer: Writer, fields: HolderFields, tag: Local, stop: Expr) -> None:
    """Skip the value behind a tag."""
    skip(writer, len(fields.layout.lanes), tag, stop, fields.where)


def _expect_tag(writer: Writer, tag: Expr, where: Where) -> None:
    usable = Binary("and", Compare("ge", tag, index(8)), Compare("lt", tag, index(1 << 32)))
    writer.expect(usable, "tag", where, "not a field's number")


def _scalar_cases(writer: Writer, after: Local, stop: Expr, where: Where) -> tuple[tuple[int, Block], ...]:
    """Values that are not groups, by wire type. What goes beyond ``stop`` is noticed by the caller."""
    cases: list[tuple[int, Block]] = []
    for wire in (VARINT, FIXED64, DELIMITED, FIXED32):
        with writer.nested() as body:
            match wire:
                case 0:
                    read_varint(writer, where)
                case 2:
                    writer.advance(read_length(writer, where, stop))
                case _:
                    size = 8 if wire == FIXED64 else 4
                    writer.require(size, where)
                    writer.advance(size)
            writer.assign(after, writer.position)
        cases.append((wire, block(body)))
    return tuple(cases)


def _refused(writer: Writer, where: Where) -> Block:
    failure = writer.failure("tag", where, "no wire type")
    return (Expect(Const("bool", value=False), failure),)


def skip(writer: Writer, scratch: int, tag: Local, stop: Expr, where: Where) -> Local:
    """Skip the value behind a tag: of a group all its fields, and its end tag. Where that tag begins is the result.

    The numbers of the groups that are open lie in the scratch lane, which is the stack of this loop.
    """
    writer.emit(Reserve(scratch, index(MAX_GROUPS)))
    arguments = (writer.position, tag, stop, Used(scratch))
    writer.position, last_tag = writer.call("skip", partial(_skip, scratch=scratch), arguments, where)
    return last_tag


def _skip(writer: Writer, scratch: int) -> Contract:
    start, tag, stop, base = (writer.parameter(name, "i64") for name in ("start", "first", "stop", "base"))
    where = MESSAGE
    limit = writer.let("limit", add(Binary("sub", END, BEGIN), 2))
    at, depth, rounds = writer.var("at", start), writer.var("depth", index(0)), writer.var("rounds", index(0))
    current, goes_on = writer.var("tag", tag), writer.var("goes_on", Const("bool", value=True))
    last_tag = writer.var("last_tag", at)
    with writer.nested() as body:
        writer.position = at
        _expect_tag(writer, current, where)
        after = writer.var("next", at)
        cases = (*_scalar_cases(writer, after, stop, where), *_group_cases(writer, scratch, base, depth, current, where))
        writer.emit(Switch(Binary("and", current, index(7)), cases, _refused(writer, where)))
        writer.position = after
        within = Binary("and", Compare("ge", depth, index(0)), Compare("le", depth, index(MAX_GROUPS)))
        writer.expect(within, "nesting", where, f"more than {MAX_GROUPS} groups within each other")
        writer.expect(Compare("le", after, stop), "truncated", where, "a field goes beyond its message")
        writer.assign(at, after)
        _expect_position(writer, at, where)
        inner = _next_tag(writer, at, last_tag, current, where)
        writer.emit(If(Compare("gt", depth, index(0)), inner, (Assign(goes_on.name, Const("bool", value=False)),)))
        writer.assign(rounds, add(rounds, 1))
    invariant = (
        *writer.within(at),
        Compare("ge", at, start),
        *writer.within(last_tag),
        Compare("ge", depth, index(0)),
        Compare("le", depth, index(MAX_GROUPS)),
        Compare("ge", rounds, index(0)),
        Compare("le", rounds, limit),
    )
    writer.emit(While(Binary("and", goes_on, Compare("lt", rounds, limit)), block(body), invariant, rounds))
    writer.position = at
    writer.expect(Compare("eq", depth, index(0)), "truncated", where, "the group has no end")
    has_stack = Compare("ge", base, index(0)), Compare("le", base, Binary("sub", Capacity(scratch), index(MAX_GROUPS)))
    ensured = *writer.within(at), Compare("ge", at, start), *writer.within(last_tag)
    return Contract((start, tag, stop, base), (at, last_tag), (*writer.within(start), *writer.within(stop), *has_stack), ensured)


def _next_tag(writer: Writer, at: Local, last_tag: Local, current: Local, where: Where) -> Block:
    """Within a group: the tag of its next field."""
    with writer.nested() as body:
        writer.assign(last_tag, at)
        writer.position = at
        writer.assign(current, Convert("i64", read_tag(writer, where)))
        writer.assign(at, writer.position)
    return block(body)


def _group_cases(writer: Writer, scratch: int, base: Local, depth: Local, tag: Local, where: Where) -> tuple[tuple[int, Block], ...]:
    """The start of a group and its end, which must be of the same number."""
    number = Binary("shr", tag, index(3))
    with writer.nested() as opened:
        writer.expect(Compare("lt", depth, index(MAX_GROUPS)), "nesting", where, f"more than {MAX_GROUPS} groups within each other")
        writer.emit(SetField(Place(scratch, Binary("add", base, depth)), number))
        writer.assign(depth, add(depth, 1))
    with writer.nested() as closed:
        writer.expect(Compare("gt", depth, index(0)), "tag", where, "the end of a group that did not begin")
        innermost = Get("i64", Place(scratch, Binary("add", base, Binary("sub", depth, index(1)))))
        writer.expect(Compare("eq", innermost, number), "tag", where, "the end of another group")
        writer.assign(depth, Binary("sub", depth, index(1)))
    return (GROUP, block(opened)), (END_GROUP, block(closed))


def _expect_position(writer: Writer, at: Local, where: Where) -> None:
    """True anyway; said for the proof, which does not follow the position through branches."""
    writer.expect(Binary("and", *writer.within(at)), "truncated", where, "a field goes beyond its message")
