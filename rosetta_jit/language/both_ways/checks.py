"""Checks of what must hold besides relations, so that what was unpacked is packed as it came."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import derive as words
from rosetta_jit.model.expr import Binary, Literal
from rosetta_jit.model.mapping import Reject, When
from rosetta_jit.model.printer import show_expr

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse_parts import Digit
    from rosetta_jit.language.both_ways.knowledge import Beside
    from rosetta_jit.model.mapping import Rule
    from rosetta_jit.source import Span


def checks_of(beside: Beside) -> tuple[Rule, ...]:
    """Checks of what must hold besides a relation."""
    span = beside.rule.span
    refused = tuple(When(condition, (Reject(why, span),), (), span) for condition, why in beside.refused)
    return (*(_within(digit, span) for digit in beside.digits), *refused)


def _within(digit: Digit, span: Span | None) -> Rule:
    is_below, is_above = Binary("<", digit.value, Literal(0, span), span), Binary(">=", digit.value, Literal(digit.below, span), span)
    reason = words.no_digit(show_expr(digit.value), digit.below)
    return When(Binary("or", is_below, is_above, span), (Reject(reason, span),), (), span)
