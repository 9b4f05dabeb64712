"""YUV of RGB: each pair of pixels has its chroma, or four have."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.nodes import Binary, Compare, Expr, For, Local
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.colours.conversion import CHANNELS, HALVED, PACKED, Conversion, Picture, constant, i32
from rosetta_jit.lowering.texts.views import View
from rosetta_jit.lowering.writer import Where, Writer, block

if TYPE_CHECKING:
    Colour = tuple[Expr, ...]
    """R, G and B."""

LUMA, BLUE, RED = (269484, 528482, 102760), (-155188, -305135, 460324), (460324, -385875, -74448)
"""The weights of R, G and B in Y, U and V, times 2**20."""


def to_yuv(writer: Writer, encoding: str, picture: Picture, where: Where, line: str) -> View:
    """RGB as YUV, in the hidden lane of what is computed; a picture of another size than it says is an error of kind `image`."""
    conversion = Conversion(writer, encoding, picture, where, line)
    size = writer.let("size", picture.pixels.size)
    conversion.check_rows(size, mul(picture.width, CHANNELS))
    conversion.check_size(size, picture.height)
    pairs = writer.let("pairs", Binary("div", picture.width, index(2)))
    conversion.must(Compare("eq", picture.width, mul(pairs, 2)), "an odd number of columns")
    number = Local("i64", writer.fresh("line"))
    if encoding in PACKED:
        row, lines = writer.let("row", mul(picture.width, 2)), picture.height
        target = conversion.room(picture.height, row)
        with writer.nested() as body:
            _pack(conversion, number, pairs, row, target)
    else:
        lines = writer.let("lines", Binary("div", picture.height, index(2)))
        conversion.must(Compare("eq", picture.height, mul(lines, 2)), "an odd number of rows")
        target = conversion.room(writer.let("rows", add(picture.height, lines)), picture.width)
        with writer.nested() as body:
            _halve(conversion, number, pairs, target)
    writer.emit(For(number.name, lines, block(body)))
    return target


def _pack(conversion: Conversion, number: Expr, pairs: Expr, row: Expr, target: View) -> None:
    """One row, of which each pair of pixels has its chroma: that of their mean."""
    writer, (luma, u, v) = conversion.writer, PACKED[conversion.encoding]
    begin, out = conversion.source(number, mul(conversion.picture.width, CHANNELS)), conversion.target(target, number, row)
    pair = Local("i64", writer.fresh("pair"))
    with writer.nested() as body:
        pixels, to = _pair(conversion, begin, pair), Binary("add", out, mul(pair, 4))
        both = tuple(writer.let("both", i32("add", one, other)) for one, other in zip(*pixels, strict=True))
        made = {luma: _luma(pixels[0]), luma + 2: _luma(pixels[1])}
        made |= {place: i32("shr", _weighted(both, weights, 514), 21) for place, weights in ((u, BLUE), (v, RED))}
        conversion.put(target.lane, to, tuple(made[each] for each in range(4)))
    writer.emit(For(pair.name, pairs, block(body)))


def _halve(conversion: Conversion, number: Expr, pairs: Expr, target: View) -> None:
    """Two rows, of which each four pixels have their chroma: that of the left upper one."""
    writer, width, (u, _) = conversion.writer, conversion.picture.width, HALVED[conversion.encoding]
    upper = mul(number, 2)
    rows = upper, add(upper, 1)
    begins = [conversion.source(each, mul(width, CHANNELS)) for each in rows]
    outs = [conversion.target(target, each, width) for each in rows]
    chroma = conversion.target(target, Binary("add", conversion.picture.height, number), width)
    for begin, out in zip(begins, outs, strict=True):
        pixel = Local("i64", writer.fresh("pixel"))
        with writer.nested() as body:
            luma = _luma(_colour(conversion, Binary("add", begin, mul(pixel, CHANNELS))))
            conversion.put(target.lane, Binary("add", out, pixel), (luma,))
        writer.emit(For(pixel.name, width, block(body)))
    pair = Local("i64", writer.fresh("pair"))
    with writer.nested() as body:
        left = _colour(conversion, Binary("add", begins[0], mul(pair, 6)))
        made = tuple(i32("shr", _weighted(left, weights, 257), 20) for weights in (BLUE, RED))
        conversion.put(target.lane, Binary("add", chroma, mul(pair, 2)), made if u == 0 else made[::-1])
    writer.emit(For(pair.name, pairs, block(body)))


def _pair(conversion: Conversion, begin: Expr, pair: Expr) -> tuple[Colour, Colour]:
    """Two pixels of RGB."""
    at = Binary("add", begin, mul(pair, 6))
    return _colour(conversion, at), _colour(conversion, add(at, 3))


def _colour(conversion: Conversion, at: Expr) -> Colour:
    """A pixel of RGB."""
    return tuple(conversion.byte(add(at, each)) for each in range(CHANNELS))


def _luma(pixel: Colour) -> Expr:
    return i32("shr", _weighted(pixel, LUMA, 33), 20)


def _weighted(pixel: Colour, weights: tuple[int, int, int], halves: int) -> Expr:
    """The sum of a pixel's colours, each times its weight, and of so many halves times 2**20."""
    total: Expr = constant(halves << 19)
    for value, weight in zip(pixel, weights, strict=True):
        total = i32("add" if weight > 0 else "sub", total, i32("mul", value, abs(weight)))
    return total
