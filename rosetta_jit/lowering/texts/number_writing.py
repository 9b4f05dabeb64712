"""Numbers as text: integers in decimal, floats as Python writes them, with as few digits as read back."""

from __future__ import annotations

import math

from rosetta_jit.kernel.arithmetic import LARGEST_SCALE
from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Digits, Expr, Get, If, Local, Place, Scale, Select, Unary, While
from rosetta_jit.kernel.terms import add, index, mul, type_of
from rosetta_jit.lowering.texts.views import View, between, has_room, kept, lane_of, put, room
from rosetta_jit.lowering.writer import MESSAGE, Contract, Writer, block

INTEGER_ROOM = 21
"""Bytes of an integer of 64 bits: 20 digits and a sign."""

FLOAT_DIGITS = 40
"""Digits of a float and zeros around them."""

FLOAT_ROOM = INTEGER_ROOM + 1 + 2 * FLOAT_DIGITS + 5
"""The digits by themselves, then the text: a sign, before each digit a point for all that the proof knows, an exponent."""

LEAST_PLAIN, MOST_PLAIN = -3, 16
"""Digits before the point between which Python writes a float without an exponent (`repr`)."""

TEN = Const("u64", 10)
NAN, INFINITE = int.from_bytes(b"nan", "big"), int.from_bytes(b"inf", "big")


def written_integer(writer: Writer, number: Expr) -> View:
    """An integer or bool of any type, in decimal."""
    start = room(writer, index(INTEGER_ROOM))
    first = _integer(writer, *_signed(writer, number), start)
    return kept(writer, start, first, add(start, INTEGER_ROOM), valid=True)


def _signed(writer: Writer, number: Expr) -> tuple[Expr, Expr]:
    """The absolute value as a u64, and 1 where there is a minus."""
    if type_of(number) == "u64":
        return number, index(0)
    value = writer.let("number", number if type_of(number) == "i64" else Convert("i64", number))
    sign = writer.let("sign", Select(Compare("lt", value, index(0)), index(1), index(0)))
    below = writer.let("below", Select(Compare("lt", value, index(0)), Unary("not", value), value))  # -1 - value: that always fits
    return Binary("add", Convert("u64", below), Convert("u64", sign)), sign


def _integer(writer: Writer, magnitude: Expr, sign: Expr, target: Expr) -> Local:
    """Write digits that end where the room ends; gives the first byte."""

    def make(inner: Writer) -> Contract:
        magnitude, sign, target = inner.parameter("magnitude", "u64"), inner.parameter("sign", "i64"), inner.parameter("target", "i64")
        rest, count = inner.var("rest", magnitude), inner.var("count", index(0))
        _digit(inner, rest, count, target)
        with inner.nested() as body:
            _digit(inner, rest, count, target)
        more = Binary("and", Compare("gt", rest, Const("u64", 0)), Compare("lt", count, index(INTEGER_ROOM - 1)))
        limits = Compare("ge", count, index(1)), Compare("le", count, index(INTEGER_ROOM - 1))
        inner.emit(While(more, block(body), limits, count))
        with inner.nested() as minus:
            put(inner, _backward(target, count), ord("-"))
            inner.assign(count, add(count, 1))
        inner.emit(If(Compare("eq", sign, index(1)), block(minus)))
        first = inner.let("first_digit", add(_backward(target, count), 1))
        ends = Compare("ge", first, target), Compare("le", first, add(target, INTEGER_ROOM))
        return Contract((magnitude, sign, target), (first,), has_room(inner, target, index(INTEGER_ROOM)), ends)

    (first,) = writer.call("write_integer", make, (magnitude, sign, target), MESSAGE)
    return first


def _digit(writer: Writer, rest: Local, count: Local, target: Local) -> None:
    """Write the last digit of the rest."""
    put(writer, _backward(target, count), Convert("u8", Binary("add", Binary("rem", rest, TEN), Const("u64", ord("0")))))
    writer.assign(rest, Binary("div", rest, TEN))
    writer.assign(count, add(count, 1))


def _backward(target: Expr, count: Expr) -> Expr:
    return Binary("sub", add(target, INTEGER_ROOM - 1), count)


# --- floats --------------------------------------------------------------------------------------------------------------


def written_float(writer: Writer, number: Expr, decimals: int | None) -> View:
    """A float, with as many decimals as it needs, or with so many: then it is below 1e17 once they are moved before the point."""
    value = writer.let("number", number)
    scale = Scale(value) if decimals is None else index(-decimals)
    arguments = Digits(value, decimals), scale, _sign(value), index(0 if decimals is None else 1), _special(value)
    start = room(writer, index(FLOAT_ROOM))
    (after,) = writer.call("write_float", _write_float, (*arguments, start), MESSAGE)
    return kept(writer, start, add(start, INTEGER_ROOM), after, valid=True)


def is_special(value: Local) -> Expr:
    """Whether a float is none that digits spell: infinite, or NaN."""
    return Compare("ne", _special(value), index(0))


def _special(value: Local) -> Expr:
    infinite = Compare("eq", Unary("abs", value), Const(value.type, math.inf))
    return Select(Compare("ne", value, value), index(NAN), Select(infinite, index(INFINITE), index(0)))


def _sign(value: Local) -> Expr:
    """1 where a float has a minus: also -0.0, whose reciprocal is below 0."""
    zero = Const(value.type, 0.0)
    reciprocal = Binary("div", Const(value.type, 1.0), value)
    return Select(Binary("or", Compare("lt", value, zero), Compare("lt", reciprocal, zero)), index(1), index(0))


