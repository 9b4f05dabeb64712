"""RGB of mosaics, two rows at once: a pixel of a Bayer filter has one colour, and those beside it the others."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Binary, Compare, Expr, For, Local, Select
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.colours.conversion import MOSAICS, Conversion, i32
from rosetta_jit.lowering.texts.views import View
from rosetta_jit.lowering.writer import block


def mosaic(conversion: Conversion, number: Expr, pairs: Expr, row: Expr, target: View) -> None:
    """Two rows, which are of different colours."""
    writer, width, height = conversion.writer, conversion.picture.width, conversion.picture.height
    upper = mul(number, 2)
    above = writer.let("above", Select(Compare("eq", number, index(0)), index(1), add(upper, -1)))
    below = add(upper, 2)
    under = writer.let("below", Select(Compare("ge", below, height), add(height, -2), below))
    begins = [conversion.source(each, width) for each in (above, upper, add(upper, 1), under)]
    colours = MOSAICS[conversion.encoding]
    for which in range(2):
        out = conversion.target(target, add(upper, which), row)
        near, own = begins[which : which + 3], colours[2 * which : 2 * which + 2]
        across = colours[2 - 2 * which : 4 - 2 * which]
        last = add(width, -1)
        conversion.put(target.lane, out, _cell(conversion, near, (index(1), index(0), index(1)), own[0], own[1], across[0]))
        pair = Local("i64", writer.fresh("pair"))
        with writer.nested() as body:
            both, to = mul(pair, 2), Binary("add", out, mul(pair, 6))
            columns = [both, *(add(both, each) for each in (1, 2, 3))]
            odd = _cell(conversion, near, (columns[0], columns[1], columns[2]), own[1], own[0], across[1])
            conversion.put(target.lane, add(to, 3), odd)
            even = _cell(conversion, near, (columns[1], columns[2], columns[3]), own[0], own[1], across[0])
            conversion.put(target.lane, add(to, 6), even)
        writer.emit(For(pair.name, add(pairs, -1), block(body)))
        conversion.put(
            target.lane,
            Binary("add", out, mul(last, 3)),
            _cell(conversion, near, (add(width, -2), last, add(width, -2)), own[1], own[0], across[1]),
        )


def _cell(
    conversion: Conversion, near: list[Expr], columns: tuple[Expr, Expr, Expr], own: str, beside: str, across: str
) -> tuple[Expr, ...]:
    """A pixel whose own colour is known: of the rows above, at and below it and its three columns."""

    def at(row: int, column: int) -> Expr:
        return conversion.byte(Binary("add", near[row], columns[column]))

    middle = at(1, 1)
    if own == "g":
        sides = {beside: _mean(at(1, 0), at(1, 2)), across: _mean(at(0, 1), at(2, 1))}
        return tuple(middle if each == "g" else sides[each] for each in "rgb")
    cross = _mean(at(0, 1), at(1, 0), at(1, 2), at(2, 1))
    corners = _mean(at(0, 0), at(0, 2), at(2, 0), at(2, 2))
    return tuple(middle if each == own else cross if each == "g" else corners for each in "rgb")


def _mean(*values: Expr) -> Expr:
    """The mean of two or four, a half rounded up."""
    total = values[0]
    for each in values[1:]:
        total = i32("add", total, each)
    return i32("shr", i32("add", total, len(values) // 2), len(values) // 2)
