"""Fields that are bits of one integer of the holder, as one relation: `.status <-> .ready | .mode << 1` is `.mode * 2 + .ready`.

Where no bit is of two fields, both are the same number, and a sum is what packing takes apart: it has each field but the highest checked
to fit its bits (`language.both_ways.inverse_parts`). Fields that other rules know, too, may share bits, so that `|` stays as it is.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Set
from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.inverse import fields_in
from rosetta_jit.language.masks import MOST_BITS
from rosetta_jit.model.expr import Binary, Expr, Literal, Path
from rosetta_jit.model.mapping import For, Relation, Rule, When
from rosetta_jit.model.walk import Field, every_rule, expressions_of, fields_of, parts, rebuilt
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.bits import ConstantOf


def with_sums(rules: tuple[Rule, ...], is_completed: Callable[[Field], bool], constant_of: ConstantOf) -> tuple[Rule, ...]:
    """The rules, with a sum in each relation that alone says what the fields are whose bits it joins.

    ``is_completed`` says of a field whether the rules to pack alone set it.
    """
    if not any(isinstance(rule, Relation) and _joins(rule.value) for rule in every_rule(rules)):
        return rules
    read = Counter(field for rule in every_rule(rules) for expr in expressions_of(rule) for field in fields_of(expr, "wire"))
    own = {field for field, count in read.items() if count == 1 and not is_completed(field)}
    return _summed(rules, own, constant_of)


def _summed(rules: tuple[Rule, ...], own: Set[Field], constant_of: ConstantOf) -> tuple[Rule, ...]:
    return tuple(_rule(rule, own, constant_of) for rule in rules)


def _rule(rule: Rule, own: Set[Field], constant_of: ConstantOf) -> Rule:
    match rule:
        case Relation(Path(), value) if _joins(value) and own >= set(fields_in(value)):
            return replace(rule, value=_sum(value, constant_of))
        case For(body=body):
            return replace(rule, body=_summed(body, own, constant_of))
        case When(then=then, otherwise=otherwise):
            return replace(rule, then=_summed(then, own, constant_of), otherwise=_summed(otherwise, own, constant_of))
        case _:
            return rule


def _joins(value: Expr) -> bool:
    """Whether fields of the wire stand on both sides of a `|`."""
    return any(
        isinstance(part, Binary) and part.operator == "|" and bool(fields_in(part.left)) and bool(fields_in(part.right))
        for part in parts(value)
    )


def _sum(expr: Expr, constant_of: ConstantOf) -> Expr:
    """The fields added, from the highest on: `(.turns * 8 + .mode) * 2 + .ready`."""
    if not isinstance(expr, Binary) or expr.operator not in ("|", "<<"):
        return rebuilt(expr, lambda part: _sum(part, constant_of))
    pieces = sorted(_pieces(expr, 0, constant_of), key=lambda each: -each[1])
    if len(pieces) == 1:
        return expr
    total, at = pieces[0]
    for piece, shift in pieces[1:-1]:
        total, at = Binary("+", _times(total, at - shift, expr.span), piece, expr.span), shift
    last, shift = pieces[-1]
    return Binary("+", _times(total, at, expr.span), _times(last, shift, expr.span), expr.span)


def _pieces(expr: Expr, shift: int, constant_of: ConstantOf) -> list[tuple[Expr, int]]:
    """What bits are joined of, each with the number of bits that it is shifted by."""
    match expr:
        case Binary("|", left, right):
            return [*_pieces(left, shift, constant_of), *_pieces(right, shift, constant_of)]
        case Binary("<<", value, count) if (known := constant_of(count)) is not None and 0 <= known <= MOST_BITS - shift:
            return _pieces(value, shift + known, constant_of)
        case _:
            return [(expr, shift)]


def _times(value: Expr, shift: int, span: Span | None) -> Expr:
    return Binary("*", value, Literal(1 << shift, span), span) if shift else value
