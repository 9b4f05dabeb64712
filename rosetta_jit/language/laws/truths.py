"""What conditions say of the values of a message, in all rounds of some loops or in this one."""

from __future__ import annotations

from typing import Any

from rosetta_jit.language.algebra.equality import Ranges, digit, fact, has_local, reads_other, same_ranges
from rosetta_jit.language.algebra.quotients import Facts
from rosetta_jit.language.laws.chain import table_of
from rosetta_jit.language.typed import BOOL, Access, Binary, Choice, Const, Convert, Expr, LenOf, Unary
from rosetta_jit.language.walk import rebuilt
from rosetta_jit.model.expr import Side
from rosetta_jit.model.types import Float, Int
from rosetta_jit.startup.dataclass import replace


class Truths:
    """Conditions that hold or do not, and what is equal; asked in the loops over ``ranges``. Values are those of the side ``origin``."""

    def __init__(self, origin: Side) -> None:
        self.origin: Side = origin
        self.ranges: Ranges = ()
        self.plain: Facts | None = None
        self.truths: dict[Expr, tuple[bool, Ranges]] = {}
        self.equal: dict[Expr, list[tuple[Expr, Ranges]]] = {}

    def know(self, condition: Expr, ranges: Ranges, *, holds: bool) -> None:
        """What follows from a condition, in all rounds of loops over ``ranges``."""
        match condition:
            case Unary("not", operand):
                self.know(operand, ranges, holds=not holds)
            case Binary("and" | "or" as operator, left, right) if (operator == "and") == holds:
                self.know(left, ranges, holds=holds)
                self.know(right, ranges, holds=holds)
            case Binary("==" | "!=" as operator, left, right):
                if (operator == "==") == holds and _equal_to_the_bit(left, right):
                    self.same(left, right, ranges)
                self.true(replace(condition, operator="=="), ranges, holds=(operator == "==") == holds)
                self.true(replace(condition, operator="!="), ranges, holds=(operator == "!=") == holds)
                if isinstance(right, Const):
                    self.know_key(left, right, ranges, holds=(operator == "==") == holds)
            case Binary("differs", left, right) if not holds:
                self.same(left, right, ranges)
                self.true(condition, ranges, holds=holds)
            case _:
                self.true(condition, ranges, holds=holds)

    def know_key(self, table: Expr, chosen: Const, ranges: Ranges, *, holds: bool) -> None:
        """What follows for the key of a table of constants, which may be made another integer, from whether it has chosen one of them."""
        keeps = isinstance(table, Convert) and isinstance(table.type, Int) and table.rule not in {"saturate", "wrap"}
        choice = table.operand if isinstance(table, Convert) and keeps else table
        found = table_of(choice) if isinstance(choice, Choice) else None
        if found is None:
            return
        key, rest = found[0], found[2]
        entries: dict[Any, Any] = found[1]
        mine = [each for each, value in entries.items() if value == chosen.value]
        for each in entries.keys() - mine if holds else mine:
            self.know(Binary("==", key, Const(each, key.type), BOOL), ranges, holds=False)
        if holds and len(mine) == 1 and (rest is None or rest.value != chosen.value):
            self.know(Binary("==", key, Const(mine[0], key.type), BOOL), ranges, holds=True)
        for value in {each for each in entries.values() if holds and each != chosen.value}:
            self.true(Binary("==", table, Const(value, chosen.type), BOOL), ranges, holds=False)

    def narrowed(self, expr: Expr) -> Expr:
        """An expression whose choices have no cases that are known not to come."""
        match expr:
            case Choice(cases) if any(self.truth(condition) is False for condition, _ in cases):
                left = [(condition, value) for condition, value in cases if self.truth(condition) is not False]
                return self.narrowed(replace(expr, cases=tuple(left))) if left else expr
            case _:
                return rebuilt(expr, self.narrowed)

    def same(self, left: Expr, right: Expr, ranges: Ranges) -> None:
        self.plain = None
        self.equal.setdefault(left, []).append((right, ranges))
        self.equal.setdefault(right, []).append((left, ranges))

    def true(self, condition: Expr, ranges: Ranges, *, holds: bool) -> None:
        self.truths[_without_span(condition)] = holds, ranges

    def applies(self, expr: Expr, ranges: Ranges) -> bool:
        """Whether what is known of each round of some loops is known in this round: where the loops are these."""
        return not has_local(expr) or same_ranges(ranges, self.ranges[: len(ranges)], self.always())

    def truth(self, condition: Expr) -> bool | None:
        """Whether a condition is known to hold."""
        holds, ranges = self.truths.get(_without_span(condition), (None, ()))
        return holds if holds is None or self.applies(condition, ranges) else None

    def equal_to(self, expr: Expr) -> list[Expr]:
        """What an expression is known to be equal to."""
        return [other for other, ranges in self.equal.get(expr, []) if self.applies(Binary("==", expr, other, BOOL), ranges)]

    def facts(self, side: Side) -> Facts:
        """What is known of integers of the side that the first direction reads."""
        pairs = [(expr, other) for expr in self.equal if isinstance(expr, Access | LenOf) for other in self.equal_to(expr)]
        found = [fact(*pair) for pair in pairs if not any(reads_other(each, side) for each in pair)]
        digits = [digit(each, self.truth) for each in self.truths if not reads_other(each, side)]
        return Facts(tuple(each for each in found if each is not None), tuple(each for each in digits if each is not None))

    def always(self) -> Facts:
        """What lengths and integers are known to be whatever the round."""
        if self.plain is None:
            pairs = [(expr, other) for expr, others in self.equal.items() if isinstance(expr, Access | LenOf) for other, _ in others]
            found = [fact(*pair) for pair in pairs if not any(has_local(each) or reads_other(each, self.origin) for each in pair)]
            self.plain = Facts(tuple(each for each in found if each is not None))
        return self.plain


def _without_span(expr: Expr) -> Expr:
    """An expression that is the same wherever it is written."""
    return replace(expr, span=None) if isinstance(expr, Binary) else expr


def _equal_to_the_bit(left: Expr, right: Expr) -> bool:
    """Whether two values of which a condition says that they are equal are the same: -0 equals 0."""
    if not isinstance(left.type, Float) and not isinstance(right.type, Float):
        return True
    return any(isinstance(each, Const) and each.value != 0 for each in (left, right))
