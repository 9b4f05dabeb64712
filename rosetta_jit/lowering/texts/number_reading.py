"""Text as numbers: the whole of it, in decimal. A float is the nearest float64, whatever the digits."""

from __future__ import annotations

import math

from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Expr, Fits, If, Local, Nearest, Select, Stmt, Unary
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.lowering.limits import MAX_EXPONENT
from rosetta_jit.lowering.texts.number_writing import INFINITE, NAN
from rosetta_jit.lowering.texts.views import TRUE, Scan, View, between, byte_at, is_between, is_one_of, parameters, scanning, sound, within
from rosetta_jit.lowering.writer import MESSAGE, Contract, Writer, block
from rosetta_jit.startup.dataclass import dataclass

GOOD, NO_NUMBER, TOO_LARGE = 0, 1, 2
LEAST = -(1 << 63)

WHOLE, FRACTION, MARK, SIGN, POWER = range(5)
"""Where in a number a reader is: before the point, behind it, at an `e`, at the sign behind it, in the exponent."""


@dataclass(frozen=True, slots=True)
class Read:
    """A number, and whether there was none, or one that does not fit."""

    value: Expr
    is_none: Expr
    is_too_large: Expr


def read_integer(writer: Writer, view: View) -> Read:
    """An int64: digits, with a sign or without."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        sign, start = _sign(inner, view.lane, first, after)
        total = inner.var("total", index(0))
        state = inner.var("state", Select(Compare("lt", start, after), index(GOOD), index(NO_NUMBER)))
        with scanning(inner, view.lane, start, after) as scan:
            with inner.nested() as digit:
                _add_digit(inner, total, scan.byte, state)
            with inner.nested() as other:
                inner.assign(state, index(NO_NUMBER))
                inner.assign(scan.done, TRUE)
            inner.emit(If(_is_digit(scan.byte), block(digit), block(other)))
        with inner.nested() as positive:
            _turn(inner, total, state)
        inner.emit(If(Compare("eq", sign, index(0)), block(positive)))
        return Contract((first, after), (total, state), known, ())

    value, state = writer.call(f"read_integer_{view.memory}", make, (view.first, view.after), MESSAGE)
    return Read(value, Compare("eq", state, index(NO_NUMBER)), Compare("eq", state, index(TOO_LARGE)))


def _sign(writer: Writer, lane: int | None, first: Local, after: Local) -> tuple[Local, Local]:
    """1 where a minus comes first, and where the digits begin."""
    sign, start = writer.var("sign", index(0)), writer.var("start", first)
    with writer.nested() as some:
        byte = writer.let("byte", byte_at(lane, first))
        writer.assign(sign, Select(is_one_of(byte, b"-"), index(1), index(0)))
        writer.assign(start, Select(is_one_of(byte, b"+-"), add(first, 1), first))
    writer.emit(If(Compare("lt", first, after), block(some)))
    return sign, writer.let("digits", between(start, first, after))


def _is_digit(byte: Expr) -> Expr:
    return is_between(byte, ord("0"), ord("9"))


def _value(byte: Expr) -> Expr:
    return Binary("and", Convert("i64", byte), index(15))


def _add_digit(writer: Writer, total: Local, byte: Local, state: Local) -> None:
    """Count downward: the least int64 has no opposite."""
    digit = writer.let("digit", _value(byte))
    with writer.nested() as large:
        writer.assign(state, index(TOO_LARGE))
    with writer.nested() as tenfold:
        shifted = writer.let("shifted", mul(total, 10))
        with writer.nested() as fits:
            writer.assign(total, Binary("sub", shifted, digit))
        writer.emit(If(Fits("sub", shifted, digit), block(fits), block(large)))
    writer.emit(If(Fits("mul", total, index(10)), block(tenfold), block(large)))


def _turn(writer: Writer, total: Local, state: Local) -> None:
    with writer.nested() as fits:
        writer.assign(total, Unary("neg", total))
    with writer.nested() as large:
        writer.assign(state, Select(Compare("eq", state, index(GOOD)), index(TOO_LARGE), state))
    writer.emit(If(Compare("gt", total, index(LEAST)), block(fits), block(large)))


# --- floats --------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Float:
    """What is known of a float while its bytes are looked at."""

    phase: Local
    seen: Local
    stop: Local
    decimals: Local
    power: Local
    minus: Local
    good: Local


def read_float(writer: Writer, view: View) -> Read:
    """A float64: digits with a point, or none, and an exponent, or none; `nan`; `inf`."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        sign, start = _sign(inner, view.lane, first, after)
        special = _special(inner, view.lane, start, after)
        phase, seen, decimals, power, minus = (inner.var(name, index(0)) for name in ("phase", "seen", "decimals", "power", "minus"))
        found = _Float(phase, seen, inner.var("stop", after), decimals, power, minus, inner.var("good", index(1)))

        def keeps(at: Local) -> tuple[Expr, ...]:
            counted = Compare("ge", found.decimals, index(0)), Compare("le", found.decimals, Binary("sub", at, start))
            return *counted, Compare("ge", found.power, index(0)), Compare("le", found.power, index(MAX_EXPONENT))

        with scanning(inner, view.lane, start, after, keeps) as scan:
            _look_at(inner, scan, found)
        complete = Binary("or", Compare("le", found.phase, index(FRACTION)), Compare("eq", found.phase, index(POWER)))
        usable = Binary("and", Compare("eq", Binary("and", found.good, found.seen), index(1)), complete)
        state = inner.let("state", Select(Binary("or", usable, Compare("ne", special, index(0))), index(GOOD), index(NO_NUMBER)))
        power = Select(Compare("eq", found.minus, index(1)), Unary("neg", found.power), found.power)
        exponent = inner.let("exponent", Binary("sub", power, found.decimals))
        stop = inner.let("end_of_digits", between(found.stop, start, after))
        return Contract((first, after), (start, stop, exponent, sign, special, state), known, within(first, start, stop, after=after))

    results = writer.call(f"read_float_{view.memory}", make, (view.first, view.after), MESSAGE)
    return _as_float(writer, view, results)


