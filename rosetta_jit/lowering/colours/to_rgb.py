"""RGB of what cameras send."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Binary, Compare, Expr, For, Local
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.colours.conversion import CHANNELS, HALVED, PACKED, Conversion, Picture
from rosetta_jit.lowering.colours.mosaics import mosaic
from rosetta_jit.lowering.colours.of_yuv import halved, packed
from rosetta_jit.lowering.texts.views import View
from rosetta_jit.lowering.writer import Where, Writer, block


def to_rgb(writer: Writer, encoding: str, picture: Picture, where: Where, line: str) -> View:
    """The pixels as RGB, in the hidden lane of what is computed; a picture of another size than it says is an error of kind `image`."""
    conversion = Conversion(writer, encoding, picture, where, line)
    size = writer.let("size", picture.pixels.size)
    conversion.check_rows(size, mul(picture.width, 2) if encoding in PACKED else picture.width)
    rows = picture.height
    if encoding in HALVED:
        rows = writer.let("rows", add(rows, Binary("div", rows, index(2))))
    conversion.check_size(size, rows)
    pairs = writer.let("pairs", Binary("div", picture.width, index(2)))
    conversion.must(Compare("eq", picture.width, mul(pairs, 2)), "an odd number of columns")
    lines = writer.let("lines", picture.height)
    if encoding not in PACKED:
        lines = writer.let("lines", Binary("div", picture.height, index(2)))
        conversion.must(Compare("eq", picture.height, mul(lines, 2)), "an odd number of rows")
    row = writer.let("row", mul(picture.width, CHANNELS))
    target = conversion.room(picture.height, row)
    number = Local("i64", writer.fresh("line"))
    with writer.nested() as body:
        _rows(conversion, number, pairs, row, target)
    writer.emit(For(number.name, lines, block(body)))
    return target


def _rows(conversion: Conversion, number: Expr, pairs: Expr, row: Expr, target: View) -> None:
    """One row, or two of which the pixels are made together."""
    if conversion.encoding in PACKED:
        packed(conversion, number, pairs, row, target)
    elif conversion.encoding in HALVED:
        halved(conversion, number, pairs, row, target)
    else:
        mosaic(conversion, number, pairs, row, target)
