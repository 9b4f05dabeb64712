"""Expressions of fields as plain data and back, as `model.serial` does it for types.

Expr = ["literal", value] | ["path", side, [Step, ...]] | ["len", Expr] | ["binary", operator, Expr, Expr] | …
Step = name | Expr
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, assert_never

from rosetta_jit.model import expr

if TYPE_CHECKING:
    from collections.abc import Iterable


def plain_expression(value: expr.Expr | None) -> list[Any] | None:
    """An expression as plain data."""
    match value:
        case None:
            return None
        case expr.Literal(literal):
            return ["literal", literal]
        case expr.Name(name):
            return ["name", name]
        case expr.Path(side, steps):
            return ["path", side, [_plain_step(step) for step in steps]]
        case expr.Len(path):
            return ["len", plain_expression(path)]
        case expr.Unary(operator, operand):
            return ["unary", operator, plain_expression(operand)]
        case expr.Binary(operator, left, right):
            return ["binary", operator, plain_expression(left), plain_expression(right)]
        case expr.Call(function, arguments):
            return ["call", function, [plain_expression(each) for each in arguments]]
        case expr.Choice(cases, otherwise, reason):
            return ["choice", [[plain_expression(part) for part in case] for case in cases], plain_expression(otherwise), reason]
        case expr.List() | expr.Item() | expr.Given() | expr.Coerced() | expr.Nearest():
            raise AssertionError(value)
        case _:
            assert_never(value)


def _plain_step(step: expr.Step) -> str | list[Any] | None:
    match step:
        case expr.Member(name):
            return name
        case expr.Index(index):
            return plain_expression(index)
        case _:
            raise AssertionError(step)  # mappings alone name many elements at once


def expression_of(plain: Any, depth: int, most: int) -> Any:
    """The expression that plain data stands for, which stands so deep in a type; ValueError if there is none, or below ``most``."""
    if depth > most:
        raise ValueError(f"expressions nest more than {most} deep")
    match plain:
        case None:
            return None
        case ["literal", value]:
            return expr.Literal(value)
        case ["name", name]:
            return expr.Name(name)
        case ["path", side, steps]:
            found = tuple(
                expr.Member(each) if isinstance(each, str) else expr.Index(expression_of(each, depth + 1, most)) for each in steps
            )
            return expr.Path(side, found)
        case ["len", path]:
            return expr.Len(expression_of(path, depth + 1, most))
        case ["unary", operator, operand]:
            return expr.Unary(operator, expression_of(operand, depth + 1, most))
        case ["binary", operator, left, right]:
            return expr.Binary(operator, expression_of(left, depth + 1, most), expression_of(right, depth + 1, most))
        case ["call", function, arguments]:
            return expr.Call(function, tuple(expression_of(each, depth + 1, most) for each in arguments))
        case ["choice", cases, otherwise, reason]:
            pairs = tuple((expression_of(condition, depth + 1, most), expression_of(value, depth + 1, most)) for condition, value in cases)
            return expr.Choice(pairs, None if otherwise is None else expression_of(otherwise, depth + 1, most), reason)
        case _:
            raise ValueError(f"not an expression: {plain!r:.80}")


def names_on(length: object) -> list[str] | None:
    """The names on the path of the field that tells a length."""
    return [step.name for step in length.steps if isinstance(step, expr.Member)] if isinstance(length, expr.Path) else None


def path_of(names: Iterable[str]) -> expr.Path:
    """The path of a field that tells a length."""
    return expr.Path("wire", tuple(expr.Member(name) for name in names))