def _as_float(writer: Writer, view: View, results: tuple[Local, ...]) -> Read:
    start, stop, exponent, sign, special, state = results
    digits = sound(writer, View(view.lane, start, stop))
    read = writer.let("read", Nearest(digits.address, digits.size, exponent))
    named = Select(Compare("eq", special, index(NAN)), Const("f64", math.nan), Const("f64", math.inf))
    size = writer.let("size", Select(Compare("ne", special, index(0)), named, read))
    infinite = Binary("and", Compare("eq", read, Const("f64", math.inf)), Compare("eq", special, index(0)))
    value = writer.let("number", Select(Compare("eq", sign, index(1)), Unary("neg", size), size))
    return Read(value, Compare("eq", state, index(NO_NUMBER)), infinite)


def _special(writer: Writer, lane: int | None, start: Local, after: Local) -> Local:
    """`nan` or `inf`, as a number of three bytes; else 0."""
    special = writer.var("special", index(0))
    with writer.nested() as three:
        found: Expr = index(0)
        for place, shift in enumerate((16, 8, 0)):
            found = Binary("or", found, Binary("shl", Convert("i64", byte_at(lane, add(start, place))), index(shift)))
        word = writer.let("word", found)
        named = Binary("or", Compare("eq", word, index(NAN)), Compare("eq", word, index(INFINITE)))
        writer.assign(special, Select(named, word, index(0)))
    writer.emit(If(Compare("eq", Binary("sub", after, start), index(3)), block(three)))
    return special


def _look_at(writer: Writer, scan: Scan, found: _Float) -> None:
    before_power = Compare("le", found.phase, index(FRACTION))
    with writer.nested() as digit:
        _take_digit(writer, scan.byte, found)
    with writer.nested() as point:
        writer.assign(found.phase, index(FRACTION))
    with writer.nested() as mark:
        writer.assign(found.phase, index(MARK))
        writer.assign(found.stop, scan.at)
    with writer.nested() as sign:
        writer.assign(found.phase, index(SIGN))
        writer.assign(found.minus, Select(is_one_of(scan.byte, b"-"), index(1), index(0)))
    with writer.nested() as other:
        writer.assign(found.good, index(0))
        writer.assign(scan.done, TRUE)
    is_mark = Binary("and", is_one_of(scan.byte, b"eE"), Binary("and", before_power, Compare("eq", found.seen, index(1))))
    ways: list[tuple[Expr, list[Stmt]]] = [
        (_is_digit(scan.byte), digit),
        (Binary("and", is_one_of(scan.byte, b"."), Compare("eq", found.phase, index(WHOLE))), point),
        (is_mark, mark),
        (Binary("and", is_one_of(scan.byte, b"+-"), Compare("eq", found.phase, index(MARK))), sign),
    ]
    rest = block(other)
    for condition, then in reversed(ways):
        rest = (If(condition, block(then), rest),)
    writer.emit(*rest)


def _take_digit(writer: Writer, byte: Local, found: _Float) -> None:
    with writer.nested() as mantissa:
        writer.assign(found.seen, index(1))
        writer.assign(
            found.decimals, Binary("add", found.decimals, Select(Compare("eq", found.phase, index(FRACTION)), index(1), index(0)))
        )
    with writer.nested() as power:
        writer.assign(found.phase, index(POWER))
        writer.assign(found.power, Binary("min", Binary("add", mul(found.power, 10), _value(byte)), index(MAX_EXPONENT)))
    writer.emit(If(Compare("le", found.phase, index(FRACTION)), block(mantissa), block(power)))
