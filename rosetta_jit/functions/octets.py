"""Numbers within bytes: read where they lie, whatever lies around them, and taken apart."""

from __future__ import annotations

from functools import partial, reduce

from rosetta_jit.catalogue import number_bytes as words
from rosetta_jit.kernel.nodes import WIDTH, Binary, Bits, Compare, Const, Convert, Expr, Scalar, Select, Wire
from rosetta_jit.kernel.terms import add, index, type_of
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import as_int64, describe, is_bytes
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Function, Row
from rosetta_jit.language.functions.decisions import is_condition
from rosetta_jit.language.scope import Scope
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.views import byte_at
from rosetta_jit.model import expr as model
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Float, Int

READ: dict[str, Int | Float] = {
    **{f"int{bits}_at": Int(bits) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}_at": Int(bits, signed=False) for bits in (8, 16, 32, 64)},
    **{f"float{bits}_at": Float(bits) for bits in (32, 64)},
}
"""The functions that read a number, and its type."""


# --- types ---------------------------------------------------------------------------------------------------------------


def _type_number_at(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    if len(arguments) not in {2, 3}:
        scope.problems.append(words.arguments(call.span, call.function, len(arguments)))
        return None
    source, place, *order = arguments
    at = _integer(place, scope)
    big = order[0] if order else typed.Const(value=False, type=Bool())
    if at is None or not is_condition(big, scope):
        return None
    if not (isinstance(source, typed.Access) and is_bytes(source.type)):
        scope.problems.append(words.no_field(call.arguments[0].span, call.function, describe(source.type)))
        return None
    return typed.Call(call.function, (source, at, big), READ[call.function], call.span)


def _type_byte(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    if len(arguments) != 2:
        scope.problems.append(words.arguments(call.span, call.function, len(arguments)))
        return None
    value, number = arguments[0], _integer(arguments[1], scope)
    if number is None:
        return None
    if not isinstance(value.type, Int | Float):
        scope.problems.append(words.no_number(value.span, describe(value.type)))
        return None
    size = value.type.bits // 8
    if isinstance(number, typed.Const) and not 0 <= int(number.value) < size:
        scope.problems.append(words.byte_range(number.span, size))
        return None
    return typed.Call("byte", (value, number), Int(8, signed=False), call.span)


def _integer(value: typed.Expr, scope: Scope) -> typed.Expr | None:
    whole = as_int64(value)
    if whole is None:
        scope.problems.append(words.no_integer(value.span, describe(value.type)))
    return whole


# --- kernels -------------------------------------------------------------------------------------------------------------


def _lower_number_at(call: typed.Call, values: Evaluation) -> Expr:
    """The number at a place in bytes: an error of kind ``index`` where they are too few."""
    field, place_in_it, big = call.arguments
    assert isinstance(field, typed.Access)
    place, type_ = field.place, READ[call.function]
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


def _lower_byte(call: typed.Call, values: Evaluation) -> Expr:
    """One byte of a number: an error of kind ``index`` where it has fewer."""
    value, which = call.arguments
    writer, number = values.writer, values.of(value)
    size = WIDTH[type_of(number)]
    position = writer.let("byte", values.of(which))
    there = Binary("and", Compare("ge", position, index(0)), Compare("lt", position, index(size)))
    writer.expect(there, "index", values.where, f"the number has {size} bytes", line=values.line)
    whole = _integer_of(size)
    bits = Bits(whole, number) if isinstance(value.type, Float) else Convert(whole, number)
    distance = Convert(whole, Binary("shl", position, index(3)))
    return Convert("u8", Binary("shr", writer.let("bits", bits), distance))


ROWS = (
    Row(
        "bytes",
        "`int8_at(b, i)` … `uint64_at(b, i)`, `float32_at(b, i)`, `float64_at(b, i)`",
        ("the number whose first byte is byte `i` of a field of bytes, or of `uint8[]`; its low byte comes first", "`index`"),
    ),
    Row("bytes", "`float32_at(b, i, big)`", ("the same; its high byte comes first where the condition `big` holds", "`index`")),
)
BYTE = Row("bytes", "`byte(x, n)`", ("uint8: byte `n` of a number as its type has it, from 0, the lowest", "`index`"))

of_octets = partial(Function, operation="array reorder")
FUNCTIONS = (
    *(of_octets(name, _type_number_at, _lower_number_at, SEVERAL, NOT_FOLLOWED, ROWS) for name in READ),
    of_octets("byte", _type_byte, _lower_byte, SEVERAL, NOT_FOLLOWED, (BYTE,)),
)
