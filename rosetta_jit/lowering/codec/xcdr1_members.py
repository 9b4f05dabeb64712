"""Members as XCDR1 has them where they may be absent or come in any order: with an id and a length before each (DDS-XTypes 1.3, 7.4.1.2).

Both are of 16 bits, or an escape, behind which there are those of 32 bits. The long form is written, as Cyclone DDS does, since it always
fits. Lengths do not count padding; those of DDS-XTypes 1.1 do, up to a multiple of four, and are read, too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.nodes import Assign, Binary, Block, Compare, Const, Expr, If, Local, Select, Switch, While
from rosetta_jit.kernel.terms import BEGIN, END, index
from rosetta_jit.lowering.codec import leaves
from rosetta_jit.lowering.codec.fields import Fields
from rosetta_jit.lowering.codec.xcdr2_members import Seen, if_present, member_here, store_size
from rosetta_jit.lowering.writer import Where, Writer, block, integer
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.codec import Member, Parameter, Parameters

if TYPE_CHECKING:
    from rosetta_jit.lowering.codec.xcdr2_members import Walk

EXTENDED, LIST_END, IGNORE = 0x3F01, 0x3F02, 0x3F03
"""Ids that name no member."""
LONG_BYTES = 8
"""Those of an id and a length of 32 bits."""
SHORT_ID, SHORT_MUST_UNDERSTAND, SHORT_FOREIGN = 0x3FFF, 14, 15
LONG_ID, LONG_MUST_UNDERSTAND, FOREIGN = 0x0FFF_FFFF, 30, 31
"""Masks of the id, and the bits for what must be understood, and for ids that are an implementation's own."""
NOTHING = -1


def parameter(codec: Parameter, fields: Fields, writer: Writer, walk: Walk) -> None:
    """Read or write a member whose place is known, and whose id must be what belongs there; an optional one may have no size."""
    if codec.second:
        member_here(codec, fields, writer, walk)
        return
    member = codec.member
    where = fields.shown(member.path)
    if writer.direction != "decode":
        begin, inside = _write_head(writer, member, where, codec.order)
        if_present(member, fields, writer, lambda: _value(member, fields, writer, walk))
        store_size(writer, begin, inside, where, codec.order)
        return
    head = _read_head(writer, where, codec.order)
    writer.expect(Compare("eq", head.number, index(member.number)), "tag", where, "another member than the one that belongs here")
    if not member.optional:
        writer.expect(Compare("gt", head.size, index(0)), "length", where, "no such length")
    with writer.nested() as there:
        fields.appear(member.path)
        _read_value(member, head, fields, writer, walk)
    writer.emit(If(Compare("gt", head.size, index(0)), block(there)))
    writer.position = head.behind


def parameters(codec: Parameters, fields: Fields, writer: Writer, walk: Walk) -> None:
    """Read or write all members of a mutable struct, and the sentinel behind them."""
    where = fields.shown(codec.path)
    if writer.direction == "decode":
        fields.scatter(codec.path)
        _read(codec, fields, writer, walk)
        return
    for member in codec.members:
        if_present(member, fields, writer, lambda member=member: _write_member(codec, member, fields, writer, walk))
    leaves.align(writer, 4)
    writer.store(Const("u16", LIST_END | 1 << SHORT_MUST_UNDERSTAND), where, codec.order)
    writer.store(Const("u16", 0), where, codec.order)


def _value(member: Member, fields: Fields, writer: Writer, walk: Walk) -> None:
    with writer.origin_here():
        walk(member.value, fields, writer)


# --- reading -----------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Head:
    """What is before a member: its id, or `NOTHING`; whether it must be understood; its size, where it begins, and where it ends."""

    short: Local
    number: Local
    must: Local
    size: Local
    start: Local
    behind: Local


