"""Constant expressions: their values, and whether a type can hold them (OMG IDL 4.2, 7.4.1.4.3)."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Literal as OneOf
from typing import assert_never

from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg.expressions import Binary, Expr, Literal, ScopedName, Unary, computed
from rosetta_jit.frameworks.omg.lexer import LiteralError, Token, number, unescape
from rosetta_jit.frameworks.omg.problems import LookupProblem
from rosetta_jit.model.types import Bool, Constant, Float, Int, Ref, String, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace

Sort = OneOf["integer", "floating", "boolean", "character", "wide character", "string", "wide string", "enumerator", "fixed"]

LOWEST, HIGHEST = -(1 << 63), (1 << 64) - 1
LARGEST_FLOAT = (2 - 2**-23) * 2.0**127
SORTS: dict[str, Sort] = {"string": "string", "wstring": "wide string", "char": "character", "wchar": "wide character"}


@dataclass(frozen=True, slots=True)
class Value:
    """A value that an expression has; that of an enumerator is its number, and ``enum`` the name of its enum.

    ``complement`` is set where `~` made it: of what width it is, only the type tells for which it is meant.
    """

    sort: Sort
    value: Constant
    enum: str = ""
    complement: bool = False


Lookup = Callable[[ScopedName], Value]


def evaluate(node: Expr, lookup: Lookup) -> Value:
    """The value of an expression; raises LookupProblem where it has none."""
    match node:
        case Literal(tokens, span):
            return _literal(tokens, span)
        case ScopedName():
            return lookup(node)
        case Unary(operator, operand, span):
            return _unary(operator, evaluate(operand, lookup), span)
        case Binary(operator, left, right):
            return _binary(node, operator, evaluate(left, lookup), evaluate(right, lookup))
        case _:
            assert_never(node)


def fit(value: Value, type_: Type, span: Span) -> Constant:
    """A value as one of a type; raises LookupProblem where the type has no such value."""
    match type_, value:
        case Int(8 | 16, spelling=("char" | "wchar") as word), Value("character" | "wide character", str() as text):
            if (word == "wchar") != (value.sort == "wide character") or ord(text) >= 1 << type_.bits:
                raise LookupProblem(say.wrong_value(span, word, _named(value)))
            return ord(text)
        case Int(bits, signed), Value("integer", int() as number_) if type_.spelling not in ("char", "wchar"):
            return _ranged(number_ % (1 << bits) if value.complement and number_ < 0 and not signed else number_, type_, span)
        case Float(bits), Value("floating", float() as real):
            if bits == 32 and abs(real) > LARGEST_FLOAT:
                raise LookupProblem(say.out_of_range(span, str(real), "float"))
            return real
        case Bool(), Value("boolean", bool() as truth):
            return truth
        case Ref(name), Value("enumerator", int() as ordinal, enum) if enum == name:
            return ordinal
        case String(encoding), Value("string" | "wide string", str() as text) if (value.sort == "wide string") == (encoding == "utf-16"):
            if type_.maximum is not None and len(text) > type_.maximum:
                raise LookupProblem(say.too_long(span, len(text), type_.maximum))
            return text
        case _:
            raise LookupProblem(say.wrong_value(span, word_of(type_), _named(value)))


def as_text(value: Value, type_: Type) -> Value:
    """A narrow string as a wide one where the type is: rosidl writes all strings without `L`."""
    wide = isinstance(type_, String) and type_.encoding == "utf-16" and value.sort == "string"
    return replace(value, sort="wide string") if wide else value


def word_of(type_: Type) -> str:
    """The word by which people call a type."""
    return getattr(type_, "spelling", "") or getattr(type_, "name", "") or type(type_).__name__.lower()


def _named(value: Value) -> str:
    return f"{'an' if value.sort[0] in 'aeiou' else 'a'} {value.sort}" + (" constant" if value.sort != "enumerator" else "")


def _ranged(number_: int, type_: Int, span: Span) -> int:
    low, high = (-(1 << type_.bits - 1), (1 << type_.bits - 1) - 1) if type_.signed else (0, (1 << type_.bits) - 1)
    if not low <= number_ <= high:
        raise LookupProblem(say.out_of_range(span, str(number_), type_.spelling))
    return number_


def _literal(tokens: tuple[Token, ...], span: Span) -> Value:
    first = tokens[0]
    if first.kind == "word":
        return Value("boolean", first.text == "TRUE")
    try:
        if first.kind == "number":
            found = number(first.text)
            return Value("fixed", first.text) if found is None else _number(found, span)
        wide = first.kind in ("wstring", "wchar")
        text = "".join(unescape(token.text.removeprefix("L")[1:-1], wide=wide) for token in tokens)
    except LiteralError as error:
        raise LookupProblem(say.wrong_literal(span, str(error))) from error
    sort = SORTS[first.kind]
    if first.kind in ("char", "wchar") and len(text) != 1:
        raise LookupProblem(say.wrong_literal(span, "a character literal holds one character"))
    if first.kind in ("string", "wstring") and "\0" in text:
        raise LookupProblem(say.wrong_literal(span, "a string holds no NUL"))
    return Value(sort, text)


def _number(value: float, span: Span) -> Value:
    """A number within the limits of every type."""
    if isinstance(value, float):
        if not isfinite(value):
            raise LookupProblem(say.out_of_range(span, "the value", "double"))
        return Value("floating", value)
    if not LOWEST <= value <= HIGHEST:
        raise LookupProblem(say.out_of_range(span, "the value", "long long" if value < 0 else "unsigned long long"))
    return Value("integer", value)


def _unary(operator: str, operand: Value, span: Span) -> Value:
    match operator, operand.value:
        case "-" | "+", int() | float() as number_ if operand.sort in ("integer", "floating"):
            return _number(-number_ if operator == "-" else number_, span)
        case "~", int() as number_ if operand.sort == "integer":
            return Value("integer", -number_ - 1, complement=True)
        case _:
            raise LookupProblem(say.wrong_operand(span, operator, _named(operand)))


def _binary(node: Binary, operator: str, left: Value, right: Value) -> Value:
    match left, right:
        case Value("integer", int() as a), Value("integer", int() as b):
            value = _number(computed(node, a, b, LookupProblem), node.span)
            return Value("integer", value.value, complement=left.complement or right.complement)
        case Value("floating", float() as a), Value("floating", float() as b) if operator in "+-*/":
            if operator == "/" and b == 0:
                raise LookupProblem(say.division_by_zero(node.right.span))
            return _number({"+": float.__add__, "-": float.__sub__, "*": float.__mul__, "/": float.__truediv__}[operator](a, b), node.span)
        case _:
            raise LookupProblem(say.wrong_operand(node.span, operator, f"{_named(left)} and {_named(right)}"))
