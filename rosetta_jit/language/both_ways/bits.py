"""Bits of an integer as its digits, which packing puts together. Unpacking computes them as they are written.

`.w & 15`          `modulo(.w, 16)`                            `.w >> 4`          `floor_divide(.w, 16)`
`.w & 0x30`        `modulo(floor_divide(.w, 16), 4) * 16`      `.w & 4 != 0`      `bool(modulo(floor_divide(.w, 4), 2))`
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.language.masks import MOST_BITS, lowest_of_run
from rosetta_jit.model.expr import Binary, Call, Expr, Len, Literal, Path, Unary
from rosetta_jit.model.mapping import For, Relation, Rule, When
from rosetta_jit.model.types import Int
from rosetta_jit.model.walk import rebuilt
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf

    ConstantOf = Callable[[Expr], int | None]
    """The integer that a constant expression is; None of others."""


@dataclass(frozen=True, slots=True)
class Bits:
    """Puts digits in place of bits; ``written`` are the values of relations as they stand in the text, by the rule that they became."""

    type_of: TypeOf
    constant_of: ConstantOf
    written: dict[int, Expr]

    def rules(self, rules: tuple[Rule, ...]) -> tuple[Rule, ...]:
        """Rules whose relations have digits."""
        return tuple(map(self.rule, rules))

    def rule(self, rule: Rule) -> Rule:
        match rule:
            case Relation(Path(), value):  # lengths stay as they are written, to be equal to the ends of loops
                made = replace(rule, value=self.digits(value))
                self.written[id(made)] = value
                return made
            case For(body=body):
                return replace(rule, body=self.rules(body))
            case When(then=then, otherwise=otherwise):
                return replace(rule, then=self.rules(then), otherwise=self.rules(otherwise))
            case _:
                return rule

    def digits(self, expr: Expr) -> Expr:
        """An expression with digits."""
        found: Expr | None = None
        match expr:
            case Path() | Len():
                return expr
            case Binary("&", left, right):
                found = self.masked(left, right) or self.masked(right, left)
            case Binary(">>", value, count) if self.is_computed_with(value):
                known = self.constant_of(count)
                found = None if known is None or not 0 < known <= MOST_BITS else _quotient(self.digits(value), known, expr.span)
            case Binary("==" | "!=" as operator, left, right):
                found = self.tested(left, right, holds=operator == "==")
            case _:
                pass
        return rebuilt(expr, self.digits) if found is None else found

    def masked(self, value: Expr, mask: Expr) -> Expr | None:
        """Bits that are neighbours, where they stand."""
        known = self.constant_of(mask)
        shift = None if known is None else lowest_of_run(known)
        if known is None or shift is None or not self.is_computed_with(value):
            return None
        found = _low_bits(_quotient(self.digits(value), shift, value.span), (known >> shift) + 1, value.span)
        return found if not shift else Binary("*", found, Literal(1 << shift, value.span), value.span)

    def tested(self, value: Expr, constant: Expr, *, holds: bool) -> Expr | None:
        """Whether one bit is set: `.w & 4 != 0`, `.w & 4 == 4`, `.w >> 2 & 1 == 1`, and the opposite of each."""
        known, mask = self.constant_of(constant), self.mask_of(value)
        if mask is None or mask & (mask - 1) or known not in (0, mask):
            return None
        bits = self.digits(value)
        bit = bits.left if isinstance(bits, Binary) else bits
        is_set = Call("bool", (bit,), value.span)
        return is_set if holds == bool(known) else Unary("not", is_set, value.span)

    def mask_of(self, expr: Expr) -> int | None:
        """The mask of bits that are taken from an integer."""
        if not isinstance(expr, Binary) or expr.operator != "&":
            return None
        sides = ((expr.left, expr.right), (expr.right, expr.left))
        return next((self.constant_of(mask) for value, mask in sides if self.masked(value, mask) is not None), None)

    def is_computed_with(self, value: Expr) -> bool:
        """Whether arithmetic takes a value: an integer, but no uint64."""
        type_ = self.type_of(value)
        return isinstance(type_, Int) and (type_.signed or type_.bits < 64)


def _quotient(value: Expr, shift: int, span: Span | None) -> Expr:
    return value if not shift else Call("floor_divide", (value, Literal(1 << shift, span)), span)


def _low_bits(value: Expr, below: int, span: Span | None) -> Expr:
    return Call("modulo", (value, Literal(below, span)), span)
