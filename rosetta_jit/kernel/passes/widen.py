"""Comparisons that hold in each round of a loop if they hold in its first or its last. Part of `hoist`."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Binary, Compare, Const, Expect, Expr, Failure, Fits
from rosetta_jit.kernel.passes.affine import Affine, Rounds
from rosetta_jit.kernel.terms import add, index, mul, type_of
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class _Check:
    """What is asked once, and of which round. Where ``compared`` grows by one a round, ``reached`` is its first value that fails."""

    condition: Expr
    round: Expr
    compared: Affine | None = None
    reached: Expr | None = None


def widened(stmt: Expect, count: Expr, rounds: Rounds) -> tuple[Expect, ...]:
    """Checks that, one after another, hold exactly where one holds in each of ``count > 0`` rounds; () if there are none."""
    checks = [(check, _failure(stmt.failure, check, rounds)) for check in _checks(stmt.condition, count, rounds)]
    found = tuple(Expect(check.condition, failure) for check, failure in checks if failure is not None)
    return found if len(found) == len(checks) else ()


def _checks(condition: Expr, count: Expr, rounds: Rounds) -> tuple[_Check, ...]:
    if (known := rounds.fixed(condition)) is not None:
        return (_Check(known, index(0)),)
    match condition:
        case Binary("and", left, right):
            first, second = _checks(left, count, rounds), _checks(right, count, rounds)
            return (*first, *second) if first and second else ()
        case Compare("lt" | "le" | "gt" | "ge", left, right) if type_of(left) == "i64":
            value, bound = rounds.affine(left), rounds.fixed(right)
            return _extreme(condition, value, bound, count) if value is not None and bound is not None else ()
        case Fits("add", left, right):
            parts = rounds.affine(left), rounds.affine(right)
            return _both_ends(parts[0], parts[1], count) if parts[0] is not None and parts[1] is not None else ()
        case _:
            return ()


def _both_ends(left: Affine, right: Affine, count: Expr) -> tuple[_Check, ...]:
    """A sum that fits in the first round and in the last one fits in those between."""
    last = add(count, -1)
    checks = [_Check(Fits("add", left.base, right.base), index(0))]
    ends: list[Expr] = []
    for part in (left, right):
        if not isinstance(part.step, Const):
            return ()
        distance = mul(last, int(part.step.value))
        if part.step.value:
            checks += _Check(Fits("mul", last, part.step), index(0)), _Check(Fits("add", part.base, distance), index(0))
        ends.append(add(part.base, distance) if part.step.value else part.base)
    return *checks, _Check(Fits("add", ends[0], ends[1]), last)


def _extreme(condition: Compare, value: Affine, bound: Expr, count: Expr) -> tuple[_Check, ...]:
    """The comparison in the round that is closest to failing."""
    match value.step:
        case Const(_, step):
            grows_away = (step >= 0) == (condition.op in {"gt", "ge"})
            if step == 0 or grows_away:
                return (_Check(Compare(condition.op, value.base, bound), index(0)),)
            last = add(count, -1)
            distance = mul(last, int(step))
            # What does not fit lies beyond every bound, so that the comparison fails in some round.
            fits = _Check(Fits("mul", last, index(int(step))), index(0)), _Check(Fits("add", value.base, distance), index(0))
            reached = Binary("max", value.base, bound) if (condition.op, step) == ("lt", 1) else None
            return (*fits, _Check(Compare(condition.op, add(value.base, distance), bound), last, value, reached))
        case _:
            return ()


def _failure(failure: Failure, check: _Check, rounds: Rounds) -> Failure | None:
    """The failure of the round that a check speaks of."""
    at, indices = _value(failure.at, check, rounds), tuple(_value(each, check, rounds) for each in failure.indices)
    return None if at is None or None in indices else Failure(failure.site, at, tuple(each for each in indices if each is not None))


def _value(expr: Expr, check: _Check, rounds: Rounds) -> Expr | None:
    """What a failure of all rounds shows of a value. Of what an inner loop reached, the first that lies beyond its bound."""
    found = rounds.affine(expr)
    if found is None:
        return _reached(expr, rounds)
    if found == check.compared and check.reached is not None:
        return check.reached
    return add(found.base, mul(check.round, found.step)) if found.step != index(0) else found.base


def _reached(expr: Expr, rounds: Rounds) -> Expr | None:
    match expr:
        case Binary("max", value, bound):
            first, limit = rounds.affine(value), rounds.fixed(bound)
            return None if first is None or limit is None else Binary("max", first.base, limit)
        case _:
            return None
