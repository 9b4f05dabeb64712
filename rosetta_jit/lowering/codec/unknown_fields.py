"""Fields that a schema does not know: skipped by their wire type, groups to their matching end."""

from __future__ import annotations

from functools import partial

from rosetta_jit.kernel import ir
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.lowering.codec.holder_fields import HolderFields
from rosetta_jit.lowering.codec.varint import read_length, read_tag, read_varint
from rosetta_jit.lowering.limits import MAX_GROUPS
from rosetta_jit.lowering.writer import MESSAGE, Contract, Where, Writer, block

VARINT, FIXED64, DELIMITED, GROUP, END_GROUP, FIXED32 = 0, 1, 2, 3, 4, 5


def skip_unknown(writer: Writer, fields: HolderFields, tag: ir.Local, stop: ir.Expr) -> None:
    """Skip the value behind a tag."""
    skip(writer, len(fields.layout.lanes), tag, stop, fields.where)


def _expect_tag(writer: Writer, tag: ir.Expr, where: Where) -> None:
    usable = ir.Binary("and", ir.Compare("ge", tag, index(8)), ir.Compare("lt", tag, index(1 << 32)))
    writer.expect(usable, "tag", where, "not a field's number")


def _scalar_cases(writer: Writer, after: ir.Local, stop: ir.Expr, where: Where) -> tuple[tuple[int, ir.Block], ...]:
    """Values that are not groups, by wire type. What goes beyond ``stop`` is noticed by the caller."""
    cases: list[tuple[int, ir.Block]] = []
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


def _refused(writer: Writer, where: Where) -> ir.Block:
    failure = writer.failure("tag", where, "no wire type")
    return (ir.Expect(ir.Const("bool", value=False), failure),)


def skip(writer: Writer, scratch: int, tag: ir.Local, stop: ir.Expr, where: Where) -> ir.Local:
    """Skip the value behind a tag: of a group all its fields, and its end tag. Where that tag begins is the result.

    The numbers of the groups that are open lie in the scratch lane, which is the stack of this loop.
    """
    writer.emit(ir.Reserve(scratch, index(MAX_GROUPS)))
    arguments = (writer.position, tag, stop, ir.Used(scratch))
    writer.position, last_tag = writer.call("skip", partial(_skip, scratch=scratch), arguments, where)
    return last_tag


def _skip(writer: Writer, scratch: int) -> Contract:
    start, tag, stop, base = (writer.parameter(name, "i64") for name in ("start", "first", "stop", "base"))
    where = MESSAGE
    limit = writer.let("limit", add(ir.Binary("sub", END, BEGIN), 2))
    at, depth, rounds = writer.var("at", start), writer.var("depth", index(0)), writer.var("rounds", index(0))
    current, goes_on = writer.var("tag", tag), writer.var("goes_on", ir.Const("bool", value=True))
    last_tag = writer.var("last_tag", at)
    with writer.nested() as body:
        writer.position = at
        _expect_tag(writer, current, where)
        after = writer.var("next", at)
        cases = (*_scalar_cases(writer, after, stop, where), *_group_cases(writer, scratch, base, depth, current, where))
        writer.emit(ir.Switch(ir.Binary("and", current, index(7)), cases, _refused(writer, where)))
        writer.position = after
        within = ir.Binary("and", ir.Compare("ge", depth, index(0)), ir.Compare("le", depth, index(MAX_GROUPS)))
        writer.expect(within, "nesting", where, f"more than {MAX_GROUPS} groups within each other")
        writer.expect(ir.Compare("le", after, stop), "truncated", where, "a field goes beyond its message")
        writer.assign(at, after)
        _expect_position(writer, at, where)
        inner = _next_tag(writer, at, last_tag, current, where)
        writer.emit(ir.If(ir.Compare("gt", depth, index(0)), inner, (ir.Assign(goes_on.name, ir.Const("bool", value=False)),)))
        writer.assign(rounds, add(rounds, 1))
    invariant = (
        *writer.within(at),
        ir.Compare("ge", at, start),
        *writer.within(last_tag),
        ir.Compare("ge", depth, index(0)),
        ir.Compare("le", depth, index(MAX_GROUPS)),
        ir.Compare("ge", rounds, index(0)),
        ir.Compare("le", rounds, limit),
    )
    writer.emit(ir.While(ir.Binary("and", goes_on, ir.Compare("lt", rounds, limit)), block(body), invariant, rounds))
    writer.position = at
    writer.expect(ir.Compare("eq", depth, index(0)), "truncated", where, "the group has no end")
    has_stack = ir.Compare("ge", base, index(0)), ir.Compare("le", base, ir.Binary("sub", ir.Capacity(scratch), index(MAX_GROUPS)))
    ensured = *writer.within(at), ir.Compare("ge", at, start), *writer.within(last_tag)
    return Contract((start, tag, stop, base), (at, last_tag), (*writer.within(start), *writer.within(stop), *has_stack), ensured)


def _next_tag(writer: Writer, at: ir.Local, last_tag: ir.Local, current: ir.Local, where: Where) -> ir.Block:
    """Within a group: the tag of its next field."""
    with writer.nested() as body:
        writer.assign(last_tag, at)
        writer.position = at
        writer.assign(current, ir.Convert("i64", read_tag(writer, where)))
        writer.assign(at, writer.position)
    return block(body)


def _group_cases(
    writer: Writer, scratch: int, base: ir.Local, depth: ir.Local, tag: ir.Local, where: Where
) -> tuple[tuple[int, ir.Block], ...]:
    """The start of a group and its end, which must be of the same number."""
    number = ir.Binary("shr", tag, index(3))
    with writer.nested() as opened:
        writer.expect(ir.Compare("lt", depth, index(MAX_GROUPS)), "nesting", where, f"more than {MAX_GROUPS} groups within each other")
        writer.emit(ir.SetField(ir.Place(scratch, ir.Binary("add", base, depth)), number))
        writer.assign(depth, add(depth, 1))
    with writer.nested() as closed:
        writer.expect(ir.Compare("gt", depth, index(0)), "tag", where, "the end of a group that did not begin")
        innermost = ir.Get("i64", ir.Place(scratch, ir.Binary("add", base, ir.Binary("sub", depth, index(1)))))
        writer.expect(ir.Compare("eq", innermost, number), "tag", where, "the end of another group")
        writer.assign(depth, ir.Binary("sub", depth, index(1)))
    return (GROUP, block(opened)), (END_GROUP, block(closed))


def _expect_position(writer: Writer, at: ir.Local, where: Where) -> None:
    """True anyway; said for the proof, which does not follow the position through branches."""
    writer.expect(ir.Binary("and", *writer.within(at)), "truncated", where, "a field goes beyond its message")
