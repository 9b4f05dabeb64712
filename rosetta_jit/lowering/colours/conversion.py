"""What all conversions of pixels share: encodings, pictures, and how their bytes are reached, of which each is checked."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Advance, Arithmetic, Binary, Compare, Const, Convert, Expr, Get, Load, Place, Reserve, SetField, Used
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.lowering.limits import MAX_COLOUR_SIDE
from rosetta_jit.lowering.texts.views import View, lane_of, sound
from rosetta_jit.lowering.writer import Where, Writer
from rosetta_jit.startup.dataclass import dataclass

PACKED = {"yuv422": (1, 0, 2), "yuv422_yuy2": (0, 1, 3)}
"""Of each pair of pixels in four bytes: where the first luma lies, the other two bytes behind it; U, V."""
HALVED = {"nv12": (0, 1), "nv21": (1, 0)}
"""Luma in rows, and behind it rows of U and V for two pixels of two rows each: where U and V lie."""
MOSAICS = {f"bayer_{pattern}8": pattern for pattern in ("rggb", "bggr", "gbrg", "grbg")}
"""The colours of the first two rows and columns."""
ENCODINGS = (*MOSAICS, *PACKED, *HALVED)

CHANNELS = 3


@dataclass(frozen=True, slots=True)
class Picture:
    """What is converted: its bytes, its size in pixels, and how far apart its rows begin."""

    pixels: View
    width: Expr
    height: Expr
    step: Expr


@dataclass(frozen=True, slots=True)
class Conversion:
    """A picture in one encoding that becomes one in another, and what both directions do with its bytes and rows."""

    writer: Writer
    encoding: str
    picture: Picture
    where: Where
    line: str

    def room(self, rows: Expr, row: Expr) -> View:
        """New bytes for so many rows."""
        writer, lane = self.writer, lane_of(self.writer)
        total = writer.checked("mul", rows, row, self.where, line=self.line)
        self.must(Compare("ge", total, index(0)), "no rows")
        writer.emit(Reserve(lane, total))
        first = writer.let("computed", Used(lane))
        writer.emit(Advance(lane, total))
        return sound(writer, View(lane, first, writer.let("after", add(first, total))))

    def must(self, condition: Expr, why: str) -> None:
        self.writer.expect(condition, "image", self.where, why, line=self.line)

    def check_rows(self, size: Expr, least: Expr) -> None:
        """Check the width, the height, and that rows of at least so many bytes lie apart."""
        picture = self.picture
        for side, name in ((picture.width, "width"), (picture.height, "height")):
            self.must(Compare("ge", side, index(2)), f"a {name} below 2")
            self.must(Compare("le", side, index(MAX_COLOUR_SIDE)), f"a {name} above {MAX_COLOUR_SIDE}")
        self.must(Compare("ge", picture.step, least), "rows that overlap")
        self.must(Compare("le", picture.step, size), "fewer bytes than a row has")

    def check_size(self, size: Expr, rows: Expr) -> None:
        """Check that there are the bytes of so many rows."""
        wanted = self.writer.checked("mul", rows, self.picture.step, self.where, line=self.line)
        self.must(Compare("eq", size, wanted), "the pixels are not as many as the width, the height and the step say")

    def source(self, number: Expr, size: Expr) -> Expr:
        """The byte at which a row of the picture begins."""
        apart = self.writer.checked("mul", number, self.picture.step, self.where)
        return self.begin(self.picture.pixels, apart, size)

    def begin(self, view: View, apart: Expr, size: Expr) -> Expr:
        """A row of so many bytes, so far behind the begin of a view; that it lies within follows from the size of all."""
        self.must(Compare("ge", apart, index(0)), "a row outside of the picture")
        self.must(Compare("le", apart, Binary("sub", view.size, size)), "a row outside of the picture")
        return self.writer.let("begin", Binary("add", view.first, apart))

    def target(self, view: View, number: Expr, row: Expr) -> Expr:
        """The byte at which a row of the result begins."""
        return self.begin(view, self.writer.checked("mul", number, row, self.where), row)

    def byte(self, at: Expr) -> Expr:
        lane = self.picture.pixels.lane
        value = Load("u8", at) if lane is None else Get("u8", Place(lane, at))
        return self.writer.let("byte", Convert("i32", value))

    def put(self, lane: int | None, at: Expr, values: tuple[Expr, ...]) -> None:
        assert lane is not None
        for number, value in enumerate(values):
            self.writer.emit(SetField(Place(lane, add(at, number)), Convert("u8", value)))


def i32(op: Arithmetic, left: Expr, right: Expr | int) -> Expr:
    """What is computed of a pixel."""
    return Binary(op, left, constant(right) if isinstance(right, int) else right)


def constant(value: int) -> Expr:
    """A number of a pixel, or a weight."""
    return Const("i32", value)
