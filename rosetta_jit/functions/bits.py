"""Bits of bytes as bools, and bools as bytes, eight in each."""

from __future__ import annotations

from functools import partial, reduce

from rosetta_jit.functions.forms import constants_of, if_same_constants, undone_by
from rosetta_jit.functions.whole_arrays import BITS, OCTETS, of_arrays, row, typed_call, undone
from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Expr
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.language import typed
from rosetta_jit.language.typed import BOOL
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.made_arrays import UINT8, ArrayArgument, MadeArray, Put, array_argument


def _lower_bits(call: typed.Call, values: Evaluation) -> MadeArray:
    array = array_argument(call.arguments[0], values)
    count = values.writer.checked("mul", array.count, index(8), values.where, line=values.line)
    return MadeArray(count, partial(_fill_bits, array, _places(call), values))


def _places(call: typed.Call) -> list[int]:
    """The place of each bit within its byte, from the lowest; in the order in which they come."""
    is_big = constants_of(call) == [True]
    return [*range(8)][:: -1 if is_big else 1]


def _fill_bits(array: ArrayArgument, places: list[int], values: Evaluation, put: Put) -> None:
    writer = values.writer
    with array.each() as number:
        byte = writer.let("byte", array.at(number))
        for each, place in enumerate(places):
            bit = Binary("and", byte, Const("u8", 1 << place))
            put(add(mul(number, index(8)), index(each)), Compare("ne", bit, Const("u8", 0)))


def _lower_bytes(call: typed.Call, values: Evaluation) -> MadeArray:
    array, writer = array_argument(call.arguments[0], values), values.writer
    is_even = Compare("eq", Binary("and", array.count, index(7)), index(0))
    writer.expect(is_even, "range", values.where, "these bits are no whole bytes", line=values.line)
    count = writer.let("bytes", Binary("div", array.count, index(8)))
    return MadeArray(count, partial(_fill_bytes, array, count, _places(call)))


def _fill_bytes(array: ArrayArgument, count: Expr, places: list[int], put: Put) -> None:
    with array.each(count) as number:
        bits = [array.at(add(mul(number, index(8)), index(each))) for each in range(8)]
        parts = [Binary("shl", Convert("u8", bit), Const("u8", place)) for bit, place in zip(bits, places, strict=True)]
        put(number, reduce(partial(Binary, "or"), parts))


FUNCTIONS = (
    of_arrays(
        "bits",
        partial(typed_call, (OCTETS,), BOOL),
        _lower_bits,
        undone("bit_bytes"),
        undone_by(bit_bytes=if_same_constants),
        row("`bits(b)`, `bits(b, true)`", "the bits of bytes as bools: of each byte the lowest first, or the highest"),
    ),
    of_arrays(
        "bit_bytes",
        partial(typed_call, (BITS,), UINT8),
        _lower_bytes,
        undone("bits"),
        undone_by(bits=if_same_constants),
        row("`bit_bytes(a)`, `bit_bytes(a, true)`", "bools as the bits of bytes, eight in each", "`range`"),
    ),
)
