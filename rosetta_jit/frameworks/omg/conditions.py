"""The conditions of `#if` and `#elif`: integers as C's preprocessor computes them (C 6.10.1)."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator
from typing import assert_never

from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg.cursor import Cursor, SyntaxProblem
from rosetta_jit.frameworks.omg.expressions import CONDITIONS, Binary, Expr, Literal, Operators, ScopedName, Unary, computed, expression
from rosetta_jit.frameworks.omg.lexer import LiteralError, Token, number


def holds(tokens: list[Token], end: Token) -> bool:
    """Whether a condition is true. Macros are expanded in it already; words that are left are 0.

    Raises
    ------
    SyntaxProblem
        It is no condition.
    """
    cursor = Cursor([*tokens, end])
    tree = expression(cursor, Operators(("!", "-", "+", "~"), CONDITIONS, _operand))
    if cursor.token.kind != "end":
        cursor.fail("an operator")
    return _value(tree) != 0


def answer_defined(line: Iterable[Token], macros: Container[str]) -> Iterator[Token]:
    """The tokens of a condition with 0 or 1 in place of each `defined X` and `defined(X)`, before macros are expanded."""
    rest = iter(line)
    for token in rest:
        if token.kind != "word" or token.text != "defined":
            yield token
            continue
        name = next(rest, None)
        closed = name is not None and name.text == "("
        if closed:
            name = next(rest, None)
        if name is None or name.kind != "word" or (closed and getattr(next(rest, None), "text", "") != ")"):
            raise SyntaxProblem(say.unexpected(token.span, "defined", "`defined(NAME)`"))
        yield Token("number", str(int(name.text in macros)), name.span)


def _operand(cursor: Cursor) -> Expr:
    token = cursor.token
    if token.kind == "word":
        cursor.take()
        return ScopedName((token.text,), absolute=False, span=token.span)
    if token.kind != "number":
        cursor.fail("a number or a name")
    cursor.take()
    return Literal((token,), token.span)


def _value(node: Expr) -> int:
    match node:
        case Literal(tokens, span):
            try:
                value = number(tokens[0].text.rstrip("uUlL"))
            except LiteralError as error:
                raise SyntaxProblem(say.wrong_literal(span, str(error))) from error
            if not isinstance(value, int):
                raise SyntaxProblem(say.wrong_literal(span, "no integer"))
            return _wrapped(value)
        case ScopedName():
            return 0
        case Unary(operator, operand):
            value = _value(operand)
            return {"!": int(not value), "-": _wrapped(-value), "+": value, "~": ~value}[operator]
        case Binary("||" | "&&" as operator, left, right):
            decided = (_value(left) != 0) == (operator == "||")
            return int(operator == "||") if decided else int(_value(right) != 0)
        case Binary():
            return _wrapped(computed(node, _value(node.left), _value(node.right), SyntaxProblem))
        case _:
            assert_never(node)


def _wrapped(value: int) -> int:
    """Conditions are computed in 64 bits."""
    return (value + (1 << 63)) % (1 << 64) - (1 << 63)
