"""Implicit conversions: a scalar type converts to another one unwritten if no value can change.

An integer becomes a wider one, or an unsigned one a wider signed one; an integer becomes a float that holds all of its
values; float32 becomes float64. A constant becomes any type that can hold it; a constant float is rounded to float32.
"""

from __future__ import annotations

import math
import struct

from rosetta_jit.language.typed import INT64, Binary, Call, Const, Convert, Expr, LenOf, Local, Reduce, Unary
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, Optional, Ref, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import replace

FLOAT64 = Float(64)
SMALL = 2**32
LARGEST_COUNT = 2**47
"""Where a loop may begin, and what may be added to a number of elements, so that a float64 holds what comes of it."""

EXACT_BITS = {32: 24, 64: 53}
"""Bits of an integer that a float of so many bits always holds: IEEE 754, table 3.5, precision p."""


def describe(type_: Type) -> str:
    """A type as a report names it."""
    match type_:
        case Bool():
            return "bool"
        case Int(bits, signed):
            return f"{'' if signed else 'u'}int{bits}"
        case Float(bits):
            return f"float{bits}"
        case String(encoding="utf-16"):
            return "text of 16-bit units"
        case String():
            return "text"
        case Bytes():
            return "bytes"
        case Enum(name=name):
            return f"enum {name}"
        case Array(element, length):
            return f"an array of {f'{length} ' if isinstance(length, int) else ''}{describe(element)}"
        case Struct(name=name) | Union(name=name) | Ref(name=name):
            return name
        case Optional(value):
            return describe(value)
        case Map(key, value):
            return f"a map of {describe(key)} to {describe(value)}"


def same(left: Type, right: Type) -> bool:
    """Whether two types have the same values, however their IDLs spell them."""
    match left, right:
        case String(encoding=encoding), String(encoding=other):
            return (encoding == "utf-16") == (other == "utf-16")
        case (Bool(), Bool()) | (Bytes(), Bytes()):
            return True
        case Int(bits, signed), Int(other_bits, other_signed):
            return bits == other_bits and signed == other_signed
        case Float(bits), Float(other):
            return bits == other
        case _:
            return left == right


def widens(source: Type, target: Type) -> bool:
    """Whether every value of one scalar is a value of the other."""
    match source, target:
        case Int(bits, signed), Int(target_bits, target_signed):
            return bits < target_bits if signed == target_signed else target_signed and bits < target_bits
        case Int(bits), Float(target_bits):
            return bits <= EXACT_BITS[target_bits]
        case Float(bits), Float(target_bits):
            return bits < target_bits
        case _:
            return False


def is_textual(type_: Type) -> bool:
    """Whether a value is bytes that lie one after another."""
    match type_:
        case String(encoding=encoding):
            return encoding != "utf-16"
        case Bytes() | Array(element=Int(8)):
            return True
        case _:
            return False


def is_bytes(type_: Type) -> bool:
    """Whether a value is bytes, or an array of them."""
    return isinstance(type_, Bytes) or (isinstance(type_, Array) and isinstance(type_.element, Int) and type_.element.bits == 8)


def is_single(type_: Type) -> bool:
    """Whether a type is float32, however its IDL calls it."""
    return isinstance(type_, Float) and type_.bits == 32


def in_single(value: Const) -> Const | None:
    """A number as the nearest float32; None where that is beyond the greatest one."""
    number = float(value.value)
    if not _fits_float32(number):
        return None
    return replace(value, value=struct.unpack("<f", struct.pack("<f", number))[0], type=Float(32))


def as_single(value: Expr) -> Expr | None:
    """A float32 as it is, and a constant that is equal to one; None of all else, which meets a float32 as float64."""
    if is_single(value.type) or not isinstance(value, Const) or value.declared or not isinstance(value.type, Int | Float):
        return value if is_single(value.type) else None
    known = in_single(value)
    return known if known is not None and known.value == value.value else None


def rounded_constant(value: Const) -> float | None:
    """The float32 that a constant becomes where none is equal to it; None of all other constants."""
    if not isinstance(value.value, float) or not is_single(value.type):
        return None
    known = in_single(value)
    return None if known is None or known.value == value.value else float(known.value)


