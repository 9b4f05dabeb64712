"""The operators of numbers, one record each: what undoes it, and what comes back when it is undone.

| operator         | x, where the value is known | comes back        |
|------------------|-----------------------------|-------------------|
| `x + c`, `c + x` | value - c                   | rounded, if float |
| `x - c`          | value + c                   | rounded, if float |
| `c - x`          | c - value                   | rounded, if float |
| `x * c`, `c * x` | divide(value, c)            | rounded, if float |
| `x / c`          | value * c                   | rounded, if float; an integer without its remainder |
| `x ^ c`, `c ^ x` | value ^ c                   | exactly           |

All others give the same for several values. Functions have such records, too: `rosetta_jit.language.function`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.language.affine_steps import LostError, Value, divided_by, fraction, rounded, scaled, shifted
from rosetta_jit.language.function import SEVERAL
from rosetta_jit.model.expr import Binary, Call, Expr
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    Undo = Callable[[Expr, Expr, Span | None], Expr]
    """What an operand must be, of the value and the other operand."""

    Follow = Callable[[Value, object], Value]
    """What a constant as the other operand makes of a value."""


@dataclass(frozen=True, slots=True)
class Form:
    """An operator with the unknown operand at one side.

    ``follow`` is None where only the same operation undoes it. ``exact`` says that each value comes from one operand alone, or the operator
    refuses it, if it is of integers.
    """

    undo: Undo
    follow: Follow | None
    exact: bool = False


def form_of(operator: str, *, is_left: bool) -> Form | None:
    """The record of an operator whose left operand is unknown, or the right one; None where it gives the same for several values."""
    return FORMS.get((operator, is_left))


def rounds(operator: str) -> bool:
    """Whether an operator rounds, if it is one of floats."""
    return any(form.follow is not None for (each, _), form in FORMS.items() if each == operator)


def why_lost(operator: str) -> str:
    """Why nothing comes back of what an operator without a record computes."""
    return f"`{operator}` {SEVERAL}"


# --- what undoes an operator ---------------------------------------------------------------------------------------------


def _minus(value: Expr, other: Expr, span: Span | None) -> Expr:
    return Binary("-", value, other, span)


def _plus(value: Expr, other: Expr, span: Span | None) -> Expr:
    return Binary("+", value, other, span)


def _from(value: Expr, other: Expr, span: Span | None) -> Expr:
    return Binary("-", other, value, span)


def _divided(value: Expr, other: Expr, span: Span | None) -> Expr:
    return Call("divide", (value, other), span)


def _times(value: Expr, other: Expr, span: Span | None) -> Expr:
    return Binary("*", value, other, span)


def _flipped(value: Expr, other: Expr, span: Span | None) -> Expr:
    return Binary("^", value, other, span)


# --- what comes back -----------------------------------------------------------------------------------------------------


def _follow_plus(value: Value, number: object) -> Value:
    return rounded(shifted(value, fraction(number)), 1)


def _follow_minus(value: Value, number: object) -> Value:
    return rounded(shifted(value, -fraction(number)), 1)


def _follow_from(value: Value, number: object) -> Value:
    return rounded(shifted(scaled(value, -1), fraction(number)), 1)


def _follow_times(value: Value, number: object) -> Value:
    return rounded(scaled(value, fraction(number)), 1)


def _follow_over(value: Value, number: object) -> Value:
    if not number:
        raise LostError(why_lost("/"))
    return divided_by(value, number, "/", value.type)


SUM = Form(_minus, _follow_plus, exact=True)
PRODUCT = Form(_divided, _follow_times)
DIFFERENCE = Form(_flipped, None, exact=True)

FORMS: Mapping[tuple[str, bool], Form] = MappingProxyType(
    {
        ("+", True): SUM,
        ("+", False): SUM,
        ("-", True): Form(_plus, _follow_minus, exact=True),
        ("-", False): Form(_from, _follow_from, exact=True),
        ("*", True): PRODUCT,
        ("*", False): PRODUCT,
        ("/", True): Form(_times, _follow_over),
        ("^", True): DIFFERENCE,
        ("^", False): DIFFERENCE,
    }
)
"""The records, by operator and whether the unknown operand is the left one."""
