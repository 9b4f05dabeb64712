"""What is asked of texts and answered by a number: sizes, order, what they hold, what they spell."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Compare, Unary
from rosetta_jit.lowering.texts.moments import moment
from rosetta_jit.lowering.texts.number_reading import Read, read_float, read_integer
from rosetta_jit.lowering.texts.search import compared, find, has_at, parts
from rosetta_jit.lowering.texts.values import expect, placed_of, quoted

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Expr
    from rosetta_jit.language import typed
    from rosetta_jit.lowering.evaluation import Evaluation


def number_of(call: typed.TextCall, values: Evaluation) -> Expr:
    """What a function of texts gives that gives no text."""
    writer, arguments = values.writer, call.arguments
    match call.function:
        case "size":
            return writer.let("size", placed_of(arguments[0], values).size)
        case "compared":
            left, right = (placed_of(each, values) for each in arguments)
            return compared(writer, left, right)
        case "starts_with" | "ends_with" as end:
            return has_at(writer, end, placed_of(arguments[0], values), placed_of(arguments[1], values))
        case "contains":
            view = placed_of(arguments[0], values)
            return Compare("lt", find(writer, view.lane, view.first, view.after, quoted(arguments[1])), view.after)
        case "parts":
            return parts(writer, placed_of(arguments[0], values), quoted(arguments[1]))
        case "integer":
            return _read(read_integer(writer, placed_of(arguments[0], values)), "an integer", "int64", values)
        case "number":
            return _read(read_float(writer, placed_of(arguments[0], values)), "a number", "float64", values)
        case "seconds" | "fraction" | "nanoseconds" | "timestamp":
            return moment(call, values, placed_of)
        case _:
            raise AssertionError(call)


def _read(read: Read, what: str, target: str, values: Evaluation) -> Expr:
    expect(values, Unary("not", read.is_none), "text", f"the text is not {what}")
    expect(values, Unary("not", read.is_too_large), "range", f"the number does not fit {target}")
    return read.value