def holds(type_: Int, value: int) -> bool:
    """Whether an integer type has this value."""
    low, high = bounds(type_)
    return low <= value <= high


def bounds(type_: Int) -> tuple[int, int]:
    """The least and the greatest value of an integer type."""
    return (-(1 << type_.bits - 1), (1 << type_.bits - 1) - 1) if type_.signed else (0, (1 << type_.bits) - 1)


def wrap(type_: Int, value: int) -> int:
    """The value of an integer type that is equal to ``value`` modulo its number of values."""
    low, _ = bounds(type_)
    return (value - low) % (1 << type_.bits) + low


def convert(value: Expr, target: Type) -> Expr | None:
    """``value`` as ``target`` if that needs no word, else None."""
    if isinstance(value, Const):
        return adapt(value, target)
    if same(value.type, target):
        return value
    if isinstance(target, Float) and target.bits == 64 and counts(value):
        return Convert(value, target, "nearest", value.span)
    if isinstance(target, Int) and (known := few_bits(value)) is not None and holds(target, known[0]) and holds(target, known[1]):
        return Convert(value, target, "exact", value.span)
    return Convert(value, target, "widen", value.span) if widens(value.type, target) else None


def few_bits(value: Expr) -> tuple[int, int] | None:
    """The least and the greatest value that some bits of an integer have, or its remainder by a constant; None of all else."""
    match value:
        case Binary("&", _, Const(int(mask))) | Binary("&", Const(int(mask)), _) if mask >= 0:
            return 0, mask
        case Call("modulo", (_, Const(int(divisor)))) if divisor > 0:
            return 0, divisor - 1
        case Binary(">>", Convert(part, _, "widen"), Const(int(count))) if isinstance(part.type, Int) and 0 <= count < INT64.bits:
            low, high = bounds(part.type)
            return low >> count, high >> count
        case _:
            return None


def counts(value: Expr) -> bool:
    """Whether an int64 is a number of elements or rounds, some bits of an integer, or a sum of these and of integers of at most 32
    bits: none is beyond 2**47, as addresses are not, so that the sum of as many as an expression can have is exact in float64.
    """
    match value:
        case LenOf():
            return True
        case Local():
            return value.counts
        case Reduce(function="count"):
            return True
        case Reduce(function="min" | "max", value=Convert(part)):
            return isinstance(part.type, Int) and part.type.bits <= 32
        case Binary("&", _, Const(int(mask))) | Binary("&", Const(int(mask)), _):
            return 0 <= mask < LARGEST_COUNT
        case Call("modulo", (_, Const(int(divisor)))):
            return 0 < divisor <= LARGEST_COUNT
        case Binary(">>", Convert(part), Const()) | Call("floor_divide", (Convert(part), Const())):
            return isinstance(part.type, Int) and part.type.bits <= 32
        case Binary("*", Convert(part), Const(int(factor))):
            return isinstance(part.type, Int) and abs(factor) << part.type.bits <= LARGEST_COUNT
        case Binary("+" | "-", left, right):
            return all(counts(each) or _is_small(each) for each in (left, right))
        case Unary("-", operand):
            return counts(operand) or _is_small(operand)
        case _:
            return False


def _is_small(value: Expr) -> bool:
    """Whether an int64 is an integer of at most 32 bits, or a constant that is as small."""
    match value:
        case Const(int(number)):
            return abs(number) <= SMALL
        case Convert(part):
            return isinstance(part.type, Int) and part.type.bits <= 32
        case _:
            return False


def adapt(value: Const, target: Type) -> Const | None:
    """A constant as ``target``, or None where that type cannot hold it."""
    match value.value, value.type, target:
        case int(number), Int(), Int() if holds(target, number):
            return replace(value, type=target)
        case int(number), Int(), Float(bits) if _float_holds(number, bits):
            return replace(value, value=float(number), type=target)
        case float(number), Float(), Float(bits) if bits == 64 or _fits_float32(number):
            return replace(value, type=target)
        case str(), String(), String() | Bytes():
            return replace(value, type=target)
        case _:
            return value if same(value.type, target) else None


