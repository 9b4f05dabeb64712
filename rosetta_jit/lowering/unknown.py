"""Fields that a schema does not know: skipped by their wire type, groups to their matching end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import (
    BEGIN,
    Binary,
    Compare,
    Const,
    Convert,
    Expect,
    Expr,
    Get,
    Place,
    Reserve,
    SetField,
    Switch,
    Used,
    While,
    add,
    index,
)
from rosetta_jit.lowering.varint import read_varint
from rosetta_jit.lowering.writer import block

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Block, Local
    from rosetta_jit.lowering.fields import HolderFields
    from rosetta_jit.lowering.writer import Where, Writer

MAX_NESTING = 64
"""Groups within groups: more is an error of kind ``nesting``."""

VARINT, FIXED64, DELIMITED, GROUP, END_GROUP, FIXED32 = 0, 1, 2, 3, 4, 5


def skip_unknown(writer: Writer, fields: HolderFields, tag: Local, stop: Expr) -> None:
    """Skip the value behind a tag. Numbers of fields start at 1 and end at 2**29 - 1."""
    where = fields.where
    _expect_tag(writer, tag, where)
    after = writer.var("next", writer.position)
    with writer.nested() as group:
        skip_group(writer, len(fields.layout.lanes), tag, stop, where)
        writer.assign(after, writer.position)
    cases = (*_scalar_cases(writer, after, stop, where), (GROUP, block(group)))
    writer.emit(Switch(Binary("and", tag, index(7)), cases, _refused(writer, where)))
    writer.position = after


def _expect_tag(writer: Writer, tag: Expr, where: Where) -> None:
    usable = Binary("and", Compare("ge", tag, index(8)), Compare("lt", tag, index(1 << 32)))
    writer.expect(usable, "tag", where, "not a field's number")


def _scalar_cases(writer: Writer, after: Local, stop: Expr, where: Where) -> tuple[tuple[int, Block], ...]:
    """Values that are not groups, by wire type."""
    from rosetta_jit.lowering.tagged import read_length

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
    failure = writer.failure("tag", where, "an end of a group that did not begin, or no wire type at all")
    return (Expect(Const("bool", value=False), failure),)


def skip_group(writer: Writer, scratch: int, tag: Local, stop: Expr, where: Where) -> None:
    """Skip the fields of a group and its end tag.

    The numbers of the groups that are open lie in the scratch lane, which is the stack of this loop.
    """
    writer.emit(Reserve(scratch, index(MAX_NESTING)))
    base = writer.let("base", Used(scratch))
    writer.emit(SetField(Place(scratch, base), Binary("shr", tag, index(3))))
    writer.expect(Compare("le", writer.position, stop), "truncated", where, "a field goes beyond its message")
    at, depth = writer.var("at", writer.position), writer.var("depth", index(1))
    with writer.nested() as body:
        writer.position = at
        inner = writer.let("tag", Convert("i64", read_varint(writer, where)))
        _expect_tag(writer, inner, where)
        after = writer.var("next", writer.position)
        with writer.nested() as opened:
            writer.expect(Compare("lt", depth, index(MAX_NESTING)), "nesting", where, f"more than {MAX_NESTING} groups within each other")
            writer.emit(SetField(Place(scratch, Binary("add", base, depth)), Binary("shr", inner, index(3))))
            writer.assign(depth, add(depth, 1))
        with writer.nested() as closed:
            innermost = Get("i64", Place(scratch, Binary("add", base, Binary("sub", depth, index(1)))))
            writer.expect(Compare("eq", innermost, Binary("shr", inner, index(3))), "tag", where, "the end of another group")
            writer.assign(depth, Binary("sub", depth, index(1)))
        cases = (*_scalar_cases(writer, after, stop, where), (GROUP, block(opened)), (END_GROUP, block(closed)))
        writer.emit(Switch(Binary("and", inner, index(7)), cases, _refused(writer, where)))
        writer.position = after
        writer.expect(Compare("le", after, stop), "truncated", where, "a field goes beyond its message")
        within = Binary("and", Compare("ge", depth, index(0)), Compare("le", depth, index(MAX_NESTING)))
        writer.expect(within, "nesting", where, f"more than {MAX_NESTING} groups within each other")
        writer.assign(at, after)
    open_group = Binary("and", Compare("gt", depth, index(0)), Compare("lt", at, stop))
    invariant = (
        Compare("ge", at, BEGIN),
        Compare("le", at, stop),
        Compare("ge", depth, index(0)),
        Compare("le", depth, index(MAX_NESTING)),
    )
    writer.emit(While(open_group, block(body), invariant, at))
    writer.position = at
    writer.expect(Compare("eq", depth, index(0)), "truncated", where, "the group has no end")
