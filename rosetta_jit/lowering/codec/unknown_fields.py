"""Fields that a schema does not know: skipped by their wire type, groups to their matching end."""

from __future__ import annotations

from functools import partial

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.lowering.codec.holder_fields import HolderFields
from rosetta_jit.lowering.codec.varint import read_length, read_tag, read_varint
from rosetta_jit.lowering.limits import MAX_GROUPS
from rosetta_jit.lowering.writer import MESSAGE, Contract, Where, Writer, block

VARINT, FIXED64, DELIMITED, GROUP, END_GROUP, FIXED32 = 0, 1, 2, 3, 4, 5


def skip_unknown(writer: Writer, fields: HolderFields, tag: nodes.Local, stop: nodes.Expr) -> None:
    """Skip the value behind a tag."""
    skip(writer, len(fields.layout.lanes), tag, stop, fields.where)


def _expect_tag(writer: Writer, tag: nodes.Expr, where: Where) -> None:
    usable = nodes.Binary("and", nodes.Compare("ge", tag, index(8)), nodes.Compare("lt", tag, index(1 << 32)))
    writer.expect(usable, "tag", where, "not a field's number")


def _scalar_cases(writer: Writer, after: nodes.Local, stop: nodes.Expr, where: Where) -> tuple[tuple[int, nodes.Block], ...]:
    """Values that are not groups, by wire type. What goes beyond ``stop`` is noticed by the caller."""
    cases: list[tuple[int, nodes.Block]] = []
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


def _refused(writer: Writer, where: Where) -> nodes.Block:
    failure = writer.failure("tag", where, "no wire type")
    return (nodes.Expect(nodes.Const("bool", value=False), failure),)


def skip(writer: Writer, scratch: int, tag: nodes.Local, stop: nodes.Expr, where: Where) -> nodes.Local:
    """Skip the value behind a tag: of a group all its fields, and its end tag. Where that tag begins is the result.

    The numbers of the groups that are open lie in the scratch lane, which is the stack of this loop.
    """
    writer.emit(nodes.Reserve(scratch, index(MAX_GROUPS)))
    arguments = (writer.position, tag, stop, nodes.Used(scratch))
    writer.position, last_tag = writer.call("skip", partial(_skip, scratch=scratch), arguments, where)
    return last_tag


def _skip(writer: Writer, scratch: int) -> Contract:
    start, tag, stop, base = (writer.parameter(name, "i64") for name in ("start", "first", "stop", "base"))
    where = MESSAGE
    limit = writer.let("limit", add(nodes.Binary("sub", END, BEGIN), 2))
    at, depth, rounds = writer.var("at", start), writer.var("depth", index(0)), writer.var("rounds", index(0))
    current, goes_on = writer.var("tag", tag), writer.var("goes_on", nodes.Const("bool", value=True))
    last_tag = writer.var("last_tag", at)
    with writer.nested() as body:
        writer.position = at
        _expect_tag(writer, current, where)
        after = writer.var("next", at)
        cases = (*_scalar_cases(writer, after, stop, where), *_group_cases(writer, scratch, base, depth, current, where))
        writer.emit(nodes.Switch(nodes.Binary("and", current, index(7)), cases, _refused(writer, where)))
        writer.position = after
        within = nodes.Binary("and", nodes.Compare("ge", depth, index(0)), nodes.Compare("le", depth, index(MAX_GROUPS)))
        writer.expect(within, "nesting", where, f"more than {MAX_GROUPS} groups within each other")
        writer.expect(nodes.Compare("le", after, stop), "truncated", where, "a field goes beyond its message")
        writer.assign(at, after)
        _expect_position(writer, at, where)
        inner = _next_tag(writer, at, last_tag, current, where)
        writer.emit(nodes.If(nodes.Compare("gt", depth, index(0)), inner, (nodes.Assign(goes_on.name, nodes.Const("bool", value=False)),)))
        writer.assign(rounds, add(rounds, 1))
    invariant = (
        *writer.within(at),
        nodes.Compare("ge", at, start),
        *writer.within(last_tag),
        nodes.Compare("ge", depth, index(0)),
        nodes.Compare("le", depth, index(MAX_GROUPS)),
        nodes.Compare("ge", rounds, index(0)),
        nodes.Compare("le", rounds, limit),
    )
    writer.emit(nodes.While(nodes.Binary("and", goes_on, nodes.Compare("lt", rounds, limit)), block(body), invariant, rounds))
    writer.position = at
    is_read = nodes.Binary("and", nodes.Compare("eq", depth, index(0)), nodes.Compare("gt", at, start))  # the latter for the proof
    writer.expect(is_read, "truncated", where, "the group has no end")
    ensured = *writer.behind(start, at), *writer.within(last_tag)
    return Contract(
        (start, tag, stop, base), (at, last_tag), (*writer.within(start), *writer.within(stop), *_has_stack(scratch, base)), ensured
    )


def _has_stack(scratch: int, base: nodes.Local) -> tuple[nodes.Expr, ...]:
    """The claim that the scratch lane has room for the numbers of all groups."""
    room = nodes.Binary("sub", nodes.Capacity(scratch), index(MAX_GROUPS))
    return nodes.Compare("ge", base, index(0)), nodes.Compare("le", base, room)


def _next_tag(writer: Writer, at: nodes.Local, last_tag: nodes.Local, current: nodes.Local, where: Where) -> nodes.Block:
    """Within a group: the tag of its next field."""
    with writer.nested() as body:
        writer.assign(last_tag, at)
        writer.position = at
        writer.assign(current, nodes.Convert("i64", read_tag(writer, where)))
        writer.assign(at, writer.position)
    return block(body)


def _group_cases(
    writer: Writer, scratch: int, base: nodes.Local, depth: nodes.Local, tag: nodes.Local, where: Where
) -> tuple[tuple[int, nodes.Block], ...]:
    """The start of a group and its end, which must be of the same number."""
    number = nodes.Binary("shr", tag, index(3))
    with writer.nested() as opened:
        writer.expect(nodes.Compare("lt", depth, index(MAX_GROUPS)), "nesting", where, f"more than {MAX_GROUPS} groups within each other")
        writer.emit(nodes.SetField(nodes.Place(scratch, nodes.Binary("add", base, depth)), number))
        writer.assign(depth, add(depth, 1))
    with writer.nested() as closed:
        writer.expect(nodes.Compare("gt", depth, index(0)), "tag", where, "the end of a group that did not begin")
        innermost = nodes.Get("i64", nodes.Place(scratch, nodes.Binary("add", base, nodes.Binary("sub", depth, index(1)))))
        writer.expect(nodes.Compare("eq", innermost, number), "tag", where, "the end of another group")
        writer.assign(depth, nodes.Binary("sub", depth, index(1)))
    return (GROUP, block(opened)), (END_GROUP, block(closed))


def _expect_position(writer: Writer, at: nodes.Local, where: Where) -> None:
    """True anyway; said for the proof, which does not follow the position through branches."""
    writer.expect(nodes.Binary("and", *writer.within(at)), "truncated", where, "a field goes beyond its message")
