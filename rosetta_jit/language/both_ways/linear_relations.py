"""As many relations as there are fields that nothing else knows, each of which adds multiples of these, solved together.

    .speed <-> (.right + .left) * 0.5           `.right` is `.speed + .turn * 0.2`
    .turn  <-> (.right - .left) / 0.4           `.left` is `.speed - .turn * 0.2`

What is done to a whole sum is undone first; then fields are eliminated (Gauss and Jordan). Factors are fractions, and expressions where
they are parameters or what the holder says. Sums of integers are solved without rounding: packing refuses what leaves a remainder. An
integer of which floats were computed is the nearest one, and packing checks the relations with it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import isfinite, lcm
from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.inverse import NoInverseError, Solution, fields_in, nearest, step
from rosetta_jit.language.folding import folded
from rosetta_jit.language.limits import MAX_TOGETHER
from rosetta_jit.model.expr import Binary, Call, Expr, Len, Literal, Operator, Path, Unary
from rosetta_jit.model.types import Float, Int
from rosetta_jit.model.walk import Field
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf
    from rosetta_jit.language.both_ways.knowledge import Loops

    Factor = Fraction | Expr
    """What a field is multiplied by: a constant, or an expression that packing has."""

ZERO, ONE = Fraction(0), Fraction(1)


@dataclass(frozen=True, slots=True)
class Sum:
    """The ``value`` of an expression of several fields, as multiples of these."""

    factors: tuple[Factor, ...]
    value: Expr


@dataclass(frozen=True, slots=True)
class Solved:
    """What the fields are, and whether the relations must be asked whether they hold: of integers that were made of floats."""

    solutions: tuple[Solution, ...]
    is_checked: bool


def related(unknown: Sequence[frozenset[tuple[Loops, Field]]]) -> list[list[int]]:
    """The numbers of relations, given the fields that each leaves unknown, which have fields in common, directly or by others."""
    groups: list[tuple[set[tuple[Loops, Field]], list[int]]] = []
    for number, fields in enumerate(unknown):
        mine = [group for group in groups if not group[0].isdisjoint(fields)]
        groups = [group for group in groups if group not in mine]
        groups.append((set(fields).union(*(group[0] for group in mine)), sorted([number, *(each for group in mine for each in group[1])])))
    return [numbers for fields, numbers in groups if 1 < len(fields) == len(numbers) <= MAX_TOGETHER]


def solve_together(expressions: Sequence[tuple[Expr, Expr]], fields: Sequence[Field], type_of: TypeOf) -> Solved:
    """The fields, so that each expression has the value beside it; raises NoInverseError."""
    types = [type_of(field) for field in fields]
    if not all(isinstance(each, Int | Float) for each in types):
        raise NoInverseError(expressions[0][0], "its fields are no numbers")
    sums = [_sum(*each, fields, type_of) for each in expressions]
    are_integers = all(isinstance(type_of(part), Int) for each in expressions for part in each)
    if are_integers and not all(isinstance(each, Int) for each in types):
        raise NoInverseError(expressions[0][0], "its fields are no integers")
    inverse = _inverse([[*each.factors] for each in sums], expressions[0][0])
    values = [each.value for each in sums]
    made = _whole if are_integers else _total
    span = expressions[0][0].span
    solutions = (Solution(field, made(row, values, span)) for field, row in zip(fields, inverse, strict=True))
    if are_integers:
        return Solved(tuple(solutions), is_checked=False)
    return Solved(tuple(nearest(each, type_of) for each in solutions), is_checked=any(isinstance(each, Int) for each in types))


# --- sums -----------------------------------------------------------------------------------------------------------------


def _sum(expr: Expr, value: Expr, fields: Sequence[Field], type_of: TypeOf) -> Sum:
    """An expression as a sum, what is done to all of it undone."""
    while not _is_sum(expr):
        if _drops_remainder(expr, type_of):
            raise NoInverseError(expr, "a division of integers drops what remains")
        expr, value = step(expr, value, type_of)
    factors, rest = _terms(expr, fields, type_of)
    return Sum(tuple(factors), value if rest is None else Binary("-", value, rest, expr.span))


def _is_sum(expr: Expr) -> bool:
    """Whether fields stand on both sides of a `+` or `-`, or the expression is one of them."""
    match expr:
        case Path() | Len():
            return True
        case Binary("+" | "-", left, right):
            return bool(fields_in(left)) and bool(fields_in(right))
        case _:
            return False


def _drops_remainder(expr: Expr, type_of: TypeOf) -> bool:
    return isinstance(expr, Binary) and expr.operator == "/" and isinstance(type_of(expr), Int)


def _terms(expr: Expr, fields: Sequence[Field], type_of: TypeOf) -> tuple[list[Factor], Expr | None]:
    """The factor of each field, and what is added that has none."""
    if not fields_in(expr):
        return [ZERO] * len(fields), expr
    match expr:
        case Path() | Len() if expr in fields:
            return [ONE if expr == each else ZERO for each in fields], None
        case Binary("+" | "-" as operator, left, right, span):
            return _joined(operator, _terms(left, fields, type_of), _terms(right, fields, type_of), span)
        case Unary("-", operand, span):
            return _joined("-", ([ZERO] * len(fields), None), _terms(operand, fields, type_of), span)
        case Call("float32" | "float64", (operand,)):
            return _terms(operand, fields, type_of)
        case Binary("*", left, right, span):
            inner, factor = (right, left) if fields_in(right) else (left, right)
            if not fields_in(factor):
                factors, rest = _terms(inner, fields, type_of)
                return [_product(each, _number(factor), span) for each in factors], rest and Binary("*", rest, factor, span)
        case Binary("/", inner, divisor, span) if not fields_in(divisor) and not _drops_remainder(expr, type_of):
            factors, rest = _terms(inner, fields, type_of)
            return [_quotient(each, _number(divisor), span) for each in factors], rest and Binary("/", rest, divisor, span)
        case _:
            pass
    raise NoInverseError(expr, "it is no multiple of a field")


def _joined(
    operator: Operator, left: tuple[list[Factor], Expr | None], right: tuple[list[Factor], Expr | None], span: Span | None
) -> tuple[list[Factor], Expr | None]:
    add = _added if operator == "+" else _less
    factors = [add(one, other, span) for one, other in zip(left[0], right[0], strict=True)]
    if left[1] is None or right[1] is None:
        return factors, left[1] or (right[1] and (right[1] if operator == "+" else Unary("-", right[1], span)))
    return factors, Binary(operator, left[1], right[1], span)


# --- factors --------------------------------------------------------------------------------------------------------------


def _number(expr: Expr) -> Factor:
    known = folded(expr)
    if isinstance(known, Literal) and type(known.value) in (int, float) and isfinite(float(known.value)):
        return Fraction(known.value)
    return expr


def _literal(factor: Factor, span: Span | None) -> Expr:
    if isinstance(factor, Fraction):
        return Literal(factor.numerator if factor.denominator == 1 else float(factor), span)
    return factor


def _made(operator: Operator, left: Factor, right: Factor, span: Span | None) -> Expr:
    return Binary(operator, _literal(left, span), _literal(right, span), span)


def _added(left: Factor, right: Factor, span: Span | None) -> Factor:
    if isinstance(left, Fraction) and isinstance(right, Fraction):
        return left + right
    return right if left == ZERO else left if right == ZERO else _made("+", left, right, span)


def _less(left: Factor, right: Factor, span: Span | None) -> Factor:
    match left, right:
        case _, Unary("-", operand):
            return _added(left, operand, span)
        case _, Fraction():
            return _added(left, -right, span)
        case Fraction(), _ if left == ZERO:
            return Unary("-", right, span)
        case _:
            return _made("-", left, right, span)


def _product(left: Factor, right: Factor, span: Span | None) -> Factor:
    if isinstance(left, Fraction) and isinstance(right, Fraction):
        return left * right
    for one, other in ((left, right), (right, left)):
        if one in (ZERO, ONE):
            return ZERO if one == ZERO else other
        if one == -ONE:
            return _less(ZERO, other, span)
    return _made("*", left, right, span)


def _quotient(left: Factor, right: Factor, span: Span | None) -> Factor:
    if isinstance(right, Fraction):
        if not right:
            raise NoInverseError(_literal(left, span), "it is divided by 0")
        return _product(left, 1 / right, span)
    return ZERO if left == ZERO else _made("/", left, right, span)


def _inverse(rows: list[list[Factor]], where: Expr) -> list[list[Factor]]:
    """The inverse of a matrix: by Gauss and Jordan, with constants as pivots where there are any."""
    size = len(rows)
    rows = [[*row, *(ONE if each == number else ZERO for each in range(size))] for number, row in enumerate(rows)]
    for column in range(size):
        rest = [number for number in range(column, size) if rows[number][column] != ZERO]
        if not rest:
            raise NoInverseError(where, "the relations of its fields do not tell them apart")
        pivot = min(rest, key=lambda number: not isinstance(rows[number][column], Fraction))
        rows[column], rows[pivot] = rows[pivot], rows[column]
        divisor = rows[column][column]
        rows[column] = [_quotient(each, divisor, where.span) if number != column else ONE for number, each in enumerate(rows[column])]
        for other in range(size):
            if other != column and (factor := rows[other][column]) != ZERO:
                pairs = zip(rows[other], rows[column], strict=True)
                rows[other] = [_less(one, _product(factor, each, where.span), where.span) for one, each in pairs]
                rows[other][column] = ZERO
    return [row[size:] for row in rows]


# --- solutions ------------------------------------------------------------------------------------------------------------


def _total(row: Iterable[Factor], values: Sequence[Expr], span: Span | None) -> Expr:
    """Values times their factors, added; those that are subtracted come last."""
    terms = [(factor, value) for factor, value in zip(row, values, strict=True) if factor != ZERO]
    total: Expr | None = None
    for factor, value in sorted(terms, key=lambda term: isinstance(term[0], Fraction) and term[0] < 0):
        is_less = total is not None and isinstance(factor, Fraction) and factor < 0
        size = _product(value, -factor if is_less and isinstance(factor, Fraction) else factor, span)
        assert not isinstance(size, Fraction)
        total = size if total is None else Binary("-" if is_less else "+", total, size, span)
    assert total is not None
    return total


def _whole(row: Sequence[Factor], values: Sequence[Expr], span: Span | None) -> Expr:
    """The same of integers: added with whole factors, and divided without a remainder."""
    factors = [each for each in row if isinstance(each, Fraction)]
    if len(factors) < len(row):
        raise NoInverseError(values[0], "integers are multiplied by what is not known when the mapping is compiled")
    by = lcm(*(each.denominator for each in factors))
    total = _total([each * by for each in factors], values, span)
    return total if by == 1 else Call("divide", (total, Literal(by, span)), span)
