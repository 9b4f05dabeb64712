"""Constants of a bottle schema, written down or computed from fields of the message."""

from __future__ import annotations

from sys import float_info
from typing import Literal as OneOf

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.yarp import bottle_diagnostics as catalogue
from rosetta_jit.frameworks.yarp.bottle_schema.sexpr import Form, Node, Number, Text, Vocab, Word
from rosetta_jit.frameworks.yarp.tags import vocab
from rosetta_jit.model.expr import Binary, Call, Expr, Len, Literal, Member, Path
from rosetta_jit.model.types import Bool, Float, Int, String, Type
from rosetta_jit.source import Span

OPERATORS = ("+", "-", "*", "/", "align")
"""What two operands can have between them; `length` has one, a list, string or blob."""

LARGEST_FLOAT32 = (2 - 2**-23) * 2.0**127
LARGEST_FLOAT64 = float_info.max


def read_constant(node: Node, type_: Type, problems: list[Diagnostic]) -> Expr | None:
    """The constant that a node is for a field of this type."""
    match type_, node:
        case Int(spelling="vocab32" | "vocab64"), Vocab(text, span):
            return _vocab_constant(text, 4 if type_.bits == 32 else 8, span, problems)
        case Int(bits), Number(int(value), span) if -(2 ** (bits - 1)) <= value < 2 ** (bits - 1):
            return Literal(value, span)
        case Int(), Word() | Form():
            return read_expr(node, problems)
        case Float(bits), Number(value, span) if abs(value) <= (LARGEST_FLOAT32 if bits == 32 else LARGEST_FLOAT64):
            return Literal(float(value), span)
        case Bool(), Word("true" | "false" as word, span):
            return Literal(word == "true", span)
        case String(), Text(value, span):
            return Literal(value, span)
        case _:
            problems.append(catalogue.wrong_constant(node.span, _expected(type_)))
            return None


def read_expr(node: Node, problems: list[Diagnostic]) -> Expr | None:
    """An integer computed from fields. Its depth is that of the node, which the reader of forms has bounded."""
    match node:
        case Number(int(value), span):
            return Literal(value, span)
        case Word(path, span) if all(name.isidentifier() for name in path.split(".")):
            return Path("wire", tuple(Member(name) for name in path.split(".")), span)
        case Form((Word("length"), Word(path, span))) if all(name.isidentifier() for name in path.split(".")):
            return Len(Path("wire", tuple(Member(name) for name in path.split(".")), span), span)
        case Form((Word(operator), left, right), span) if operator in OPERATORS:
            operands = read_expr(left, problems), read_expr(right, problems)
            return _combine(operator, operands, span)
        case Form((Word(operator, span), _, _)):
            problems.append(catalogue.unknown_operator(span, operator, OPERATORS))
        case _:
            problems.append(catalogue.malformed_expression(node.span))
    return None


def _combine(operator: str, operands: tuple[Expr | None, Expr | None], span: Span) -> Expr | None:
    match operator, operands:
        case _, (None, _) | (_, None):
            return None
        case ("+" | "-" | "*" | "/") as arithmetic, (left, right):
            return Binary(arithmetic, left, right, span)
        case function, (left, right):
            return Call(function, (left, right), span)


def _vocab_constant(text: str, size: OneOf[4, 8], span: Span, problems: list[Diagnostic]) -> Expr | None:
    octets = text.encode("utf-8", "surrogatepass")
    if len(octets) > size:
        problems.append(catalogue.vocab_too_long(span, text, size))
        return None
    return Literal(vocab(octets, size), span)


def _expected(type_: Type) -> str:
    match type_:
        case Int(bits, spelling="vocab32" | "vocab64"):
            return f"a vocab of up to {bits // 8} bytes, :|set|,"
        case Int(bits):
            return f"an integer of {bits} bits"
        case Float():
            return "a number"
        case Bool():
            return "true or false"
        case String():
            return "a text"
        case _:
            return "no constant"