def _read(codec: Parameters, fields: Fields, writer: Writer, walk: Walk) -> None:
    where = fields.shown(codec.path)
    at, ended = writer.var("at", writer.position), writer.var("ended", Const("bool", value=False))
    seen = Seen.none(writer, fields, codec.members)
    with writer.nested() as body:
        writer.position = at
        leaves.align(writer, 4)
        head = _read_head(writer, where, codec.order)
        cases: list[tuple[int, Block]] = [(NOTHING, ())]
        for number, member in enumerate(codec.members):
            with writer.nested() as one:
                seen.once(number)
                if member.optional:
                    fields.appear(member.path)
                _read_value(member, head, fields, writer, walk)
            cases.append((member.number, block(one)))
        with writer.nested() as unknown:
            writer.expect(Compare("eq", head.must, index(0)), "tag", where, "an unknown member that must be understood")
        last = (Assign(ended.name, Const("bool", value=True)),)
        writer.emit(If(Compare("eq", head.short, index(LIST_END)), last, (Switch(head.number, tuple(cases), block(unknown)),)))
        writer.assign(at, head.behind)
    goes_on = Binary("and", Compare("lt", at, END), Compare("eq", ended, Const("bool", value=False)))
    writer.emit(While(goes_on, block(body), (Compare("ge", at, BEGIN), Compare("le", at, END)), at))
    writer.position = at
    writer.expect(ended, "truncated", where, "its members have no end")
    seen.complete()


def _read_head(writer: Writer, where: Where, order: str) -> _Head:
    begin = writer.position
    word = writer.let("head", integer(writer.load("u16", where, order)))
    short = writer.let("short", Binary("and", word, index(SHORT_ID)))
    own = Binary("or", short, _moved(word, SHORT_FOREIGN, FOREIGN))
    number = writer.var("number", Select(Compare("eq", short, index(IGNORE)), index(NOTHING), own))
    must = writer.var("must", _moved(word, SHORT_MUST_UNDERSTAND, 0))
    size = writer.var("size", integer(writer.load("u16", where, order)))
    start = writer.var("start", writer.position)
    with writer.nested() as extended:
        writer.expect(Compare("eq", size, index(LONG_BYTES)), "length", where, "no such length")
        long = writer.let("long", integer(writer.load("u32", where, order)))
        writer.assign(number, Binary("and", long, index(LONG_ID | 1 << FOREIGN)))
        writer.assign(must, _moved(long, LONG_MUST_UNDERSTAND, 0))
        writer.assign(size, integer(writer.load("u32", where, order)))
        writer.assign(start, writer.position)
    writer.emit(If(Compare("eq", short, index(EXTENDED)), block(extended)))
    inside = Binary("and", Compare("gt", start, begin), Compare("le", start, END))
    writer.expect(
        Binary("and", inside, Compare("ge", size, index(0))), "length", where, "no such length"
    )  # true anyway; said for the proof
    writer.require(size, where, at=start)
    return _Head(short, number, must, size, start, writer.let("behind", Binary("add", start, size)))


def _moved(word: Expr, source: int, target: int) -> Expr:
    """One bit of a word, elsewhere."""
    return Binary("shl", Binary("and", Binary("shr", word, index(source)), index(1)), index(target))


def _read_value(member: Member, head: _Head, fields: Fields, writer: Writer, walk: Walk) -> None:
    where = fields.shown(member.path)
    writer.position = head.start
    _value(member, fields, writer, walk)
    rest = writer.let("rest", Binary("sub", head.behind, writer.position))
    padded = Binary("and", Compare("gt", rest, index(0)), Compare("lt", rest, index(4)))
    whole = Binary("and", padded, Compare("eq", Binary("and", head.size, index(3)), index(0)))
    fits = Binary("or", Compare("eq", rest, index(0)), whole)
    writer.expect(fits, "length", where, "its content is not as long as it says")


# --- writing -----------------------------------------------------------------------------------------------------------------


def _write_member(codec: Parameters, member: Member, fields: Fields, writer: Writer, walk: Walk) -> None:
    where = fields.shown(member.path)
    leaves.align(writer, 4)
    begin, inside = _write_head(writer, member, where, codec.order)
    _value(member, fields, writer, walk)
    store_size(writer, begin, inside, where, codec.order)


def _write_head(writer: Writer, member: Member, where: Where, order: str) -> tuple[Expr, Expr]:
    """All but the length: where that will be written, and where it counts from."""
    writer.store(Const("u16", EXTENDED | 1 << SHORT_MUST_UNDERSTAND), where, order)
    writer.store(Const("u16", LONG_BYTES), where, order)
    writer.store(Const("u32", member.number | member.must_understand << LONG_MUST_UNDERSTAND), where, order)
    begin = writer.position
    writer.require(4, where, "no room for the message")
    writer.advance(4)
    return begin, writer.let("inside", writer.position)
