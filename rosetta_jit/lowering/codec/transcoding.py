"""From a `rosetta_jit.wire.self_describing.Tree` to kernels: messages that describe themselves, in another dialect.

Values are the same in both dialects, so the message is copied as a whole, and then the numbers that differ are written over it. Decoding
is one walk through the message, which checks it and notes those numbers. The lists around the one that is read lie on a stack, the scratch
lane.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index, mul
from rosetta_jit.lowering.codec.holder_fields import HolderFields, root_fields, span_of
from rosetta_jit.lowering.limits import MAX_LIST_NESTING
from rosetta_jit.lowering.writer import MESSAGE, References, Writer, block, integer
from rosetta_jit.model.layout import Layout
from rosetta_jit.model.types import Array, Bytes, Field, Int, Ref, Schema, Struct

if TYPE_CHECKING:
    from rosetta_jit.wire.self_describing import Header, Scalar, Tree

SCALAR_BYTES = 8
"""Bytes of the largest scalar."""

SCALAR, TEXT, LIST, WHOLE = range(4)
"""What codes announce: so many bytes, counted bytes, a list, a message."""

SCRATCH_STRIDE = 8
CHANGE = Struct("change", (Field("at", Int(64)), Field("number", Int(64))))
MESSAGES = Schema(
    {"change": CHANGE, "message": Struct("message", (Field("data", Bytes()), Field("changes", Array(Ref("change")))))},
)
"""What lies between decoding and encoding: the message, and which i32 of it become others."""


def transcoding_kernel(tree: Tree, layout: Layout, direction: nodes.Direction, references: References) -> ir.Kernel:
    """The kernel that reads messages, or that measures or writes what they become."""
    writer = Writer(direction, [*(lane.stride for lane in layout.lanes), SCRATCH_STRIDE], references=references)
    with writer.nested() as body:
        writer.position = BEGIN if direction != "size" else index(0)
        fields = root_fields(writer, layout, borrow=True)
        writer.expect(nodes.Compare("lt", ROW, nodes.Capacity(0)), "index", MESSAGE, "the holder has no row for the message")
        if direction == "decode":
            writer.emit(nodes.Fill(nodes.Place(0, ROW), index(layout.lanes[0].stride)))
            _Walk(writer, fields, tree).read()
        else:
            _write(writer, fields)
        writer.emit(nodes.Return(writer.position))
    return ir.Kernel(f"message of {tree.there}", direction, tuple(writer.strides), (block(body),), tuple(writer.sites))


def _write(writer: Writer, fields: HolderFields) -> None:
    stored = fields.stored(("data",))
    begin = writer.position
    writer.require(stored.size, MESSAGE, "no room for the message")
    if writer.direction == "encode":
        fields.copy_bytes(("data",), stored)
        changes = fields.stored(("changes",))
        elements = fields.elements(("changes",), changes)
        number = nodes.Local("i64", writer.fresh("i"))
        with writer.nested() as each:
            change = elements.at(number)
            at = writer.let("change", _known(change.get(("at",))))
            inside = nodes.Binary(
                "and", nodes.Compare("ge", at, index(0)), nodes.Compare("le", at, nodes.Binary("sub", stored.size, index(4)))
            )
            writer.expect(inside, "length", MESSAGE, "the holder is damaged")
            writer.emit(nodes.Store(add(begin, at), nodes.Convert("i32", _known(change.get(("number",))))))
        writer.emit(nodes.For(number.name, changes.size, block(each)))
    writer.advance(stored.size)


def _known(value: nodes.Expr | None) -> nodes.Expr:
    assert value is not None
    return value


class _Walk:
    """The walk through a message.

    Its variables are the position, how many elements are left in the list, the code that all of them have or 0, and how many lists are
    around it; of the element that is read its code, what that is in the other dialect, the place behind it, and what its code announces:
    the kind, the bytes of a scalar, and the code of a list's elements.
    """

    def __init__(self, writer: Writer, fields: HolderFields, tree: Tree) -> None:
        self.writer, self.fields, self.tree = writer, fields, tree
        self.stack = len(fields.layout.lanes)
        self.at = writer.var("at", BEGIN)
        self.left, self.unit, self.depth = (writer.var(name, index(value)) for name, value in (("left", 1), ("unit", 0), ("depth", 0)))
        self.code, self.there, self.after = (writer.var(name, index(0)) for name in ("code", "there", "after"))
        self.kind, self.size, self.inner = (writer.var(name, index(0)) for name in ("kind", "size", "inner"))
        self.rounds = writer.var("rounds", index(0))
        self.changes = span_of(fields.find(("changes",)))

    def read(self) -> None:
        """Go through the whole message."""
        writer = self.writer
        size = writer.let("size", nodes.Binary("sub", END, BEGIN))
        self.fields.put_bytes(("data",), BEGIN, size)
        writer.emit(nodes.Reserve(self.stack, index(2 * MAX_LIST_NESTING)), nodes.Advance(self.stack, index(2 * MAX_LIST_NESTING)))
        self.expect_list(BEGIN)
        limit = writer.let("limit", add(mul(size, 2), 2))
        goes_on = nodes.Binary("or", nodes.Compare("gt", self.left, index(0)), nodes.Compare("gt", self.depth, index(0)))
        with writer.nested() as body:
            writer.emit(nodes.If(nodes.Compare("eq", self.left, index(0)), self.close(), self.element()))
            writer.assign(self.rounds, add(self.rounds, 1))
        invariant = (
            *writer.within(self.at),
            *self.between(self.depth, MAX_LIST_NESTING),
            *self.between(self.left, 1 << 31),
            nodes.Compare("ge", self.rounds, index(0)),
            nodes.Compare("le", self.rounds, limit),
        )
        writer.emit(nodes.While(nodes.Binary("and", goes_on, nodes.Compare("lt", self.rounds, limit)), block(body), invariant, self.rounds))
        writer.expect(
            nodes.Binary("and", nodes.Compare("eq", self.left, index(0)), nodes.Compare("eq", self.depth, index(0))),
            "truncated",
            MESSAGE,
            "the message ends here",
            at=self.at,
        )
        writer.expect(nodes.Compare("eq", self.at, END), "trailing", MESSAGE, "bytes are left over", at=self.at)
        self.fields.set_span(self.fields.find(("changes",)), index(0), writer.let("changes", nodes.Used(self.changes.lane)))
        writer.position = self.at

    @staticmethod
    def between(value: nodes.Expr, most: int) -> tuple[nodes.Expr, nodes.Expr]:
        return nodes.Compare("ge", value, index(0)), nodes.Compare("le", value, index(most))

    def close(self) -> nodes.Block:
        """The list is at its end: go on in the one around it."""
        writer = self.writer
        with writer.nested() as body:
            writer.expect(nodes.Compare("gt", self.depth, index(0)), "nesting", MESSAGE, "more lists end than begin", at=self.at)
            writer.assign(self.depth, nodes.Binary("sub", self.depth, index(1)))
            row = mul(self.depth, 2)
            left = writer.let("left_around", nodes.Get("i64", nodes.Place(self.stack, row)))
            writer.expect(nodes.Binary("and", *self.between(left, 1 << 31)), "count", MESSAGE, "the holder is damaged", at=self.at)
            writer.assign(self.left, left)
            writer.assign(self.unit, nodes.Get("i64", nodes.Place(self.stack, add(row, 1))))
        return block(body)

    def element(self) -> nodes.Block:
        """The next element of the list."""
        writer = self.writer
        with writer.nested() as body:
            writer.assign(self.left, nodes.Binary("sub", self.left, index(1)))
            writer.assign(self.code, self.unit)
            writer.assign(self.after, self.at)
            has_code = writer.let("has_code", nodes.Compare("eq", self.unit, index(0)))
            writer.emit(nodes.If(has_code, self.read_code()))
            writer.assign(self.there, self.code)
            writer.emit(nodes.Switch(self.code, tuple(self.cases()), self.refused("no code of this dialect")))
            bounded = nodes.Binary("and", *self.between(self.size, SCALAR_BYTES))
            writer.expect(bounded, "length", MESSAGE, "the holder is damaged")  # true anyway; said for the proof
            self.values()
            writer.expect(nodes.Binary("and", *writer.within(self.after)), "truncated", MESSAGE, "the message ends here", at=END)
            differs = nodes.Binary("and", has_code, nodes.Compare("ne", self.there, self.code))
            with writer.nested() as noted:
                self.note(self.at, self.there)
            writer.emit(nodes.If(differs, block(noted)))
            writer.assign(self.at, self.after)
        return block(body)

    def read_code(self) -> nodes.Block:
        writer = self.writer
        with writer.nested() as body:
            writer.position = self.at
            writer.assign(self.code, integer(writer.load("i32", MESSAGE)))
            writer.assign(self.after, writer.position)
        return block(body)

    def cases(self) -> Iterator[tuple[int, nodes.Block]]:
        """Each code, and the statements for the values that it announces."""
        tree = self.tree
        for scalar in tree.scalars:
            kind = TEXT if scalar.size is None else SCALAR
            yield scalar.code, self.announced(kind, scalar, scalar.there)
            there = None if scalar.there is None else tree.list_code | scalar.there
            yield tree.list_code | scalar.code, self.announced(LIST, scalar, there)
        yield tree.list_code, self.announced(LIST, None, tree.list_code)
        yield tree.whole_code, self.announced(WHOLE, None, tree.whole_code)

    def announced(self, kind: int, scalar: Scalar | None, there: int | None) -> nodes.Block:
        """What follows the code: note it for `values`, where all codes of a kind are treated together."""
        if there is None:
            assert scalar is not None
            return self.refused(f"{self.tree.there} has no {scalar.name}")
        size = 0 if scalar is None else scalar.size or 0
        listed = index(scalar.code) if kind == LIST and scalar is not None else index(0)
        with self.writer.nested() as body:
            for variable, value in ((self.kind, index(kind)), (self.size, index(size)), (self.inner, listed), (self.there, index(there))):
                self.writer.assign(variable, value)
        return block(body)

    def values(self) -> None:
        """Move on behind the value; into a list, unless all its elements have one size."""
        writer = self.writer
        cases = {SCALAR: self.scalar, TEXT: self.text, LIST: self.list_of, WHOLE: self.whole}
        blocks: list[tuple[int, nodes.Block]] = []
        for kind, read in cases.items():
            with writer.nested() as body:
                read()
            blocks.append((kind, block(body)))
        writer.emit(nodes.Switch(self.kind, tuple(blocks), self.refused("no code of this dialect")))

    def scalar(self) -> None:
        writer = self.writer
        writer.assign(self.after, nodes.Binary("add", self.after, self.size))
        for header in self.tree.headers:
            with writer.nested() as noted:
                writer.emit(*self.header(header))
            writer.emit(nodes.If(nodes.Compare("eq", self.code, index(header.words[0])), block(noted)))

    def text(self) -> None:
        self.writer.position = self.after
        count = self.count("length")
        self.writer.assign(self.after, nodes.Binary("add", self.writer.position, count))

    def list_of(self) -> None:
        writer = self.writer
        writer.position = self.after
        count = self.count("count")
        writer.assign(self.after, writer.position)
        with writer.nested() as skipped:
            writer.assign(self.after, nodes.Binary("add", self.after, nodes.Binary("mul", count, self.size)))
        with writer.nested() as opened:
            self.open_list(count, self.inner)
        writer.emit(nodes.If(nodes.Compare("gt", self.size, index(0)), block(skipped), block(opened)))

    def whole(self) -> None:
        self.expect_list(self.after)
        self.open_list(index(1), index(0))

    def count(self, kind: str) -> nodes.Local:
        """The number before the bytes of a text, or before the elements of a list."""
        writer, at = self.writer, self.writer.position
        count = writer.let("count", integer(writer.load("i32", MESSAGE)))
        writer.expect(nodes.Compare("ge", count, index(0)), kind, MESSAGE, "must not be negative", at=at)
        return count

    def open_list(self, count: nodes.Expr, unit: nodes.Expr) -> None:
        """Go on with the elements of a list, and then with what is behind it."""
        writer, row = self.writer, mul(self.depth, 2)
        writer.expect(
            nodes.Compare("lt", self.depth, index(MAX_LIST_NESTING)),
            "nesting",
            MESSAGE,
            f"more than {MAX_LIST_NESTING} lists within each other",
            at=self.at,
        )
        writer.emit(
            nodes.SetField(nodes.Place(self.stack, row), self.left), nodes.SetField(nodes.Place(self.stack, add(row, 1)), self.unit)
        )
        writer.emit(
            nodes.Assign(self.depth.name, add(self.depth, 1)), nodes.Assign(self.left.name, count), nodes.Assign(self.unit.name, unit)
        )

    def expect_list(self, at: nodes.Expr) -> None:
        """A message is a list, whatever a reader would take."""
        writer = self.writer
        writer.require(4, MESSAGE, at=at)
        codes = nodes.Binary("and", nodes.Load("i32", at), nodes.Const("i32", self.tree.whole_code | self.tree.list_code))
        writer.expect(nodes.Compare("eq", codes, nodes.Const("i32", self.tree.list_code)), "tag", MESSAGE, "a message is a list", at=at)

    def refused(self, why: str) -> nodes.Block:
        with self.writer.nested() as body:
            self.writer.expect(nodes.Const("bool", value=False), "tag", MESSAGE, why, at=self.at)
        return block(body)

    def header(self, header: Header) -> tuple[nodes.Stmt, ...]:
        """Note the number that differs, if this element and those behind it are a header."""
        writer = self.writer
        with writer.nested() as there:
            writer.require(header.size, MESSAGE, at=self.at)
            known: nodes.Expr = nodes.Compare("eq", self.unit, index(0))
            for offset, word in header.words.items():
                known = nodes.Binary("and", known, nodes.Compare("eq", nodes.Load("i32", add(self.at, offset)), nodes.Const("i32", word)))
            with writer.nested() as found:
                number = writer.let("number", integer(nodes.Load("i32", add(self.at, header.at))))
                changed = nodes.Binary("or", nodes.Binary("and", number, index(header.keep)), index(header.put))
                self.note(add(self.at, header.at), changed)
            writer.emit(nodes.If(known, block(found)))
        fits = nodes.Compare("ge", nodes.Binary("sub", END, self.at), index(header.size))
        return (nodes.If(fits, block(there)),)

    def note(self, at: nodes.Expr, number: nodes.Expr) -> None:
        """Note that an i32 of the message becomes another one."""
        writer, lane = self.writer, self.changes.lane
        writer.emit(nodes.Reserve(lane, index(1)))
        row = writer.let("row", nodes.Used(lane))
        writer.emit(nodes.Advance(lane, index(1)))
        writer.emit(
            nodes.SetField(nodes.Place(lane, row), nodes.Binary("sub", at, BEGIN)), nodes.SetField(nodes.Place(lane, row, 8), number)
        )
