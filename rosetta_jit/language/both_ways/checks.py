"""Checks of what must hold besides relations, so that what was unpacked is packed as it came."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import derive as words
from rosetta_jit.language.folding import FALSE, TRUE
from rosetta_jit.model.expr import Binary, Coerced, Expr, List, Literal, Path, Unary
from rosetta_jit.model.mapping import Reject, Relation, Rule, When
from rosetta_jit.model.printer import show_expr
from rosetta_jit.model.walk import Field
from rosetta_jit.source import Span

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse_parts import Digit
    from rosetta_jit.language.both_ways.knowledge import Beside


def checks_of(beside: Beside) -> tuple[Rule, ...]:
    """Checks of what must hold besides a relation."""
    span = beside.rule.span
    refused = tuple(When(condition, (Reject(why, span),), (), span) for condition, why in beside.refused)
    return (*(_within(digit, span) for digit in beside.digits), *refused)


def _within(digit: Digit, span: Span | None) -> Rule:
    is_below, is_above = Binary("<", digit.value, Literal(0, span), span), Binary(">=", digit.value, Literal(digit.below, span), span)
    reason = words.no_digit(show_expr(digit.value), digit.below)
    return When(Binary("or", is_below, is_above, span), (Reject(reason, span),), (), span)


def agreement(place: Field | List, wanted: Expr, rule: Relation) -> tuple[Rule, ...]:
    """That a holder has what unpacking is going to give, to the bit: -0 is not what 0 is unpacked to."""
    coerced = Coerced(place, wanted, rule.span) if isinstance(place, Path) and not isinstance(wanted, Path) else wanted
    reason = words.disagrees(show_expr(place), show_expr(wanted))
    return (When(Binary("differs", place, coerced, rule.span), (Reject(reason, rule.span),), (), rule.span),)


def guard(condition: Expr, rule: When[Rule, Expr], *, holds: bool) -> tuple[Rule, ...]:
    """That unpacking is going to take this block."""
    if condition == (TRUE if holds else FALSE):
        return ()
    wrong = Unary("not", condition, rule.condition.span) if holds else condition
    reason = words.other_block(show_expr(rule.condition), holds=holds)
    return (When(wrong, (Reject(reason, rule.span),), (), rule.span),)
