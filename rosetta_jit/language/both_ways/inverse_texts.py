"""Turn functions of texts round.

| expression           | its field                                              |
|----------------------|--------------------------------------------------------|
| `text(n)`            | the number that is written, as the field holds it      |
| `integer(s)` `number(s)` | `text(value)`                                      |
| `text(b, "utf-8")`   | `bytes(value, "utf-8")`, and the reverse               |
| `until_nul(b)`       | the text, NUL behind it where the field has one size   |
| `padded(s, n)`       | `until_nul(value)`                                     |
| `"a" + s`, `s + "a"` | `behind(value, "a")`, `before(value, "a")`, and the reverse |
| `join(texts, "by")`  | `split(value, "by")`, and the reverse                  |
| `iso8601(ns)` `timestamp(ns)` | `nanoseconds(value)`                          |
| `nanoseconds(s)`     | `iso8601(value)`, or `timestamp(value)` for a float    |
| `seconds(s)`         | `iso8601(value, 0)`, or `timestamp(value, 0)`          |

Three of these depend on the type of the field, which `language.resolve.rules` knows: it finds a call of `WRITTEN`, `FILLED` or `MOMENT`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.model.expr import Binary, Call, Choice, Literal, Nearest, Unary
from rosetta_jit.model.types import Array, Bytes, Float, Int
from rosetta_jit.model.walk import rebuilt

if TYPE_CHECKING:
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.types import Type

WRITTEN, FILLED, MOMENT = "(written)", "(filled)", "(moment)"
"""The number that a text spells; a text as large as its field; a point in time. No mapping can write such names."""

SHOWN = {WRITTEN: "number", FILLED: "padded", MOMENT: "iso8601"}
"""What they are called where the type of the field does not matter."""


def opposite(call: Call, value: Expr) -> tuple[Expr, Expr] | None:
    """What a call of a function of texts is applied to, and what that must be; None where several texts give the same."""
    span = call.span
    match call.function, call.arguments:
        case "text", (inner, Literal(str()) as encoding):
            return inner, Call("bytes", (value, encoding), span)
        case "text", (inner, *_):
            return inner, Call(WRITTEN, (value,), span)
        case (("integer" | "number"), (inner,)):
            return inner, Call("text", (value,), span)
        case "bytes", (inner, encoding):
            return inner, Call("text", (value, encoding), span)
        case "until_nul", (inner,):
            return inner, Call(FILLED, (value,), span)
        case "padded", (inner, _):
            return inner, Call("until_nul", (value,), span)
        case "behind", (inner, start):
            return inner, Binary("+", start, value, span)
        case "before", (inner, end):
            return inner, Binary("+", value, end, span)
        case (("join" | "split") as function, (inner, separator)):
            return inner, Call("split" if function == "join" else "join", (value, separator), span)
        case (("iso8601" | "timestamp"), (inner,)):
            return inner, Call("nanoseconds", (value,), span)
        case "nanoseconds", (inner,):
            return inner, Call(MOMENT, (value,), span)
        case "seconds", (inner,):
            return inner, Call(MOMENT, (value, Literal(0, span)), span)
        case _:
            return None


def without(sum_: Binary, value: Expr) -> tuple[Expr, Expr] | None:
    """The field of a sum of texts of which one is written down."""
    match sum_:
        case Binary("+", Literal(str()) as start, inner, span):
            return inner, Call("behind", (value, start), span)
        case Binary("+", inner, Literal(str()) as end, span):
            return inner, Call("before", (value, end), span)
        case _:
            return None


def for_comparison(call: Call) -> Call:
    """A call that was turned round where no field asks for a type: what it is compared with may be any number."""
    return replace(call, function=SHOWN[call.function]) if call.function in (WRITTEN, MOMENT) else call


def as_written(expr: Expr) -> Expr:
    """An expression that was turned round, as a person reads it."""
    inner = rebuilt(expr, as_written)
    match inner:
        case Call(name, arguments, span) if name in SHOWN:
            return Call(SHOWN[name], arguments, span)
        case _:
            return inner


def for_type(expr: Expr, type_: Type) -> Expr:
    """An expression that was turned round, for a field of a type."""
    match expr:
        case Nearest(value):
            inner = for_type(value, type_)
            return replace(expr, value=inner, type=type_) if isinstance(type_, Int) else inner
        case Choice(cases, otherwise):
            pairs = tuple((condition, for_type(chosen, type_)) for condition, chosen in cases)
            return replace(expr, cases=pairs, otherwise=None if otherwise is None else for_type(otherwise, type_))
        case Unary(_, operand):
            return replace(expr, operand=for_type(operand, type_))
        case Binary(_, left, right):
            return replace(expr, left=for_type(left, type_), right=for_type(right, type_))
        case Call(name, arguments, span):
            inner = tuple(for_type(argument, type_) for argument in arguments)
            if name == WRITTEN:
                return Call("number" if isinstance(type_, Float) else "integer", inner, span)
            if name == MOMENT:
                return Call("timestamp" if isinstance(type_, Float) else "iso8601", inner, span)
            if name != FILLED:
                return Call(name, inner, span)
            size = type_.length if isinstance(type_, Array | Bytes) else None
            return Call("padded", (*inner, Literal(size, span)), span) if isinstance(size, int) else inner[0]
        case _:
            return expr
