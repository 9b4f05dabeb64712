"""Numbers within bytes: read where they lie, whatever lies around them, and taken apart."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import WIDTH, Binary, Bits, Compare, Const, Convert, Select, Wire
from rosetta_jit.kernel.terms import add, index, type_of
from rosetta_jit.language import typed
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.texts.views import byte_at
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Float, Int

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Expr, Scalar
    from rosetta_jit.lowering.evaluation import Evaluation
    from rosetta_jit.model.types import Type


def of_bytes(value: typed.BytesCall, values: Evaluation) -> Expr:
    """What a function of bytes gives."""
    match value.arguments:
        case (typed.Access(place), at, big):
            return _number_at(place, at, big, value.type, values)
        case (number, which):
            return _byte_of(number, which, values)
        case _:
            raise AssertionError(value)


def _number_at(place: typed.Place, place_in_it: typed.Expr, big: typed.Expr, type_: Type, values: Evaluation) -> Expr:
    """The number at a place in bytes: an error of kind ``index`` where they are too few."""
    assert isinstance(type_, Int | Float)
    writer, scalar = values.writer, scalar_name(scalar_of(type_))
    size = WIDTH[scalar]
    address, count = values.source.address(place, values), values.source.count(place, values)
    at = writer.let("at_byte", values.of(place_in_it))
    there = Binary("and", Compare("ge", at, index(0)), Compare("le", at, add(count, -size)))
    writer.expect(there, "index", values.where, f"no {size} bytes from there on", line=values.line)
    lane, start = (None, address.at) if isinstance(address, Wire) else (address.lane, address.row)
    first = writer.let("first_byte", Binary("add", start, at))
    if lane is None:
        writer.require(size, values.where, at=first)
    number = writer.let("bits", _put_together([byte_at(lane, add(first, each)) for each in range(size)], values.of(big)))
    return Bits(scalar, number) if isinstance(type_, Float) else Convert(scalar, number)


def _put_together(found: list[Expr], big: Expr) -> Expr:
    """Bytes as an integer, from the lowest, or from the highest where ``big`` holds."""
    if isinstance(big, Const):
        return _of_lowest_first(found[::-1] if big.value else found)
    return Select(big, _of_lowest_first(found[::-1]), _of_lowest_first(found))


def _of_lowest_first(found: list[Expr]) -> Expr:
    whole = _integer_of(len(found))
    shifted = [Convert(whole, each) for each in found[:1]]
    shifted += [Binary("shl", Convert(whole, each), Const(whole, 8 * number)) for number, each in enumerate(found[1:], 1)]
    return reduce(lambda low, high: Binary("or", low, high), shifted)


def _integer_of(size: int) -> Scalar:
    return "u64" if size == WIDTH["u64"] else "u32"


def _byte_of(value: typed.Expr, which: typed.Expr, values: Evaluation) -> Expr:
    """One byte of a number: an error of kind ``index`` where it has fewer."""
    writer, number = values.writer, values.of(value)
    size = WIDTH[type_of(number)]
    position = writer.let("byte", values.of(which))
    there = Binary("and", Compare("ge", position, index(0)), Compare("lt", position, index(size)))
    writer.expect(there, "index", values.where, f"the number has {size} bytes", line=values.line)
    whole = _integer_of(size)
    bits = Bits(whole, number) if isinstance(value.type, Float) else Convert(whole, number)
    distance = Convert(whole, Binary("shl", position, index(3)))
    return Convert("u8", Binary("shr", writer.let("bits", bits), distance))
