"""Constant expressions: operators by precedence, over whatever the caller takes for an operand.

    Expr = Literal(token) | Name(scoped name) | Unary(operator, Expr) | Binary(operator, Expr, Expr)

The declarations of IDL and the conditions of its preprocessor share them (OMG IDL 4.2, 7.4.1.4.3; C 6.10.1).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg.cursor import Cursor, SyntaxProblem
from rosetta_jit.frameworks.omg.limits import MAX_OPERATORS
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.frameworks.omg.lexer import Token
    from rosetta_jit.source import Span

ARITHMETIC: Mapping[str, int] = {"|": 3, "^": 4, "&": 5, "<<": 8, ">>": 8, "+": 9, "-": 9, "*": 10, "/": 10, "%": 10}
CONDITIONS: Mapping[str, int] = {**ARITHMETIC, "||": 1, "&&": 2, "==": 6, "!=": 6, "<": 7, ">": 7, "<=": 7, ">=": 7}
"""Operators of two operands and how strongly they bind."""


@dataclass(frozen=True, slots=True)
class Literal:
    """A literal as it was written; adjacent strings are several tokens."""

    tokens: tuple[Token, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class ScopedName:
    """A name as it was written: its parts, and whether `::` stands before them."""

    parts: tuple[str, ...]
    absolute: bool
    span: Span

    def __str__(self) -> str:
        return ("::" if self.absolute else "") + "::".join(self.parts)


@dataclass(frozen=True, slots=True)
class Unary:
    """An operator before its operand."""

    operator: str
    operand: Expr
    span: Span
    depth: int


@dataclass(frozen=True, slots=True)
class Binary:
    """An operator between its operands."""

    operator: str
    left: Expr
    right: Expr
    span: Span
    depth: int


Expr = Literal | ScopedName | Unary | Binary


@dataclass(frozen=True, slots=True)
class Operators:
    """A language of expressions: operators before and between operands, and how an operand is read.

    ``in_angles`` holds within angle brackets, two of which `>>` closes; parentheses in them make it an operator again.
    """

    unary: tuple[str, ...]
    binary: Mapping[str, int]
    operand: Callable[[Cursor], Expr]
    in_angles: bool = False


def expression(cursor: Cursor, language: Operators, weakest: int = 0, depth: int = 0) -> Expr:
    """An expression whose operators bind more strongly than ``weakest``."""
    first = cursor.token
    left = _unary(cursor, language, depth + 1)
    while True:
        operator = _operator(cursor, language)
        strength = language.binary.get(operator, 0)
        if strength <= weakest:
            return left
        for _ in range(1 + (operator == ">>")):
            cursor.take()
        right = expression(cursor, language, strength, depth + 1)
        below = max(_depth(left), _depth(right)) + 1
        if below > MAX_OPERATORS:
            raise SyntaxProblem(say.nesting(first.span, MAX_OPERATORS, "operators"))
        left = Binary(operator, left, right, cursor.since(first), below)


def _operator(cursor: Cursor, language: Operators) -> str:
    token = cursor.token
    if token.kind != "symbol":
        return ""
    double = token.text == ">" == cursor.following.text and token.span.end == cursor.following.span.start
    return ">>" if double and not language.in_angles else token.text


def _unary(cursor: Cursor, language: Operators, depth: int) -> Expr:
    first = cursor.token
    if depth > MAX_OPERATORS:
        raise SyntaxProblem(say.nesting(first.span, MAX_OPERATORS, "operators"))
    if cursor.sees(*language.unary):
        cursor.take()
        operand = _unary(cursor, language, depth + 1)
        return Unary(first.text, operand, cursor.since(first), _depth(operand) + 1)
    if cursor.accept("("):
        inner = expression(cursor, replace(language, in_angles=False), 0, depth + 1)
        cursor.expect(")")
        return inner
    return language.operand(cursor)


def _depth(node: Expr) -> int:
    return node.depth if isinstance(node, Unary | Binary) else 0


def computed(node: Binary, left: int, right: int, problem: Callable[[Diagnostic], Exception]) -> int:
    """The value of an operator between integers, which no type bounds here; quotients are cut towards zero, and comparisons give 0 or 1.

    Raises
    ------
    Exception
        That which ``problem`` makes, where there is no value.
    """
    match node.operator:
        case "/" | "%" if right == 0:
            raise problem(say.division_by_zero(node.right.span))
        case "/":
            return abs(left) // abs(right) * (1 if (left < 0) == (right < 0) else -1)
        case "%":
            return abs(left) % abs(right) * (-1 if left < 0 else 1)
        case "<<" | ">>" if not 0 <= right < 64:
            raise problem(say.shift(node.right.span))
        case _:
            return int(_SIMPLE[node.operator](left, right))


_SIMPLE: dict[str, Callable[[int, int], int]] = {
    "|": int.__or__,
    "^": int.__xor__,
    "&": int.__and__,
    "==": int.__eq__,
    "!=": int.__ne__,
    "<": int.__lt__,
    ">": int.__gt__,
    "<=": int.__le__,
    ">=": int.__ge__,
    "<<": int.__lshift__,
    ">>": int.__rshift__,
    "+": int.__add__,
    "-": int.__sub__,
    "*": int.__mul__,
}
