"""Numbers of elements as expressions of the mapping: sums, products and quotients, folded where they are known."""

from __future__ import annotations

from rosetta_jit.catalogue import layouts as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.limits import MAX_KNOWN_COUNT
from rosetta_jit.model.expr import Binary, Call, Expr, Literal, Operator

ZERO, ONE = Literal(0), Literal(1)


class LayoutError(Exception):
    """What cannot be read as an array in some order; never leaves `elementwise`."""

    def __init__(self, problem: Diagnostic) -> None:
        super().__init__()
        self.problem = problem


def plus(left: Expr, right: Expr) -> Expr:
    """``left + right``"""
    if isinstance(left, Literal):
        left, right = right, left
    return right if left == ZERO else left if right == ZERO else folded(Binary("+", left, right, left.span or right.span))


def minus(left: Expr, right: Expr) -> Expr:
    """``left - right``"""
    return left if right == ZERO else folded(Binary("-", left, right, left.span or right.span))


def times(left: Expr, right: Expr) -> Expr:
    """``left * right``"""
    return right if left == ONE else left if right == ONE else folded(Binary("*", left, right, left.span or right.span))


def over(total: Expr, size: Expr, call: Call) -> Expr:
    """``total / size``, where nothing remains; the factor itself where the total is a product of it."""
    if size == ONE:
        return total
    match total, size:
        case Literal(int(value)), Literal(int(divisor)) if value % divisor:
            raise LayoutError(words.no_divisor(call.span, value, divisor))
        case Literal(int(value)), Literal(int(divisor)):
            return Literal(value // divisor, total.span)
        case Binary("*", left, right), _ if right == size:
            return left
        case Binary("*", left, right), _ if left == size:
            return right
        case Binary("*", left, Literal(int(factor))), Literal(int(divisor)) if factor % divisor == 0:
            return times(left, Literal(factor // divisor))
        case _:
            return Call("divide", (total, size), call.span)


def folded(expr: Expr) -> Expr:
    """An operation on numbers that are known as its result."""
    match expr:
        case Binary(operator, Literal(int(left)), Literal(int(right))) if abs(known := _result(operator, left, right)) < MAX_KNOWN_COUNT:
            return Literal(known, expr.span)
        case _:
            return expr


def _result(operator: Operator, left: int, right: int) -> int:
    match operator:
        case "+":
            return left + right
        case "-":
            return left - right
        case "*":
            return left * right
        case _:
            return left // right
