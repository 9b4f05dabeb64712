"""Types of text expressions: what functions take and give, concatenation, and comparison.

A text is a string, bytes, or an array of 8-bit integers. What is computed from a string is one, and from anything else bytes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import resolve
from rosetta_jit.catalogue import texts as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.conversions import FLOAT64, as_int64, convert, describe, is_textual
from rosetta_jit.language.function import Texts
from rosetta_jit.language.limits import MAX_COMPARED, MAX_PADDED, MAX_PATTERN, MAX_WRITTEN
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import BOOL, INT64, Access, Binary, Call, Const, Convert, Expr, Given
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, String
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    TypeExpr = Callable[[model.Expr, Scope], Expr | None]

TEXT, BYTES = String(), Bytes()
ENCODINGS = ("utf-8", "ascii", "latin-1", "utf-16le", "utf-16be")

SPELT = frozenset("0123456789+-.einfa")
"""Characters of numbers as text: none of them separates numbers."""


def separates(text: str) -> bool:
    """Whether a text can stand between numbers."""
    return bool(text) and not SPELT & set(text)


NAMED = "Enum(s)"
"""The function from the name of a constant to the constant, in typed calls. No mapping can write it: there it is a conversion."""


def name_of(constant: Expr, span: Span | None) -> Expr:
    """The name of an enum's constant."""
    match constant:
        case Const(value=value, type=Enum(values=values)) if value in (known := {number: name for name, number in reversed(values)}):
            return Const(known[int(value)], TEXT, span)
        case _:
            return Call("text", (constant,), TEXT, span)


def constant_named(name: Expr, enum: Enum, span: Span | None, scope: Scope) -> Expr | None:
    """The constant of an enum that a text names; None, and reported, where the text is known and names none."""
    known = dict(enum.values)
    long = next((each for each in known if len(each.encode()) > MAX_COMPARED), None)
    if long is not None:
        scope.problems.append(resolve.long_text(span, MAX_COMPARED))
        return None
    quoted = _quoted(name)
    if quoted is None:
        return Call(NAMED, (name,), enum, span)
    if quoted not in known:
        scope.problems.append(words.no_constant(name.span, quoted, enum.name, known))
        return None
    return Const(known[quoted], enum, span)


def type_texts(expr: model.Call, arguments: list[Expr], scope: Scope, signature: Texts) -> Expr | None:
    """The typed call of a function of texts."""
    takes, function = signature.takes, expr.function
    if not len(takes) - signature.optional <= len(arguments) <= len(takes):
        scope.problems.append(resolve.arguments(expr.span, function, words.listed(takes, signature.optional), len(arguments)))
        return None
    taken = [argument(function, kind, each, scope) for kind, each in zip(takes, arguments, strict=False)]
    fitting = [each for each in taken if each is not None]
    return Call(function, tuple(fitting), signature.gives or _kind(fitting[0]), expr.span) if len(fitting) == len(taken) else None


WITHOUT_END = Texts(("text", "pattern"), None)


def without_end(expr: model.Call, arguments: list[Expr], scope: Scope) -> Expr | None:
    """A text without an end that it has: all of it where that end is empty, as a parameter may be."""
    if len(arguments) == 2 and _quoted(arguments[1]) == "":
        return argument(expr.function, "text", arguments[0], scope)
    return type_texts(expr, arguments, scope, WITHOUT_END)


def concatenation(left: Expr, right: Expr, span: Span | None, scope: Scope) -> Expr | None:
    """``left + right``, of which one is a text at least."""
    pair = [argument("+", "text", each, scope) for each in (left, right)]
    if pair[0] is None or pair[1] is None:
        return None
    kinds = {type(_kind(each)) for each in (left, right) if not isinstance(each, Const)} or {String}
    if len(kinds) > 1:
        scope.problems.append(words.text_and_bytes(span))
        return None
    return Call("+", (pair[0], pair[1]), TEXT if String in kinds else BYTES, span)


def comparison(left: Expr, right: Expr, operator: model.Operator, span: Span | None) -> Expr | None:
    """``left == right`` and its like, byte by byte; None unless both are texts."""
    if not (is_textual(left.type) and is_textual(right.type)):
        return None
    return Binary(operator, Call("<=>", (left, right), INT64, span), Const(0, INT64), BOOL, span)


def type_pieces(pieces: tuple[model.Expr, ...], scope: Scope, type_expr: TypeExpr) -> tuple[Expr, ...]:
    """The pieces of a rejection as texts: numbers are written, enums by number."""
    found: list[Expr] = []
    for piece in pieces:
        value = type_expr(piece, scope)
        match None if value is None else value.type:
            case None:
                continue
            case Enum() if value is not None:
                found.append(Call("text", (Convert(value, INT64, "exact", value.span),), TEXT, value.span))
            case Bool() | Int() | Float() if value is not None:
                found.append(Call("text", (value,), TEXT, value.span))
            case _ if value is not None and _usable("reject", value, scope):
                found.append(value)
            case _:
                pass
    return tuple(found)


def _kind(value: Expr) -> String | Bytes:
    type_ = value.type.element if isinstance(value.type, Array) else value.type
    return TEXT if isinstance(type_, String) else BYTES


def argument(function: str, kind: str, value: Expr, scope: Scope) -> Expr | None:
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


def _pattern_problem(function: str, kind: str, value: Expr) -> Diagnostic | None:
    quoted = _quoted(value)
    if isinstance(value, Given) and isinstance(value.type, String):
        return None  # a parameter, whose text is looked at when it is given
    if quoted is None:
        return words.quoted_needed(value.span, function)
    if not quoted and kind != "quoted":
        return words.empty_pattern(value.span, function)
    if len(quoted.encode()) > MAX_PATTERN:
        return words.long_quoted(value.span, MAX_PATTERN)
    return words.not_ascii(value.span, function) if kind == "characters" and not quoted.isascii() else None


def _quoted(value: Expr) -> str | None:
    return value.value if isinstance(value, Const) and isinstance(value.value, str) else None
