"""Turn an expression round: what a field must be for the expression to have a value.

| expression        | its field                         |
|-------------------|-----------------------------------|
| `.a`              | the value                         |
| `x + c`, `c + x`  | value - c                         |
| `x - c`           | value + c                         |
| `c - x`           | c - value                         |
| `x * c`, `c * x`  | divide(value, c)                  |
| `x / c`           | value * c, of floats              |
| `x ^ c`           | value ^ c                         |
| `-x`, `not x`     | -value, not value                 |
| `radians(x)`      | degrees(value), and the reverse   |
| `float32(x)` …    | the value, as the field holds it  |
| `table(x) {a = b}`| table(value) {b = a}              |

Those of texts stand in `rosetta_jit.lowering.inverse_texts`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.dataclass import dataclass
from rosetta_jit.lowering.inverse_texts import opposite, without
from rosetta_jit.model.expr import Binary, Call, Choice, Index, Len, Literal, Name, Path, Unary

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.model.expr import Expr
    from rosetta_jit.source import Span

CONVERSIONS = ("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "float32", "float64", "bool")
OPPOSITE = {"radians": "degrees", "degrees": "radians"}


@dataclass(frozen=True, slots=True)
class Solution:
    """``place = value``"""

    place: Path | Len
    value: Expr


class NoInverseError(Exception):
    """An expression that cannot be turned round; says which part and why."""

    def __init__(self, part: Expr, why: str) -> None:
        super().__init__(why)
        self.part, self.why = part, why


def solve(expr: Expr, value: Expr) -> Solution:
    """The field of an expression that has exactly one, so that the expression is ``value``.

    Raises
    ------
    NoInverseError
    """
    while not isinstance(expr, Path | Len):
        expr, value = _step(expr, value)
    return Solution(expr, value)


def fields_in(expr: Expr) -> list[Path | Len]:
    """The fields that an expression reads; those within an index are not among them."""
    return list(dict.fromkeys(_fields(expr)))


def _fields(expr: Expr) -> Iterator[Path | Len]:
    match expr:
        case Path() | Len():
            yield expr
        case Unary(_, operand):
            yield from _fields(operand)
        case Binary(_, left, right):
            yield from _fields(left)
            yield from _fields(right)
        case Call(_, arguments):
            for argument in arguments:
                yield from _fields(argument)
        case Choice(cases, otherwise):
            for condition, value in cases:
                yield from _fields(condition)
                yield from _fields(value)
            if otherwise is not None:
                yield from _fields(otherwise)
        case _:
            return


def calls_in(expr: Expr) -> Iterator[Call]:
    """The calls in an expression; those within an index are not among them."""
    match expr:
        case Unary(_, operand):
            yield from calls_in(operand)
        case Binary(_, left, right):
            yield from calls_in(left)
            yield from calls_in(right)
        case Call(_, arguments):
            yield expr
            for argument in arguments:
                yield from calls_in(argument)
        case Choice(cases, otherwise):
            for part in (*(part for case in cases for part in case), *([] if otherwise is None else [otherwise])):
                yield from calls_in(part)
        case _:
            return


def _step(expr: Expr, value: Expr) -> tuple[Expr, Expr]:
    """One operation taken from the expression, and its opposite done to the value."""
    match expr:
        case Unary(operator, operand, span):
            return operand, Unary(operator, value, span)
        case Binary():
            return _operation(expr, value)
        case Call(function, (argument, *_), span) if function in OPPOSITE:
            return argument, Call(OPPOSITE[function], (value,), span)
        case Call(function, (argument, *_)) if function in CONVERSIONS or "." in function:
            return argument, value
        case Call() if (found := opposite(expr, value)) is not None:
            return found
        case Call(function):
            raise NoInverseError(expr, f"`{function}` gives the same for several values")
        case Choice():
            return _table(expr, value)
        case _:
            raise NoInverseError(expr, "it has no field")


def _operation(expr: Binary, value: Expr) -> tuple[Expr, Expr]:
    if (found := without(expr, value)) is not None:
        return found
    left = bool(fields_in(expr.left))
    inner, other = (expr.left, expr.right) if left else (expr.right, expr.left)
    if fields_in(other):
        raise NoInverseError(expr, "the field stands in it twice")
    span = expr.span
    match expr.operator, left:
        case "+", _:
            return inner, Binary("-", value, other, span)
        case "-", True:
            return inner, Binary("+", value, other, span)
        case "-", False:
            return inner, Binary("-", other, value, span)
        case "*", _:
            return inner, Call("divide", (value, other), span)
        case "/", True:
            return inner, Binary("*", value, other, span)
        case "^", _:
            return inner, Binary("^", value, other, span)
        case operator, _:
            raise NoInverseError(expr, f"`{operator}` gives the same for several values")


def _table(expr: Choice, value: Expr) -> tuple[Expr, Expr]:
    """A table with its columns exchanged. Of several keys with one value the first is written."""
    if expr.otherwise is not None:
        raise NoInverseError(expr.otherwise, "it is the value of several keys")
    cases: list[tuple[Expr, Expr]] = []
    subject: Expr | None = None
    for condition, chosen in expr.cases:
        match condition, chosen:
            case Binary("==", found, (Literal() | Name()) as key), Literal() | Name() | Unary("-", Literal()):
                subject = found
                cases.append((Binary("==", value, chosen, condition.span), key))
            case _:
                raise NoInverseError(expr, "only a table of constants can be turned round")
    if subject is None:
        raise NoInverseError(expr, "the table is empty")
    return subject, Choice(tuple(cases), None, expr.reason or "the table has no key for it", expr.span)


def replaced(expr: Expr, known: dict[Path | Len, Expr]) -> Expr:
    """An expression with other expressions in place of some fields."""
    match expr:
        case Path() | Len():
            return known.get(expr, expr)
        case Unary(operator, operand, span):
            return Unary(operator, replaced(operand, known), span)
        case Binary(operator, left, right, span):
            return Binary(operator, replaced(left, known), replaced(right, known), span)
        case Call(function, arguments, span):
            return Call(function, tuple(replaced(argument, known) for argument in arguments), span)
        case Choice(cases, otherwise, reason, span, pieces):
            pairs = tuple((replaced(condition, known), replaced(value, known)) for condition, value in cases)
            shown = tuple(replaced(piece, known) for piece in pieces)
            return Choice(pairs, None if otherwise is None else replaced(otherwise, known), reason, span, shown)
        case _:
            return expr


def reads_in_index(path: Path) -> Span | None:
    """Where an index of a place reads a field."""
    for step in path.steps:
        if isinstance(step, Index) and fields_in(step.index):
            return step.span
    return None
