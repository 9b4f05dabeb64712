"""Members of mutable structs, each with its id and its length before it (DDS-XTypes 1.3, 7.4.3.4.2: PL_CDR2)."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.kernel.nodes import Binary, Block, Compare, Const, Convert, Expr, If, Local, Select, Store, Switch, While
from rosetta_jit.kernel.terms import BEGIN, add, index
from rosetta_jit.lowering.codec import counts, leaves
from rosetta_jit.lowering.codec.absent_members import elements_given, give
from rosetta_jit.lowering.codec.fields import Fields
from rosetta_jit.lowering.limits import MAX_ABSENT, MAX_ABSENT_EACH
from rosetta_jit.lowering.writer import Where, Writer, block, integer
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.codec import Codec, Member, Members, Order, Parameter

if TYPE_CHECKING:
    Walk = Callable[[Codec, Fields, Writer], None]

ID_BITS, CODE_SHIFT, MUST_UNDERSTAND = 0x0FFF_FFFF, 28, 1 << 31
OWN_LENGTH = 4
"""The first length code with a word of its own for the length; codes above share it with the member's first word."""
UNITS = {5: 1, 6: 4, 7: 8}
"""By what that first word is multiplied, and four is added."""


def members(codec: Members, fields: Fields, writer: Writer, walk: Walk) -> None:
    """Read or write all members, and the number of their bytes before them."""
    where, begin = fields.shown(codec.path), writer.position
    if writer.direction == "decode":
        fields.scatter(codec.path)
        size = writer.let("size", integer(writer.load("u32", where, codec.order)))
        writer.require(size, where)
        _read(codec, fields, writer, walk, writer.let("stop", Binary("add", writer.position, size)))
        return
    writer.require(4, where, "no room for the message")
    writer.advance(4)
    inside = writer.let("inside", writer.position)
    for member in codec.members:
        if_present(member, fields, writer, lambda member=member: _write_member(member, codec.order, fields, writer, walk))
    store_size(writer, begin, inside, where, codec.order)


