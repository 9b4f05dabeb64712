"""RGB of YUV: each pair of pixels has its chroma, or four have."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Binary, Expr, For, Local
from rosetta_jit.kernel.terms import add, mul
from rosetta_jit.lowering.colours.conversion import HALVED, PACKED, Conversion, constant, i32
from rosetta_jit.lowering.texts.views import View
from rosetta_jit.lowering.writer import block


def packed(conversion: Conversion, number: Expr, pairs: Expr, row: Expr, target: View) -> None:
    """One row, of which each pair of pixels lies in four bytes."""
    writer, (luma, u, v) = conversion.writer, PACKED[conversion.encoding]
    begin, out = conversion.source(number, mul(conversion.picture.width, 2)), conversion.target(target, number, row)
    pair = Local("i64", writer.fresh("pair"))
    with writer.nested() as body:
        at, to = Binary("add", begin, mul(pair, 4)), Binary("add", out, mul(pair, 6))
        shares = _shares(conversion, conversion.byte(add(at, u)), conversion.byte(add(at, v)))
        for which in range(2):
            conversion.put(target.lane, add(to, 3 * which), _rgb(conversion, conversion.byte(add(at, luma + 2 * which)), shares))
    writer.emit(For(pair.name, pairs, block(body)))


def halved(conversion: Conversion, number: Expr, pairs: Expr, row: Expr, target: View) -> None:
    """Two rows, of which each four pixels have their chroma behind the luma of all."""
    writer, (u, v), width = conversion.writer, HALVED[conversion.encoding], conversion.picture.width
    upper = mul(number, 2)
    lumas = [conversion.source(each, width) for each in (upper, add(upper, 1))]
    chroma = conversion.source(Binary("add", conversion.picture.height, number), width)
    outs = [conversion.target(target, each, row) for each in (upper, add(upper, 1))]
    for luma, out in zip(lumas, outs, strict=True):
        pair = Local("i64", writer.fresh("pair"))
        with writer.nested() as body:
            both = mul(pair, 2)
            at, to = Binary("add", chroma, both), Binary("add", out, mul(pair, 6))
            shares = _shares(conversion, conversion.byte(add(at, u)), conversion.byte(add(at, v)))
            for which in range(2):
                pixel = _rgb(conversion, conversion.byte(add(Binary("add", luma, both), which)), shares)
                conversion.put(target.lane, add(to, 3 * which), pixel)
        writer.emit(For(pair.name, pairs, block(body)))


def _shares(conversion: Conversion, u: Expr, v: Expr) -> tuple[Expr, Expr, Expr]:
    """What the chroma of a pixel adds to each colour, times 2**20, and a half, so that shifting rounds."""
    u, v = (conversion.writer.let("chroma", i32("sub", each, 128)) for each in (u, v))
    green = i32("sub", i32("sub", constant(1 << 19), i32("mul", v, 852492)), i32("mul", u, 409993))
    red, blue = i32("add", i32("mul", v, 1673527), 1 << 19), i32("add", i32("mul", u, 2116026), 1 << 19)
    return conversion.writer.let("red", red), conversion.writer.let("green", green), conversion.writer.let("blue", blue)


def _rgb(conversion: Conversion, luma: Expr, shares: tuple[Expr, Expr, Expr]) -> tuple[Expr, ...]:
    y = conversion.writer.let("luma", i32("mul", i32("max", i32("sub", luma, 16), 0), 1220542))
    return tuple(i32("max", i32("min", i32("shr", i32("add", y, share), 20), 255), 0) for share in shares)
