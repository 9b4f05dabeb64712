"""Values that are taken apart and put together again: what is left of them, for both directions one after the other.

floor_divide(x · c + y, c) = x      modulo(x · c + y, c) = y      where 0 ≤ y < c is known
floor_divide(x, c) · c + modulo(x, c) = x
nanoseconds(x, y) as x · 10⁹ + y, of which 0 ≤ y < 10⁹ is checked
seconds(iso8601(x, y)) = x          fraction(iso8601(x, y)) = y
decompress(compress(x, "png", ...), "png", ...) = x, with the same measures
signal(signal_bytes(n, d, x), d) = x, and signal_bytes of all signals of x is x
iso8601(seconds(x), fraction(x)) = iso8601(nanoseconds(x)), and timestamp likewise
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.language.laws.chain import come_back, field_in
from rosetta_jit.language.signal_bits import signal_of
from rosetta_jit.language.typed import BOOL, INT64, Access, Binary, Call, Const, Convert
from rosetta_jit.language.walk import rebuilt
from rosetta_jit.model.types import Array, Bytes, Int, String

if TYPE_CHECKING:
    from rosetta_jit.language.typed import Expr

SECOND, ZERO = Const(10**9, INT64), Const(0, INT64)

JPEG = Const("jpeg", String())
"""The format of which pixels do not come back."""

Truth = Callable[["Expr"], "bool | None"]

Parts = tuple["Expr", "Expr", Const]
"""A number as x · c + y, with x, y and c."""


def simplified(expr: Expr, truth: Truth) -> Expr | None:
    """What an expression of parts comes to; None where that does not follow. ``truth`` says of conditions whether they hold."""
    match expr:
        case Call(("floor_divide" | "modulo") as function, (number, Const() as divisor)):
            found = _sum(bare(number), truth)
            return None if found is None or found[2].value != divisor.value else found[0 if function == "floor_divide" else 1]
        case Call(("seconds" | "fraction") as function, (Call("iso8601", (whole, behind)),)):
            return whole if function == "seconds" else behind
        case Call("repeated", (Call("run_values", (array,)), Call("run_lengths", (other,)))) if array == other:
            return array
        case Call("decompress", (Call("compress", (pixels, *told)), *asked)) if told == asked and told[0] != JPEG:
            return pixels
        case Call(("image_width" | "image_height" | "image_channels") as measure, (Call("compress", (_, _, width, height, channels, _)),)):
            return {"image_width": width, "image_height": height, "image_channels": channels}[measure]
        case Call("signal", (Call("signal_bytes", (_, *signals)), described)):
            return _signal(expr, signals, described)
        case Call("signal_bytes", (Const(size), *signals)):
            return _frame(int(size), signals)
        case Call("nanoseconds", (whole, behind)):
            return _whole(bare(whole), bare(behind), SECOND)
        case Call("iso8601" | "timestamp", (whole, behind)):
            return _moment(expr, bare(whole), bare(behind))
        case Binary("+", left, right):
            return _added(bare(left), bare(right)) or _added(bare(right), bare(left))
        case _:
            return None


def bare(expr: Expr) -> Expr:
    """An integer without the conversions that leave it the same number."""
    while (
        isinstance(expr, Convert) and expr.rule in {"widen", "exact"} and isinstance(expr.type, Int) and isinstance(expr.operand.type, Int)
    ):
        expr = expr.operand
    return expr


def _sum(number: Expr, truth: Truth) -> Parts | None:
    match number:
        case Call("nanoseconds", (whole, behind)):
            return whole, behind, SECOND
        case Binary("+", left, right):
            for product, rest in ((bare(left), right), (bare(right), left)):
                match product:
                    case Binary("*", inner, Const() as factor) | Binary("*", Const() as factor, inner) if _is_digit(rest, factor, truth):
                        return inner, rest, factor
                    case _:
                        pass
            return None
        case _:
            return None


def _is_digit(value: Expr, factor: Const, truth: Truth) -> bool:
    """Whether a value is known to be from 0 to below a number."""
    number = bare(value)
    for each in (number, Convert(number, INT64, "widen")):  # as it is compared with what its type holds, or does not
        below = Binary("<", each, replace(ZERO, type=each.type), BOOL)
        above = Binary(">=", each, replace(factor, type=each.type), BOOL)
        if truth(below) is False and truth(above) is False:
            return True
    return False


def _signal(call: Call, signals: list[Expr], described: Expr) -> Expr | None:
    """The number that was put into a frame at this place."""
    numbers = dict(zip(signals[::2], signals[1::2], strict=True))
    number = numbers.get(described)
    if number is None:
        return None
    found = bare(number)
    return found if found.type == call.type else Convert(found, call.type, "exact", call.span)


def _frame(size: int, signals: list[Expr]) -> Expr | None:
    """The frame whose signals are put where they were read, if they are all of its bits."""
    bits: set[int] = set()
    frames: list[Expr] = []
    for described, number in zip(signals[::2], signals[1::2], strict=True):
        match read_signal(number):
            case Call("signal", (frame, Const(str(also)))) if isinstance(described, Const) and described.value == also:
                known = signal_of(also)
                bits |= frozenset() if known is None else known.bits
                frames.append(frame)
            case _:
                return None
    frame = frames[0]
    is_whole = len(bits) == 8 * size and all(each == frame for each in frames)
    return frame if is_whole and isinstance(frame.type, Array | Bytes) and frame.type.length == size else None


def read_signal(number: Expr) -> Expr | None:
    """The signal that a number comes from, if what was done to it since is undone."""
    found: list[Expr] = []

    def marked(part: Expr) -> Expr:
        match part:
            case Call("signal", (Access(place), _)):
                found.append(part)
                return Access(replace(place, type=part.type), part.type)
            case _:
                return rebuilt(part, marked)

    value = bare(marked(number))
    leaf = field_in(value) if found and all(each == found[0] for each in found) else None
    return found[0] if leaf is not None and come_back(value, leaf) is None else None


def _moment(call: Call, whole: Expr, behind: Expr) -> Expr | None:
    """What both parts of one moment make: where they do not fit an int64 of nanoseconds, this is not computed."""
    match whole, behind:
        case Call("seconds", (moment,)), Call("fraction", (other,)) if moment == other:
            return replace(call, arguments=(Call("nanoseconds", (moment,), INT64),))
        case _:
            return None


def _added(product: Expr, rest: Expr) -> Expr | None:
    match product:
        case Binary("*", inner, Const() as factor) | Binary("*", Const() as factor, inner):
            return _whole(bare(inner), rest, factor)
        case _:
            return None


def _whole(high: Expr, low: Expr, factor: Const) -> Expr | None:
    """A number of its quotient and what that leaves."""
    match high, low:
        case Call("floor_divide", (number, Const(by))), Call("modulo", (other, Const(also))) if number == other:
            return number if by == also == factor.value else None
        case _:
            return None