@dataclass(frozen=True, slots=True)
class Seen:
    """Which members have come, a bit each: each once, and all that are owed."""

    writer: Writer
    fields: Fields
    members: tuple[Member, ...]
    words: tuple[Local, ...]

    @classmethod
    def none(cls, writer: Writer, fields: Fields, members: tuple[Member, ...]) -> Seen:
        """Before the first member."""
        return cls(writer, fields, members, tuple(writer.var("seen", Const("u64", 0)) for _ in range(0, len(members), 64)))

    def once(self, number: int) -> None:
        """The member of that number comes now, and has not before."""
        word, bit = self.words[number // 64], Const("u64", 1 << number % 64)
        new = Compare("eq", Binary("and", word, bit), Const("u64", 0))
        self.writer.expect(new, "tag", self.fields.shown(self.members[number].path), "a member comes twice")
        self.writer.assign(word, Binary("or", word, bit))

    def complete(self) -> None:
        """Behind the last member: what did not come gets its value, if it is neither optional nor owed."""
        most = MAX_ABSENT_EACH if self.fields.where.indices else MAX_ABSENT
        for number, member in enumerate(self.members):
            if member.optional:
                continue
            came = Binary("and", self.words[number // 64], Const("u64", 1 << number % 64))
            if member.owed or elements_given(member.value) > most:
                there = Compare("ne", came, Const("u64", 0))
                self.writer.expect(there, "missing", self.fields.shown(member.path), "a member did not come")
                continue
            with self.writer.nested() as absent:
                give(member.value, self.fields, self.writer)
            self.writer.emit(If(Compare("eq", came, Const("u64", 0)), block(absent)))


# --- reading -----------------------------------------------------------------------------------------------------------------


def _read(codec: Members, fields: Fields, writer: Writer, walk: Walk, stop: Expr) -> None:
    where = fields.shown(codec.path)
    at = writer.var("at", writer.position)
    seen = Seen.none(writer, fields, codec.members)
    with writer.nested() as body:
        writer.position = at
        leaves.align(writer, 4)
        head = writer.let("head", integer(writer.load("u32", where, codec.order)))
        start, size = _extent(writer, codec.order, head, where)
        writer.require(size, where, at=start)
        behind = writer.let("behind", Binary("add", start, size))
        inside = Binary("and", Compare("le", behind, stop), Compare("gt", behind, at))
        writer.expect(inside, "truncated", where, "a member goes beyond its struct")
        cases: list[tuple[int, Block]] = []
        for number, member in enumerate(codec.members):
            with writer.nested() as one:
                writer.position = start
                seen.once(number)
                if member.optional:
                    fields.appear(member.path)
                walk(member.value, fields, writer)
                fits = Compare("eq", writer.position, behind)
                writer.expect(fits, "length", fields.shown(member.path), "its content is not as long as it says")
            cases.append((member.number, block(one)))
        with writer.nested() as unknown:
            known = Compare("eq", Binary("and", head, index(MUST_UNDERSTAND)), index(0))
            writer.expect(known, "tag", where, "an unknown member that must be understood")
        writer.emit(Switch(Binary("and", head, index(ID_BITS)), tuple(cases), block(unknown)))
        writer.assign(at, behind)
    invariant = (Compare("ge", at, BEGIN), Compare("le", at, stop))
    writer.emit(While(Compare("lt", at, stop), block(body), invariant, at))
    writer.position = at
    seen.complete()


def _extent(writer: Writer, order: Order, head: Expr, where: Where) -> tuple[Expr, Expr]:
    """The begin of a member, and its size in bytes."""
    code = writer.let("code", Binary("and", Binary("shr", head, index(CODE_SHIFT)), index(7)))
    start, size = writer.var("start", writer.position), writer.var("size", index(8))
    for short in (0, 1, 2):
        writer.assign(size, Select(Compare("eq", code, index(short)), index(1 << short), size))
    with writer.nested() as own_length:
        word = writer.let("length", integer(writer.load("u32", where, order)))
        writer.assign(start, Select(Compare("eq", code, index(OWN_LENGTH)), writer.position, start))
        unit: Expr = index(1)
        for long, factor in UNITS.items():
            unit = Select(Compare("eq", code, index(long)), index(factor), unit)
        total = Binary("mul", word, writer.let("unit", unit))
        writer.assign(size, Select(Compare("eq", code, index(OWN_LENGTH)), word, Binary("add", total, index(4))))
    writer.emit(If(Compare("ge", code, index(OWN_LENGTH)), block(own_length)))
    inside = Binary("and", Compare("ge", start, BEGIN), Compare("le", start, add(writer.position, 4)))
    sane = Binary("and", Compare("ge", size, index(0)), Compare("le", size, index(1 << 40)))
    writer.expect(Binary("and", inside, sane), "length", where, "no such length")  # true anyway; said for the proof
    return start, size


# --- writing -----------------------------------------------------------------------------------------------------------------


def if_present(member: Member, fields: Fields, writer: Writer, write: Callable[[], None]) -> None:
    """Write a member, or nothing where it is optional and absent."""
    if not member.optional:
        write()
        return
    at = writer.cursor()
    with writer.nested() as there:
        writer.position = at
        write()
        writer.settle()
        writer.assign(at, writer.position)
    writer.emit(If(fields.present(member.path), block(there)))
    writer.position = at


def member_here(codec: Parameter, fields: Fields, writer: Writer, walk: Walk) -> None:
    """Read or write a member whose place is known: its id must be what belongs there."""
    member, where = codec.member, fields.shown(codec.member.path)
    if writer.direction != "decode":
        _write_member(member, codec.order, fields, writer, walk)
        return
    head = writer.let("head", integer(writer.load("u32", where, codec.order)))
    right = Compare("eq", Binary("and", head, index(ID_BITS)), index(member.number))
    writer.expect(right, "tag", where, "another member than the one that belongs here")
    start, size = _extent(writer, codec.order, head, where)
    writer.require(size, where, at=start)
    behind = writer.let("behind", Binary("add", start, size))
    writer.position = start
    fields.appear(member.path)
    walk(member.value, fields, writer)
    writer.expect(Compare("eq", writer.position, behind), "length", where, "its content is not as long as it says")


def _write_member(member: Member, order: Order, fields: Fields, writer: Writer, walk: Walk) -> None:
    where = fields.shown(member.path)
    leaves.align(writer, 4)
    head = member.number | member.length_code << CODE_SHIFT | (MUST_UNDERSTAND if member.must_understand else 0)
    writer.store(Const("u32", head), where, order)
    if member.length_code != OWN_LENGTH:
        walk(member.value, fields, writer)
        return
    begin = writer.position
    writer.require(4, where, "no room for the message")
    writer.advance(4)
    inside = writer.let("inside", writer.position)
    walk(member.value, fields, writer)
    store_size(writer, begin, inside, where, order)


def store_size(writer: Writer, begin: Expr, inside: Expr, where: Where, order: str) -> None:
    """What was written since then, as the size that stands before it."""
    if writer.direction == "encode":
        size = writer.let("size", Binary("sub", writer.position, inside))
        writer.expect(Compare("lt", size, index(counts.LIMITS["u32"])), "range", where, "too long for the wire")
        writer.emit(Store(begin, Convert("u32", size), ">" if order == ">" else "<"))
