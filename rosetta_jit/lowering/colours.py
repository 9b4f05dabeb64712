"""Pixels as cameras send them, made RGB: mosaics of Bayer filters, and YUV with a pair of chroma values for several pixels. RGB made YUV.

Encodings have ROS's names (sensor_msgs/image_encodings.h), and all have 8 bits. Where c(x) is x, at least 0 and at most 255:

    YUV      y = 1220542 * max(Y - 16, 0) + 2**19, u = U - 128, v = V - 128            BT.601, limited range, times 2**20
             R = c((y + 1673527 * v) >> 20)   G = c((y - 852492 * v - 409993 * u) >> 20)   B = c((y + 2116026 * u) >> 20)
    mosaics  a colour that a pixel lacks is the mean of the 2 or 4 nearest that have it: (a + b + 1) >> 1, (a + b + c + d + 2) >> 2.
             Beyond the border the image goes on as its mirror: row -1 is row 1.
    to YUV   Y = (269484 * R + 528482 * G + 102760 * B + 33 * 2**19) >> 20, U = (460324 * B - 155188 * R - 305135 * G + 257 * 2**19) >> 20
             V = (460324 * R - 385875 * G - 74448 * B + 257 * 2**19) >> 20: of the mean of a pair of pixels where each pair has its chroma,
             of the left upper pixel where four have

That is what OpenCV computes, but for mosaics' outermost pixels. A row's place is checked before its pixels are read, so that all
other arithmetic is linear.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.nodes import (
    Advance,
    Arithmetic,
    Binary,
    Compare,
    Const,
    Convert,
    Expr,
    For,
    Get,
    Load,
    Local,
    Place,
    Reserve,
    Select,
    SetField,
    Used,
)
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.limits import MAX_COLOUR_SIDE
from rosetta_jit.lowering.texts.views import View, lane_of, sound
from rosetta_jit.lowering.writer import Where, Writer, block
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    Colour = tuple[Expr, ...]
    """R, G and B."""

PACKED = {"yuv422": (1, 0, 2), "yuv422_yuy2": (0, 1, 3)}
"""Of each pair of pixels in four bytes: where the first luma lies, the other two bytes behind it; U, V."""
HALVED = {"nv12": (0, 1), "nv21": (1, 0)}
"""Luma in rows, and behind it rows of U and V for two pixels of two rows each: where U and V lie."""
MOSAICS = {f"bayer_{pattern}8": pattern for pattern in ("rggb", "bggr", "gbrg", "grbg")}
"""The colours of the first two rows and columns."""
ENCODINGS = (*MOSAICS, *PACKED, *HALVED)

CHANNELS = 3

LUMA, BLUE, RED = (269484, 528482, 102760), (-155188, -305135, 460324), (460324, -385875, -74448)
"""The weights of R, G and B in Y, U and V, times 2**20."""


@dataclass(frozen=True, slots=True)
class Picture:
    """What is converted: its bytes, its size in pixels, and how far apart its rows begin."""

    pixels: View
    width: Expr
    height: Expr
    step: Expr


def to_rgb(writer: Writer, encoding: str, picture: Picture, where: Where, line: str) -> View:
    """The pixels as RGB, in the hidden lane of what is computed; a picture of another size than it says is an error of kind `image`."""
    return _Conversion(writer, encoding, picture, where, line).made()


@dataclass(slots=True)
class _Conversion:
    writer: Writer
    encoding: str
    picture: Picture
    where: Where
    line: str

    def made(self) -> View:
        writer, picture = self.writer, self.picture
        size = writer.let("size", picture.pixels.size)
        self.check(size)
        pairs = writer.let("pairs", Binary("div", picture.width, index(2)))
        self.must(Compare("eq", picture.width, mul(pairs, 2)), "an odd number of columns")
        lines = writer.let("lines", picture.height)
        if self.encoding not in PACKED:
            lines = writer.let("lines", Binary("div", picture.height, index(2)))
            self.must(Compare("eq", picture.height, mul(lines, 2)), "an odd number of rows")
        row = writer.let("row", mul(picture.width, CHANNELS))
        target = self.room(picture.height, row)
        number = Local("i64", writer.fresh("line"))
        with writer.nested() as body:
            self.rows(number, pairs, row, target)
        writer.emit(For(number.name, lines, block(body)))
        return target

    def room(self, rows: Expr, row: Expr) -> View:
        """New bytes for so many rows."""
        writer, lane = self.writer, lane_of(self.writer)
        total = writer.checked("mul", rows, row, self.where, line=self.line)
        self.must(Compare("ge", total, index(0)), "no rows")
        writer.emit(Reserve(lane, total))
        first = writer.let("computed", Used(lane))
        writer.emit(Advance(lane, total))
        return sound(writer, View(lane, first, writer.let("after", add(first, total))))

    # --- what must be ----------------------------------------------------------------------------------------------------

    def must(self, condition: Expr, why: str) -> None:
        self.writer.expect(condition, "image", self.where, why, line=self.line)

    def check(self, size: Expr) -> None:
        """Check that there are as many pixels as the width, the height and the step say."""
        picture = self.picture
        for side, name in ((picture.width, "width"), (picture.height, "height")):
            self.must(Compare("ge", side, index(2)), f"a {name} below 2")
            self.must(Compare("le", side, index(MAX_COLOUR_SIDE)), f"a {name} above {MAX_COLOUR_SIDE}")
        least = mul(picture.width, 2) if self.encoding in PACKED else picture.width
        self.must(Compare("ge", picture.step, least), "rows that overlap")
        self.must(Compare("le", picture.step, size), "fewer bytes than a row has")
        rows = picture.height
        if self.encoding in HALVED:
            rows = self.writer.let("rows", add(rows, Binary("div", rows, index(2))))
        wanted = self.writer.checked("mul", rows, picture.step, self.where, line=self.line)
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

    # --- pixels ----------------------------------------------------------------------------------------------------------

    def byte(self, at: Expr) -> Expr:
        lane = self.picture.pixels.lane
        value = Load("u8", at) if lane is None else Get("u8", Place(lane, at))
        return self.writer.let("byte", Convert("i32", value))

    def put(self, lane: int | None, at: Expr, values: tuple[Expr, ...]) -> None:
        assert lane is not None
        for number, value in enumerate(values):
            self.writer.emit(SetField(Place(lane, add(at, number)), Convert("u8", value)))

    def rows(self, number: Expr, pairs: Expr, row: Expr, target: View) -> None:
        """One row, or two of which the pixels are made together."""
        if self.encoding in PACKED:
            self.packed(number, pairs, row, target)
        elif self.encoding in HALVED:
            self.halved(number, pairs, row, target)
        else:
            self.mosaic(number, pairs, row, target)

    def packed(self, number: Expr, pairs: Expr, row: Expr, target: View) -> None:
        writer, (luma, u, v) = self.writer, PACKED[self.encoding]
        begin, out = self.source(number, mul(self.picture.width, 2)), self.target(target, number, row)
        pair = Local("i64", writer.fresh("pair"))
        with writer.nested() as body:
            at, to = Binary("add", begin, mul(pair, 4)), Binary("add", out, mul(pair, 6))
            shares = self.shares(self.byte(add(at, u)), self.byte(add(at, v)))
            for which in range(2):
                self.put(target.lane, add(to, 3 * which), self.rgb(self.byte(add(at, luma + 2 * which)), shares))
        writer.emit(For(pair.name, pairs, block(body)))

    def halved(self, number: Expr, pairs: Expr, row: Expr, target: View) -> None:
        writer, (u, v), width = self.writer, HALVED[self.encoding], self.picture.width
        upper = mul(number, 2)
        lumas = [self.source(each, width) for each in (upper, add(upper, 1))]
        chroma = self.source(Binary("add", self.picture.height, number), width)
        outs = [self.target(target, each, row) for each in (upper, add(upper, 1))]
        for luma, out in zip(lumas, outs, strict=True):
            pair = Local("i64", writer.fresh("pair"))
            with writer.nested() as body:
                both = mul(pair, 2)
                at, to = Binary("add", chroma, both), Binary("add", out, mul(pair, 6))
                shares = self.shares(self.byte(add(at, u)), self.byte(add(at, v)))
                for which in range(2):
                    self.put(target.lane, add(to, 3 * which), self.rgb(self.byte(add(Binary("add", luma, both), which)), shares))
            writer.emit(For(pair.name, pairs, block(body)))

    def shares(self, u: Expr, v: Expr) -> tuple[Expr, Expr, Expr]:
        """What the chroma of a pixel adds to each colour, times 2**20, and a half, so that shifting rounds."""
        u, v = (self.writer.let("chroma", _i32("sub", each, 128)) for each in (u, v))
        green = _i32("sub", _i32("sub", _number(1 << 19), _i32("mul", v, 852492)), _i32("mul", u, 409993))
        red, blue = _i32("add", _i32("mul", v, 1673527), 1 << 19), _i32("add", _i32("mul", u, 2116026), 1 << 19)
        return self.writer.let("red", red), self.writer.let("green", green), self.writer.let("blue", blue)

    def rgb(self, luma: Expr, shares: tuple[Expr, Expr, Expr]) -> tuple[Expr, ...]:
        y = self.writer.let("luma", _i32("mul", _i32("max", _i32("sub", luma, 16), 0), 1220542))
        return tuple(_i32("max", _i32("min", _i32("shr", _i32("add", y, share), 20), 255), 0) for share in shares)

    # --- YUV of RGB --------------------------------------------------------------------------------------------------------

    def check_rgb(self, size: Expr) -> None:
        """Check that there are as many pixels of RGB as the width, the height and the step say."""
        picture = self.picture
        for side, name in ((picture.width, "width"), (picture.height, "height")):
            self.must(Compare("ge", side, index(2)), f"a {name} below 2")
            self.must(Compare("le", side, index(MAX_COLOUR_SIDE)), f"a {name} above {MAX_COLOUR_SIDE}")
        self.must(Compare("ge", picture.step, mul(picture.width, CHANNELS)), "rows that overlap")
        self.must(Compare("le", picture.step, size), "fewer bytes than a row has")
        wanted = self.writer.checked("mul", picture.height, picture.step, self.where, line=self.line)
        self.must(Compare("eq", size, wanted), "the pixels are not as many as the width, the height and the step say")

    def pair(self, begin: Expr, pair: Expr) -> tuple[Colour, Colour]:
        """Two pixels of RGB."""
        at = Binary("add", begin, mul(pair, 6))
        return self.colour(at), self.colour(add(at, 3))

    def colour(self, at: Expr) -> Colour:
        """A pixel of RGB."""
        return tuple(self.byte(add(at, each)) for each in range(CHANNELS))

    def pack(self, number: Expr, pairs: Expr, row: Expr, target: View) -> None:
        """One row, of which each pair of pixels has its chroma: that of their mean."""
        writer, (luma, u, v) = self.writer, PACKED[self.encoding]
        begin, out = self.source(number, mul(self.picture.width, CHANNELS)), self.target(target, number, row)
        pair = Local("i64", writer.fresh("pair"))
        with writer.nested() as body:
            pixels, to = self.pair(begin, pair), Binary("add", out, mul(pair, 4))
            both = tuple(writer.let("both", _i32("add", one, other)) for one, other in zip(*pixels, strict=True))
            made = {luma: _luma(pixels[0]), luma + 2: _luma(pixels[1])}
            made |= {place: _i32("shr", _weighted(both, weights, 514), 21) for place, weights in ((u, BLUE), (v, RED))}
            self.put(target.lane, to, tuple(made[each] for each in range(4)))
        writer.emit(For(pair.name, pairs, block(body)))

    def halve(self, number: Expr, pairs: Expr, target: View) -> None:
        """Two rows, of which each four pixels have their chroma: that of the left upper one."""
        writer, width, (u, _) = self.writer, self.picture.width, HALVED[self.encoding]
        upper = mul(number, 2)
        rows = upper, add(upper, 1)
        begins = [self.source(each, mul(width, CHANNELS)) for each in rows]
        outs = [self.target(target, each, width) for each in rows]
        chroma = self.target(target, Binary("add", self.picture.height, number), width)
        for begin, out in zip(begins, outs, strict=True):
            pixel = Local("i64", writer.fresh("pixel"))
            with writer.nested() as body:
                self.put(target.lane, Binary("add", out, pixel), (_luma(self.colour(Binary("add", begin, mul(pixel, CHANNELS)))),))
            writer.emit(For(pixel.name, width, block(body)))
        pair = Local("i64", writer.fresh("pair"))
        with writer.nested() as body:
            left = self.colour(Binary("add", begins[0], mul(pair, 6)))
            made = tuple(_i32("shr", _weighted(left, weights, 257), 20) for weights in (BLUE, RED))
            self.put(target.lane, Binary("add", chroma, mul(pair, 2)), made if u == 0 else made[::-1])
        writer.emit(For(pair.name, pairs, block(body)))

    # --- mosaics ---------------------------------------------------------------------------------------------------------

    def mosaic(self, number: Expr, pairs: Expr, row: Expr, target: View) -> None:
        """Two rows, which are of different colours."""
        writer, width, height = self.writer, self.picture.width, self.picture.height
        upper = mul(number, 2)
        above = writer.let("above", Select(Compare("eq", number, index(0)), index(1), add(upper, -1)))
        below = add(upper, 2)
        under = writer.let("below", Select(Compare("ge", below, height), add(height, -2), below))
        begins = [self.source(each, width) for each in (above, upper, add(upper, 1), under)]
        colours = MOSAICS[self.encoding]
        for which in range(2):
            out = self.target(target, add(upper, which), row)
            near, own = begins[which : which + 3], colours[2 * which : 2 * which + 2]
            across = colours[2 - 2 * which : 4 - 2 * which]
            last = add(width, -1)
            self.put(target.lane, out, self.cell(near, (index(1), index(0), index(1)), own[0], own[1], across[0]))
            pair = Local("i64", writer.fresh("pair"))
            with writer.nested() as body:
                both, to = mul(pair, 2), Binary("add", out, mul(pair, 6))
                columns = [both, *(add(both, each) for each in (1, 2, 3))]
                odd = self.cell(near, (columns[0], columns[1], columns[2]), own[1], own[0], across[1])
                self.put(target.lane, add(to, 3), odd)
                even = self.cell(near, (columns[1], columns[2], columns[3]), own[0], own[1], across[0])
                self.put(target.lane, add(to, 6), even)
            writer.emit(For(pair.name, add(pairs, -1), block(body)))
            self.put(
                target.lane,
                Binary("add", out, mul(last, 3)),
                self.cell(near, (add(width, -2), last, add(width, -2)), own[1], own[0], across[1]),
            )

    def cell(self, near: list[Expr], columns: tuple[Expr, Expr, Expr], own: str, beside: str, across: str) -> tuple[Expr, ...]:
        """A pixel whose own colour is known: of the rows above, at and below it and its three columns."""

        def at(row: int, column: int) -> Expr:
            return self.byte(Binary("add", near[row], columns[column]))

        middle = at(1, 1)
        if own == "g":
            sides = {beside: _mean(at(1, 0), at(1, 2)), across: _mean(at(0, 1), at(2, 1))}
            return tuple(middle if each == "g" else sides[each] for each in "rgb")
        cross = _mean(at(0, 1), at(1, 0), at(1, 2), at(2, 1))
        corners = _mean(at(0, 0), at(0, 2), at(2, 0), at(2, 2))
        return tuple(middle if each == own else cross if each == "g" else corners for each in "rgb")


def to_yuv(writer: Writer, encoding: str, picture: Picture, where: Where, line: str) -> View:
    """RGB as YUV, in the hidden lane of what is computed; a picture of another size than it says is an error of kind `image`."""
    conversion = _Conversion(writer, encoding, picture, where, line)
    conversion.check_rgb(writer.let("size", picture.pixels.size))
    pairs = writer.let("pairs", Binary("div", picture.width, index(2)))
    conversion.must(Compare("eq", picture.width, mul(pairs, 2)), "an odd number of columns")
    number = Local("i64", writer.fresh("line"))
    if encoding in PACKED:
        row, lines = writer.let("row", mul(picture.width, 2)), picture.height
        target = conversion.room(picture.height, row)
        with writer.nested() as body:
            conversion.pack(number, pairs, row, target)
    else:
        lines = writer.let("lines", Binary("div", picture.height, index(2)))
        conversion.must(Compare("eq", picture.height, mul(lines, 2)), "an odd number of rows")
        target = conversion.room(writer.let("rows", add(picture.height, lines)), picture.width)
        with writer.nested() as body:
            conversion.halve(number, pairs, target)
    writer.emit(For(number.name, lines, block(body)))
    return target


def _luma(pixel: Colour) -> Expr:
    return _i32("shr", _weighted(pixel, LUMA, 33), 20)


def _weighted(pixel: Colour, weights: tuple[int, int, int], halves: int) -> Expr:
    """The sum of a pixel's colours, each times its weight, and of so many halves times 2**20."""
    total: Expr = _number(halves << 19)
    for value, weight in zip(pixel, weights, strict=True):
        total = _i32("add" if weight > 0 else "sub", total, _i32("mul", value, abs(weight)))
    return total


def _mean(*values: Expr) -> Expr:
    """The mean of two or four, a half rounded up."""
    total = values[0]
    for each in values[1:]:
        total = _i32("add", total, each)
    return _i32("shr", _i32("add", total, len(values) // 2), len(values) // 2)


def _i32(op: Arithmetic, left: Expr, right: Expr | int) -> Expr:
    return Binary(op, left, _number(right) if isinstance(right, int) else right)


def _number(value: int) -> Expr:
    return Const("i32", value)