def _float_holds(number: int, bits: int) -> bool:
    magnitude = abs(number)
    return magnitude == 0 or magnitude.bit_length() - _trailing_zeros(magnitude) <= EXACT_BITS[bits]


def _trailing_zeros(number: int) -> int:
    return (number & -number).bit_length() - 1


def _fits_float32(number: float) -> bool:
    if not math.isfinite(number):
        return True
    try:
        struct.pack("<f", number)
    except OverflowError:
        return False
    return True


def word_for(source: Type, target: Type) -> str:
    """How a mapping says that a value may change; empty where no word can say it."""
    name = describe(target)
    match source, target:
        case Bool() | Enum(), Int():
            return f"`{name}(...)`"
        case Int(), Int():
            return f"`{name}(...)` refuses what does not fit; `{name}(..., saturate)` and `{name}(..., wrap)` do not"
        case Float(), Int():
            return f"`{name}(...)` refuses fractions; `{name}(..., round)`, `{name}(..., truncate)` and `{name}(..., saturate)` do not"
        case Int() | Float(), Float():
            return f"`{name}(...)` rounds to the nearest"
        case Int(), Enum(name=enum):
            return f"`{enum}(...)` refuses a number that it does not name"
        case Int(), Bool():
            return "`bool(...)` refuses all but 0 and 1"
        case _:
            return ""


def other_way(source: Type, target: Type) -> str:
    """What to do where a whole value has another type; empty where nothing helps."""
    match source, target:
        case ((Map() | Array()), (Map() | Array())) if Map in (type(source), type(target)):
            return "set the `key` and the `value` of each entry: `.a[].key = .b[].key` and `.a[].value = .b[].value`"
        case Array(length=int(has)), Array(length=int(needed)) if has != needed:
            return f"`.a = .b[0 to {needed}]` takes the first {needed} of {has}" if has > needed else "set its elements one by one"
        case Array(one, length), Array(other, wanted) if (
            isinstance(one, Int | Float) and isinstance(other, Int | Float) and None in (length, wanted)
        ):
            return f"convert each element: `.a[] = {describe(other)}(.b[])`, and in `rules:` `.a[] <-> {describe(other)}(.b[])`"
        case Array(Bool() | Int() | Float() | String() | Bytes() | Enum()), Array():
            return "convert each element: `.a[] = f(.b[])`"
        case Array(), Array():
            return 'by the rules of another mapping, `.a = .b via "x.mapping"`; or field by field, `.a[].x = .b[].y`'
        case Struct(), Struct():
            return 'by the rules of another mapping, `.a = .b via "x.mapping"`; or field by field, `.a.x = .b.y`'
        case ((Bool() | Int() | Float()), String()):
            return "`text(...)` spells it as a text"
        case String(), Int(bits, signed):
            call = "integer(...)" if bits == 64 and signed else f"{describe(target)}(integer(...))"
            return f"`{call}` is the integer that a text spells"
        case String(), Float(bits):
            return f"`{'number(...)' if bits == 64 else 'float32(number(...))'}` is the number that a text spells"
        case String(), Enum(name=name, values=((first, _), *_)):
            return f'`{name}(...)` is the constant that a text names; for other texts, `table(...) {{ "..." = {name}.{first}, ... }}`'
        case Enum(name=name, values=((first, _), *_)), String():
            return f'`text(...)` is the name of a constant; for another text, `table(...) {{ {name}.{first} = "...", ... }}`'
        case _:
            return ""


def bare(value: Expr) -> Expr:
    """An integer, bool or enum without the conversions that leave it the same number."""
    whole = Int | Bool | Enum
    while isinstance(value, Convert) and value.rule in {"widen", "exact"} and isinstance(value.type, whole):
        if not isinstance(value.operand.type, whole):
            break
        value = value.operand
    return value


def as_int64(value: Expr) -> Expr | None:
    """An integer of any type but uint64 as int64."""
    return convert(value, INT64) if isinstance(value.type, Int) else None
