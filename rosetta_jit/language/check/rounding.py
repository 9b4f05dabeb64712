"""Values that are rounded to float32 though no text says so: constants that no float32 is equal to, and values whose unit changes."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.catalogue import resolve as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.conversions import describe, is_single, rounded_constant, same, widens
from rosetta_jit.language.typed import Assign, Assignment, Binary, Const, Convert, Expr, For, Place, Rescale, Rule, SetLength, When
from rosetta_jit.language.units.wholes import inserted
from rosetta_jit.language.walk import expressions_of, parts
from rosetta_jit.model.walk import every_rule


def rounded(rules: tuple[Rule, ...]) -> Iterator[Diagnostic]:
    """Warnings of one direction."""
    for rule in every_rule(rules):
        match rule:
            case Assign(value=value) | SetLength(value=value):
                yield from _constants(value)
                yield from _by_unit(rule)
            case For() | When():
                yield from (each for expr in expressions_of(rule) for each in _constants(expr))
            case _:
                pass


def _constants(expr: Expr) -> Iterator[Diagnostic]:
    for part in parts(expr):
        if isinstance(part, Const) and (single := rounded_constant(part)) is not None:
            yield words.rounded(part.span, float(part.value), single)


def _by_unit(rule: Assignment | SetLength[Place, Expr]) -> Iterator[Diagnostic]:
    """The conversion of a unit is computed in float64; that its result is a float32 may be the place's wish alone."""
    change = inserted(rule) if isinstance(rule, Assign) and is_single(rule.place.type) else None
    if not isinstance(change, Rescale):
        return
    value = rule.value.operand if isinstance(rule.value, Convert) else rule.value
    while isinstance(value, Binary):
        value = value.left
    origin = value.operand if isinstance(value, Convert) and value.rule == "widen" else value
    if not same(origin.type, rule.place.type) and not widens(origin.type, rule.place.type):
        yield words.rounded_by_unit(origin.span, describe(origin.type), change.source, change.target)
