"""Types of text expressions: the functions that take or give texts, concatenation, and comparison.

lower upper until_nul (s)   strip (s [, "chars"])   replace (s, "old", "new")   slice (s, start, stop)   part (s, "by", n)   padded (s, 16)
behind (s, "begin")   before (s, "end")   join (texts, "by")   split (s, "by"), which gives an array
text (number)   text (float, decimals)   text (bytes, "encoding")   bytes (s, "encoding")
iso8601 timestamp (ns)   iso8601 timestamp nanoseconds (secs, nsecs)   seconds fraction nanoseconds (s or float)
integer number (s)   parts (s, "by")   starts_with ends_with (s, t)   contains (s, "t")

A text is a string, bytes, or an array of 8-bit integers. What is computed from a string is one, and from anything else bytes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import resolve
from rosetta_jit.catalogue import texts as words
from rosetta_jit.language.conversions import FLOAT64, as_int64, convert, describe
from rosetta_jit.language.typed import BOOL, INT64, Access, Binary, Const, Convert, TextCall
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, String
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.language.scope import Scope
    from rosetta_jit.language.typed import Expr, TextFunction
    from rosetta_jit.model import expr as model
    from rosetta_jit.model.types import Type
    from rosetta_jit.source import Span

    TypeExpr = Callable[[model.Expr, Scope], Expr | None]

TEXT, BYTES = String(), Bytes()
ENCODINGS = ("utf-8", "ascii", "latin-1", "utf-16le", "utf-16be")
MAX_PATTERN = 64
"""Bytes of a text that another is searched for."""

MAX_PADDED = 1 << 16
MAX_DECIMALS = 17
MAX_WRITTEN = 4096
"""Bytes of a text in quotes that is computed with."""

BLANKS = " \t\n\r\v\f"


@dataclass(frozen=True, slots=True)
class Form:
    """What a function takes, by the kinds of its arguments, and gives; None where it gives what its first argument is."""

    takes: tuple[str, ...]
    gives: Type | None
    optional: int = 0


FORMS: dict[TextFunction, Form] = {
    "lower": Form(("text",), None),
    "upper": Form(("text",), None),
    "strip": Form(("text", "characters"), None, optional=1),
    "replace": Form(("text", "pattern", "quoted"), None),
    "slice": Form(("text", "integer", "integer"), None),
    "part": Form(("text", "pattern", "integer"), None),
    "behind": Form(("text", "pattern"), None),
    "before": Form(("text", "pattern"), None),
    "until_nul": Form(("text",), None),
    "padded": Form(("text", "size"), None),
    "join": Form(("texts", "pattern"), None),
    "split": Form(("text", "pattern"), None),
    "parts": Form(("text", "pattern"), INT64),
    "starts_with": Form(("text", "text"), BOOL),
    "ends_with": Form(("text", "text"), BOOL),
    "contains": Form(("text", "pattern"), BOOL),
    "integer": Form(("text",), INT64),
    "number": Form(("text",), FLOAT64),
    "bytes": Form(("text", "encoding"), BYTES),
    "iso8601": Form(("integer", "integer"), TEXT, optional=1),
    "timestamp": Form(("integer", "integer"), FLOAT64, optional=1),
    "seconds": Form(("moment",), INT64),
    "fraction": Form(("moment",), INT64),
    "nanoseconds": Form(("moment",), INT64),
}
PUT_TOGETHER = Form(("integer", "integer"), INT64)
"""`nanoseconds` of seconds and the nanoseconds behind them."""

WRITING = "text"
"""The function whose arguments are told apart by their types."""

NAMES = (*FORMS, WRITING)


def is_textual(type_: Type) -> bool:
    """Whether a value is bytes that lie one after another."""
    match type_:
        case String(encoding=encoding):
            return encoding != "utf-16"
        case Bytes() | Array(element=Int(8)):
            return True
        case _:
            return False


def type_text_call(expr: model.Call, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """The typed form of a call of a function of texts."""
    arguments = [type_expr(argument, scope) for argument in expr.arguments]
    known = [argument for argument in arguments if argument is not None]
    if len(known) < len(arguments):
        return None
    if expr.function == WRITING:
        return _written(expr, known, scope)
    function: TextFunction = next(name for name in FORMS if name == expr.function)
    form = PUT_TOGETHER if function == "nanoseconds" and len(known) == 2 else FORMS[function]
    if not len(form.takes) - form.optional <= len(known) <= len(form.takes):
        scope.problems.append(resolve.arguments(expr.span, function, words.listed(form.takes, form.optional), len(known)))
        return None
    if function in ("behind", "before") and _quoted(known[1]) == "":
        return _argument(function, "text", known[0], scope)  # a parameter may be empty, and then nothing is taken away
    taken = [_argument(function, kind, argument, scope) for kind, argument in zip(form.takes, known, strict=False)]
    fitting = [argument for argument in taken if argument is not None]
    if len(fitting) < len(taken):
        return None
    gives = form.gives or _kind(fitting[0])
    return TextCall(function, tuple(fitting), Array(gives) if function == "split" else gives, expr.span)


def type_length(expr: model.Call, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """``len(...)`` of a text that is computed."""
    (argument,) = expr.arguments
    typed = type_expr(argument, scope)
    text = None if typed is None else _argument("len", "text", typed, scope)
    return None if text is None else TextCall("size", (text,), INT64, expr.span)


def concatenation(left: Expr, right: Expr, span: Span | None, scope: Scope) -> Expr | None:
    """``left + right``, of which one is a text at least."""
    pair = [_argument("+", "text", each, scope) for each in (left, right)]
    if pair[0] is None or pair[1] is None:
        return None
    kinds = {type(_kind(each)) for each in (left, right) if not isinstance(each, Const)} or {String}
    if len(kinds) > 1:
        scope.problems.append(words.text_and_bytes(span))
        return None
    return TextCall("concatenated", (pair[0], pair[1]), TEXT if String in kinds else BYTES, span)


def comparison(left: Expr, right: Expr, operator: model.Operator, span: Span | None) -> Expr | None:
    """``left == right`` and its like, byte by byte; None unless both are texts."""
    if not (is_textual(left.type) and is_textual(right.type)):
        return None
    return Binary(operator, TextCall("compared", (left, right), INT64, span), Const(0, INT64), BOOL, span)


def type_pieces(pieces: tuple[model.Expr, ...], scope: Scope, type_expr: TypeExpr) -> tuple[Expr, ...]:
    """The pieces of a rejection as texts: numbers are written, enums by number."""
    found: list[Expr] = []
    for piece in pieces:
        value = type_expr(piece, scope)
        match None if value is None else value.type:
            case None:
                continue
            case Enum() if value is not None:
                found.append(TextCall("written", (Convert(value, INT64, "exact", value.span),), TEXT, value.span))
            case Bool() | Int() | Float() if value is not None:
                found.append(TextCall("written", (value,), TEXT, value.span))
            case _ if value is not None and _usable("reject", value, scope):
                found.append(value)
            case _:
                pass
    return tuple(found)


def _kind(value: Expr) -> String | Bytes:
    type_ = value.type.element if isinstance(value.type, Array) else value.type
    return TEXT if isinstance(type_, String) else BYTES


def _argument(function: str, kind: str, value: Expr, scope: Scope) -> Expr | None:
    """An argument as its function takes it, or None, and reported."""
    match kind:
        case "text":
            return value if _usable(function, value, scope) else None
        case "texts":
            return _texts(function, value, scope)
        case "integer":
            number = as_int64(value)
            if number is None:
                scope.problems.append(resolve.integer_needed(value.span, f"an argument of `{function}`", describe(value.type)))
            return number
        case "moment" if isinstance(value.type, Float):
            return convert(value, FLOAT64)
        case "moment":
            return value if _usable(function, value, scope) else None
        case "size":
            fits = isinstance(value, Const) and isinstance(value.type, Int) and 0 <= int(value.value) <= MAX_PADDED
            problem = None if fits else words.written_size(value.span, function, MAX_PADDED)
        case "encoding":
            problem = None if _quoted(value) in ENCODINGS else words.unknown_encoding(value.span, _quoted(value), ENCODINGS)
        case _:
            problem = _pattern_problem(function, kind, value)
    if problem is not None:
        scope.problems.append(problem)
        return None
    return value


def _texts(function: str, value: Expr, scope: Scope) -> Expr | None:
    """An array of texts that lies in a message, with the type of its elements resolved."""
    if isinstance(value, Access) and isinstance(value.type, Array):
        element = scope.messages[value.place.side].value_type(value.type.element)
        if isinstance(element, String | Bytes) and is_textual(element):
            return replace(value, type=replace(value.type, element=element))
    scope.problems.append(words.texts_needed(value.span, function, describe(value.type)))
    return None


def _usable(function: str, value: Expr, scope: Scope) -> bool:
    if not is_textual(value.type):
        wide = isinstance(value.type, String)
        scope.problems.append(words.wide_text(value.span) if wide else words.text_needed(value.span, function, describe(value.type)))
        return False
    if len((_quoted(value) or "").encode()) > MAX_WRITTEN:
        scope.problems.append(words.long_quoted(value.span, MAX_WRITTEN))
        return False
    return True


def _pattern_problem(function: str, kind: str, value: Expr) -> words.Diagnostic | None:
    quoted = _quoted(value)
    if quoted is None:
        return words.quoted_needed(value.span, function)
    if not quoted and kind != "quoted":
        return words.empty_pattern(value.span, function)
    if len(quoted.encode()) > MAX_PATTERN:
        return words.long_quoted(value.span, MAX_PATTERN)
    return words.not_ascii(value.span, function) if kind == "characters" and not quoted.isascii() else None


def _quoted(value: Expr) -> str | None:
    return value.value if isinstance(value, Const) and isinstance(value.value, str) else None


def _written(expr: model.Call, arguments: list[Expr], scope: Scope) -> Expr | None:
    """``text(...)``: what a number is written as, or bytes read as text."""
    match arguments:
        case [number] if isinstance(number.type, Bool | Int | Float):
            return TextCall("written", (number,), TEXT, expr.span)
        case [number, Const(value=int(decimals), type=Int())] if isinstance(number.type, Float) and 0 <= decimals <= MAX_DECIMALS:
            return TextCall("written", (number, arguments[1]), TEXT, expr.span)
        case [data, encoding] if is_textual(data.type) and not isinstance(data.type, String):
            known = _argument(WRITING, "encoding", encoding, scope)
            return None if known is None else TextCall("decoded", (data, known), TEXT, expr.span)
        case [_] | [_, _]:
            scope.problems.append(words.not_written(expr.span, [describe(argument.type) for argument in arguments], MAX_DECIMALS))
        case _:
            scope.problems.append(resolve.arguments(expr.span, WRITING, "a number, or bytes and their encoding", len(arguments)))
    return None
