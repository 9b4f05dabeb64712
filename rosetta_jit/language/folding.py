"""What is known of an expression before it has types: arithmetic, comparisons and logic of constants that the text writes down.

Floats are left alone, as what a place holds of one may be another.
"""

from __future__ import annotations

from rosetta_jit.model.expr import Binary, Choice, Coerced, Expr, Literal, Name, Nearest, Unary
from rosetta_jit.model.walk import rebuilt
from rosetta_jit.startup.dataclass import replace

TRUE, FALSE = Literal(value=True), Literal(value=False)


def folded(expr: Expr) -> Expr:
    """The expression with what is known in place of what computes it."""
    expr = rebuilt(expr, folded)
    match expr:
        case Unary("not", Literal(bool(value))):
            return Literal(not value, expr.span)
        case Unary("-", Literal(int() | float() as value) as number) if not isinstance(value, bool):
            return replace(number, value=-value, span=expr.span)
        case Nearest(Literal(int()) as known):
            return known
        case Binary("and" | "or" as operator, left, right):
            return _logic(operator == "and", left, right, expr)
        case Binary("+" | "-" | "*" | "<" | "<=" | ">" | ">=", Literal(int() as a), Literal(int() as b)):
            return _computed(expr, a, b)
        case Binary("==" | "!=" | "differs", left, right):
            return _compared(expr, _bare(left), _bare(right))
        case _:
            return expr


def is_constant(expr: Expr) -> bool:
    """Whether an expression is a number, a text, a bool or a name of one."""
    return isinstance(folded(expr), Literal | Name)


def _computed(expr: Binary, a: int, b: int) -> Expr:
    """Integers; what does not fit int64 is left for those who report it."""
    match expr.operator:
        case "+" | "-" | "*":
            value = a + b if expr.operator == "+" else a - b if expr.operator == "-" else a * b
            return Literal(value, expr.span) if abs(value) < 1 << 63 else expr
        case "<" | "<=":
            return Literal(a < b or (a == b and expr.operator == "<="), expr.span)
        case _:
            return Literal(a > b or (a == b and expr.operator == ">="), expr.span)


def _logic(is_and: bool, left: Expr, right: Expr, expr: Expr) -> Expr:
    decides = FALSE if is_and else TRUE
    if decides in (left, right):
        return decides
    neutral = TRUE if is_and else FALSE
    return right if left == neutral else left if right == neutral else expr


def _bare(expr: Expr) -> Expr:
    """What a place holds of a constant that it holds as it is."""
    match expr:
        case Coerced(value=(Literal(bool() | int() | str()) | Name() | Choice()) as value):
            return value
        case _:
            return expr


def _compared(expr: Binary, left: Expr, right: Expr) -> Expr:
    match left, right:
        case Literal(bool() | int() | str() as a), Literal(bool() | int() | str() as b) if type(a) is type(b):
            return Literal((a == b) == (expr.operator == "=="), expr.span)
        case Name(a), Name(b) if a == b:
            return Literal(expr.operator == "==", expr.span)
        case Choice(), Literal(str()):
            return _chosen(expr, left, right)
        case Literal(str()), Choice():
            return _chosen(expr, right, left)
        case _:
            return expr


def _chosen(expr: Binary, choice: Choice, text: Expr) -> Expr:
    """A text that is one of several, compared with another: which of the several is it?"""
    values = [value for _, value in choice.cases] + ([] if choice.otherwise is None else [choice.otherwise])
    if not all(isinstance(value, Literal) for value in values):
        return expr
    cases = tuple((condition, folded(replace(expr, left=value, right=text))) for condition, value in choice.cases)
    otherwise = None if choice.otherwise is None else folded(replace(expr, left=choice.otherwise, right=text))
    return replace(choice, cases=cases, otherwise=otherwise)