def _write_float(writer: Writer) -> Contract:
    digits, scale = writer.parameter("digits", "u64"), writer.parameter("scale", "i64")
    sign, fixed, special, target = (writer.parameter(name, "i64") for name in ("sign", "fixed", "special", "target"))
    to = writer.var("to", add(target, INTEGER_ROOM))
    with writer.nested() as minus:
        _put(writer, to, ord("-"))
    writer.emit(If(Compare("eq", sign, index(1)), block(minus)))
    with writer.nested() as word:
        for shift in (16, 8, 0):
            _put(writer, to, Convert("u8", Binary("shr", special, index(shift))))
    with writer.nested() as number:
        _write_number(writer, _shortened(writer, digits, scale, fixed), fixed, target, to)
    writer.emit(If(Compare("ne", special, index(0)), block(word), block(number)))
    limits = Compare("ge", scale, index(-LARGEST_SCALE)), Compare("le", scale, index(LARGEST_SCALE))
    low, high = add(target, INTEGER_ROOM), add(target, FLOAT_ROOM)
    after = writer.let("after", between(to, low, high))
    ends = Compare("ge", after, low), Compare("le", after, high)
    return Contract((digits, scale, sign, fixed, special, target), (after,), (*has_room(writer, target, index(FLOAT_ROOM)), *limits), ends)


def _put(writer: Writer, to: Local, byte: Expr | int) -> None:
    put(writer, to, byte)
    writer.assign(to, add(to, 1))


def _shortened(writer: Writer, digits: Local, scale: Local, fixed: Local) -> tuple[Local, Local]:
    """Digits and scale without zeros at the end, unless they are wanted."""
    rest, power, dropped = writer.var("rest", digits), writer.var("power", scale), writer.var("dropped", index(0))
    with writer.nested() as body:
        writer.assign(rest, Binary("div", rest, TEN))
        writer.assign(power, add(power, 1))
        writer.assign(dropped, add(dropped, 1))
    is_round = Binary("and", Compare("gt", rest, Const("u64", 0)), Compare("eq", Binary("rem", rest, TEN), Const("u64", 0)))
    more = Binary("and", Binary("and", is_round, Compare("eq", fixed, index(0))), Compare("lt", dropped, index(INTEGER_ROOM)))
    limits = Compare("ge", dropped, index(0)), Compare("le", dropped, index(INTEGER_ROOM))
    writer.emit(While(more, block(body), (*limits, Compare("eq", power, Binary("add", scale, dropped))), dropped))
    return rest, power


def _write_number(writer: Writer, number: tuple[Local, Local], fixed: Local, target: Local, to: Local) -> None:
    """Digit by digit, with zeros where there are none, and the point where it belongs."""
    digits, power = number
    first = _integer(writer, digits, index(0), target)
    count = writer.let("count", Binary("sub", add(target, INTEGER_ROOM), first))
    point = writer.let("point", Binary("add", power, count))
    is_short = Binary("and", Compare("ge", point, index(LEAST_PLAIN)), Compare("le", point, index(MOST_PLAIN)))
    plain = writer.let("plain", Select(Binary("or", is_short, Compare("eq", fixed, index(1))), index(1), index(0)))
    dot = writer.let("dot", Select(Compare("eq", plain, index(1)), point, index(1)))
    low = writer.let("low", Binary("min", index(0), add(dot, -1)))
    decimal = Binary("and", Compare("eq", plain, index(1)), Compare("eq", fixed, index(0)))
    high = Select(decimal, Binary("max", count, add(dot, 1)), count)
    rounds = writer.let("rounds", between(Binary("sub", high, low), index(0), index(FLOAT_DIGITS)))
    begun, number_at = writer.let("begun", to), writer.var("round", index(0))
    with writer.nested() as body:
        at = writer.let("at", Binary("add", low, number_at))
        with writer.nested() as here:
            _put(writer, to, ord("."))
        writer.emit(If(Compare("eq", at, dot), block(here)))
        _put(writer, to, _digit_at(writer, first, at, count))
        writer.assign(number_at, add(number_at, 1))
    limits = Compare("ge", number_at, index(0)), Compare("le", number_at, rounds)
    reached = Compare("ge", to, begun), Compare("le", to, Binary("add", begun, mul(number_at, 2)))
    writer.emit(While(Compare("lt", number_at, rounds), block(body), (*limits, *reached), number_at))
    with writer.nested() as exponent:
        _write_exponent(writer, writer.let("exponent", add(point, -1)), to)
    writer.emit(If(Compare("eq", plain, index(0)), block(exponent)))


def _digit_at(writer: Writer, first: Local, at: Local, count: Local) -> Local:
    digit = writer.var("digit", Const("u8", ord("0")))
    with writer.nested() as there:
        writer.assign(digit, Get("u8", Place(lane_of(writer), Binary("add", first, at))))
    writer.emit(If(Binary("and", Compare("ge", at, index(0)), Compare("lt", at, count)), block(there)))
    return digit


def _write_exponent(writer: Writer, exponent: Local, to: Local) -> None:
    """As C writes it: a sign, and two digits or three."""
    _put(writer, to, ord("e"))
    _put(writer, to, Select(Compare("lt", exponent, index(0)), Const("u8", ord("-")), Const("u8", ord("+"))))
    size = writer.let("exponent_size", Unary("abs", exponent))
    with writer.nested() as large:
        _put(writer, to, _figure(Binary("div", size, index(100))))
    writer.emit(If(Compare("ge", size, index(100)), block(large)))
    _put(writer, to, _figure(Binary("div", Binary("rem", size, index(100)), index(10))))
    _put(writer, to, _figure(Binary("rem", size, index(10))))


def _figure(number: Expr) -> Expr:
    return Convert("u8", add(number, ord("0")))
