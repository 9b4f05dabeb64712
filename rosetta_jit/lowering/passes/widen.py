"""Comparisons that hold in each round of a loop if they hold in its first or its last. Part of `hoist`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Binary, Compare, Const, Fits, add, index, mul, type_of

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Expr
    from rosetta_jit.lowering.passes.affine import Affine, Rounds


def widened(condition: Expr, count: Expr, rounds: Rounds) -> tuple[Expr, ...]:
    """Conditions that, one after another, hold exactly where one holds in each of ``count > 0`` rounds; () if none do."""
    if rounds.is_fixed(condition):
        return (condition,)
    match condition:
        case Binary("and", left, right):
            first, second = widened(left, count, rounds), widened(right, count, rounds)
            return (*first, *second) if first and second else ()
        case Compare("lt" | "le" | "gt" | "ge", left, right) if type_of(left) == "i64":
            value, bound = rounds.affine(left), rounds.fixed(right)
            return _extreme(condition, value, bound, count) if value is not None and bound is not None else ()
        case _:
            return ()


def _extreme(condition: Compare, value: Affine, bound: Expr, count: Expr) -> tuple[Expr, ...]:
    """The comparison in the round that is closest to failing."""
    match value.step:
        case Const(_, step):
            grows_away = (step >= 0) == (condition.op in {"gt", "ge"})
            if step == 0 or grows_away:
                return (Compare(condition.op, value.base, bound),)
            last = add(count, -1)
            distance = mul(last, int(step))
            # What does not fit lies beyond every bound, so that the comparison fails in some round.
            fits = Fits("mul", last, index(int(step))), Fits("add", value.base, distance)
            return (*fits, Compare(condition.op, add(value.base, distance), bound))
        case _:
            return ()
