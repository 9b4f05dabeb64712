"""Routines that make texts of others: other letters, other parts, other sizes."""

from __future__ import annotations

from typing import Literal

from rosetta_jit.kernel.nodes import Binary, Capacity, Compare, Const, Copy, Expr, Fill, If, Local, Place, Select, While
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.texts.search import find, next_start, parts
from rosetta_jit.lowering.texts.views import LOST, View, has_room, is_between, kept, lane_of, parameters, put, room, scanning
from rosetta_jit.lowering.writer import MESSAGE, Contract, Writer, block

CASE_BIT = 0x20
"""What tells an ASCII letter from the same in the other case."""


def with_case(writer: Writer, view: View, case: Literal["lower", "upper"]) -> View:
    """A text with its ASCII letters in one case."""
    low, high = (ord("A"), ord("Z")) if case == "lower" else (ord("a"), ord("z"))

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        target = inner.parameter("target", "i64")
        fits = has_room(inner, target, Binary("sub", after, first))
        with scanning(inner, view.lane, first, after) as scan:
            turned = Binary("xor", scan.byte, Const("u8", CASE_BIT))
            place = Binary("add", target, Binary("sub", scan.at, first))
            put(inner, place, Select(is_between(scan.byte, low, high), turned, scan.byte))
        return Contract((first, after, target), (first,), (*known, *fits), ())

    size = writer.let("size", view.size)
    start = room(writer, size)
    writer.call(f"{case}_{view.memory}", make, (view.first, view.after, start), MESSAGE)
    return kept(writer, start, start, Binary("add", start, size), valid=view.valid)


def padded(writer: Writer, view: View, size: int) -> View:
    """A text of a size, NUL behind what is there. It must not be larger."""
    start = room(writer, index(size))
    length = writer.let("length", view.size)
    rest = Binary("sub", index(size), length)
    writer.emit(Copy(Place(lane_of(writer), start), view.address, length), Fill(Place(lane_of(writer), Binary("add", start, length)), rest))
    return kept(writer, start, start, add(start, size), valid=view.valid)


def replaced(writer: Writer, view: View, old: bytes, new: bytes) -> View:
    """A text with another in place of each occurrence of one, from the left."""
    found = writer.let("found", Binary("max", add(parts(writer, view, old), -1), index(0)))
    longer = max(0, len(new) - len(old))
    bound = Compare("le", found, index((1 << 56) // max(1, longer)))
    writer.expect(bound, "length", MESSAGE, "the text would be larger than any memory")
    size = writer.let("size", Binary("add", view.size, mul(found, longer)))
    start = room(writer, size)
    limit = writer.let("limit", Binary("add", start, size))
    for each in (Compare("le", start, limit), Compare("le", limit, Capacity(lane_of(writer)))):
        writer.expect(each, "length", MESSAGE, LOST)
    if view.lane == lane_of(writer):
        writer.expect(Compare("le", view.after, start), "length", MESSAGE, LOST)

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        target, end = inner.parameter("target", "i64"), inner.parameter("end_of_room", "i64")
        apart = (Compare("ge", target, after),) if view.lane == lane_of(inner) else ()
        fits = Compare("ge", target, index(0)), Compare("le", target, end), Compare("le", end, Capacity(lane_of(inner))), *apart
        cursor = _Cursor(inner, inner.var("to", target), end)
        start = inner.var("start", first)
        with inner.nested() as body:
            place = find(inner, view.lane, start, after, old)
            cursor.copy(View(view.lane, start, place))
            with inner.nested() as there:
                cursor.write(new)
            inner.emit(If(Compare("lt", place, after), block(there)))
            cursor.check()
            inner.assign(start, next_start(inner, place, after, old))
        limits = Compare("ge", start, first), Compare("le", start, add(after, 1)), *cursor.invariant(target)
        inner.emit(While(Compare("le", start, after), block(body), limits, start))
        return Contract((first, after, target, end), (cursor.to,), (*known, *fits), cursor.invariant(target))

    name = f"replace_{view.memory}_{old.hex()}_{new.hex()}"
    (after,) = writer.call(name, make, (view.first, view.after, start, limit), MESSAGE)
    return kept(writer, start, start, after, valid=view.valid)


class _Cursor:
    """Where the next bytes go. Each step asks for its room: the sum of all steps was counted before, which the proof does not see."""

    def __init__(self, writer: Writer, to: Local, end: Local) -> None:
        self.writer, self.to, self.end = writer, to, end

    def copy(self, view: View) -> None:
        size = self.writer.let("piece", view.size)
        self._fits(size)
        self.writer.emit(Copy(Place(lane_of(self.writer), self.to), view.address, size))
        self.writer.assign(self.to, Binary("add", self.to, size))

    def write(self, text: bytes) -> None:
        self._fits(index(len(text)))
        for number, byte in enumerate(text):
            put(self.writer, add(self.to, number), byte)
        self.writer.assign(self.to, add(self.to, len(text)))

    def invariant(self, target: Local) -> tuple[Expr, ...]:
        return Compare("ge", self.to, target), Compare("le", self.to, self.end)

    def check(self) -> None:
        self._fits(index(0))

    def _fits(self, size: Expr) -> None:
        self.writer.expect(Compare("le", size, Binary("sub", self.end, self.to)), "length", MESSAGE, "the text is larger than was counted")
