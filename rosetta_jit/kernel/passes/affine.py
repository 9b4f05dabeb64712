"""How an expression depends on a loop's variable: ``base + step * variable``, both the same in every round."""

from __future__ import annotations

from itertools import islice

from rosetta_jit.kernel.limits import MAX_HOISTED_NODES
from rosetta_jit.kernel.nodes import Binary, Const, Expr, For, Get, IsText, Let, Load, Local, Nearest, Used
from rosetta_jit.kernel.rewrite import locals_in, reads_memory, substituted, with_operands
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.kernel.walk import bound_names, changed_names, operands, statements, subexpressions
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Affine:
    """``base + step * variable``."""

    base: Expr
    step: Expr


@dataclass(frozen=True, slots=True)
class Rounds:
    """What the rounds of a loop have in common: what varies from one to the next, and what its Lets are."""

    variable: str
    varying: frozenset[str]
    lets: dict[str, Expr]
    sums: dict[str, Affine | None]

    def is_fixed(self, expr: Expr) -> bool:
        """Whether an expression has the same value in every round, and before the first."""
        return not reads_memory(expr) and self.varying.isdisjoint(locals_in(expr))

    def at_first(self, expr: Expr) -> Expr:
        """The expression in round 0."""
        return substituted(expr, {self.variable: index(0)})

    def affine(self, expr: Expr) -> Affine | None:
        """An i64 expression as base and step, if it is such a sum."""
        found = self._affine(expr)
        return found if found is not None and _is_small(found.base) and _is_small(found.step) else None

    def fixed(self, expr: Expr) -> Expr | None:
        """An i64 expression as it can be computed before the loop, if it is the same in every round."""
        found = self.affine(expr)
        return found.base if found is not None and found.step == index(0) else None

    def _affine(self, expr: Expr) -> Affine | None:
        if self.is_fixed(expr):
            return Affine(expr, index(0))
        match expr:
            case Local(_, name):
                return Affine(index(0), index(1)) if name == self.variable else self.sums.get(name)
            case Binary("add", left, right):
                return _sum(self._affine(left), self._affine(right))
            case Binary("mul", left, right):
                return _product(self._affine(left), self._affine(right))
            case _:
                return self._of_fixed(expr)

    def _of_fixed(self, expr: Expr) -> Affine | None:
        """Any other operation, where its operands are the same in every round."""
        if isinstance(expr, Load | Get | Used | IsText | Nearest):
            return None
        values = {operand: self._affine(operand) for operand in operands(expr)}
        bases = {operand: value.base for operand, value in values.items() if value is not None and value.step == index(0)}
        return Affine(with_operands(expr, lambda operand: bases[operand]), index(0)) if len(bases) == len(values) else None


def rounds_of(loop: For) -> Rounds:
    """The rounds of a loop."""
    bound = {name for stmt, _ in statements(loop.body) for name in bound_names(stmt)}
    rounds = Rounds(loop.variable, frozenset(bound | changed_names(loop.body) | {loop.variable}), {}, {})
    for stmt in loop.body:
        if isinstance(stmt, Let):
            rounds.lets[stmt.name] = stmt.value
            rounds.sums[stmt.name] = rounds.affine(stmt.value)
    return rounds


def _is_small(expr: Expr) -> bool:
    return next(islice(subexpressions(expr), MAX_HOISTED_NODES, None), None) is None


def _sum(left: Affine | None, right: Affine | None) -> Affine | None:
    if left is None or right is None:
        return None
    return Affine(_plus(left.base, right.base), _plus(left.step, right.step))


def _product(left: Affine | None, right: Affine | None) -> Affine | None:
    if left is None or right is None:
        return None
    if left.step == index(0):
        left, right = right, left
    if right.step != index(0):
        return None
    return Affine(_times(left.base, right.base), _times(left.step, right.base))


def _plus(left: Expr, right: Expr) -> Expr:
    if isinstance(left, Const):
        left, right = right, left
    match left, right:
        case Binary("add", inner, Const("i64", value)), _ if not isinstance(right, Const):
            return add(_plus(inner, right), int(value))
        case _, Binary("add", inner, Const("i64", value)):
            return add(_plus(left, inner), int(value))
        case _:
            return add(left, right)


def _times(left: Expr, right: Expr) -> Expr:
    return index(0) if index(0) in {left, right} else mul(left, right)
