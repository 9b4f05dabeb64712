"""What is known of positions of a message where a statement is printed, so that no comparison is made twice.

After `Require(at, size)` both `at` and `at + size` lie between 0 and the end of the message; so does a local that is bound to one of
these, until it is bound anew, and a result of a routine whose contract says so. Behind branches it does where it did in each of them. A
fact is a sum: its terms, in any order, and its constant.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.terms import END, add, index
from rosetta_jit.kernel.walk import statements

Terms = frozenset[tuple[nodes.Expr, int]]
"""Expressions of locals alone, and how often each is added."""

Positions = frozenset[tuple[Terms, int]]

NONE: Positions = frozenset()


def is_position(known: Positions, at: nodes.Expr) -> bool:
    """Whether an expression is known to lie within the message, or to be its end."""
    fact = _sum(at)
    if fact is None:
        return False
    terms, offset = fact
    offsets = [other for same, other in known if same == terms]
    if not terms:
        return 0 <= offset <= max(offsets, default=0)
    return bool(offsets) and min(offsets) <= offset <= max(offsets)


def after_require(known: Positions, at: nodes.Expr, size: nodes.Expr) -> Positions:
    """What is known where so many bytes are there."""
    begin, count = _sum(at), _sum(size)
    if begin is None:
        return known
    return known | ({begin} if count is None else {begin, _added(begin, count)})


def after_binding(known: Positions, name: str, value: nodes.Expr) -> Positions:
    """What is known where a local has been bound, for the first time or anew."""
    rest = forget(known, (name,))
    return rest | {_local(name)} if is_position(known, value) else rest


def after_call(known: Positions, call: nodes.Call, found: Iterable[int]) -> Positions:
    """What is known behind a call, of which these results are positions."""
    return forget(known, bound_in(call)) | {_local(call.results[number].name) for number in found}


def joined(stmt: nodes.If | nodes.Switch, ends: Iterable[Positions]) -> Positions:
    """What is known behind a statement of what is known at the ends of its branches; locals of these end there."""
    first, *others = [*ends] or [NONE]
    own = (each.name for each, _ in statements((stmt,)) if isinstance(each, nodes.Let | nodes.Var))
    return forget(first.intersection(*others), own)


def forget(known: Positions, names: Iterable[str]) -> Positions:
    """What is known whatever these locals have now."""
    changed = frozenset(names)
    return frozenset(fact for fact in known if not any(changed & locals_in(term) for term, _ in fact[0]))


def bound_in(stmt: nodes.Stmt) -> frozenset[str]:
    """The locals that a statement binds, and those in its blocks."""
    return frozenset(name for each, _ in statements((stmt,)) for name in _bound_by(each))


def said_by(invariant: Iterable[nodes.Expr]) -> Positions:
    """The variables that a loop says are positions of the message, or its end."""
    low, high = set[str](), set[str]()
    for each in invariant:
        match each:
            case nodes.Compare("ge", nodes.Local(_, name), nodes.Const(_, bound)) if bound >= 0:
                low.add(name)
            case nodes.Compare("le", nodes.Local(_, name), bound) if bound == END:
                high.add(name)
            case _:
                pass
    return frozenset(map(_local, low & high))


def difference(one: nodes.Expr, other: nodes.Expr) -> nodes.Expr | None:
    """What is left of a sum without the terms of another one; None where it has not all of them."""
    sums = _sum(one), _sum(other)
    if sums[0] is None or sums[1] is None:
        return None
    left, taken = Counter(dict(sums[0][0])), Counter(dict(sums[1][0]))
    if taken - left:
        return None
    parts = sorted((left - taken).elements(), key=str)
    return sum_of(parts, sums[0][1] - sums[1][1])


def terms_of(expr: nodes.Expr) -> list[nodes.Expr]:
    """The terms of a sum but its constant; none of what is no sum."""
    found = _sum(expr)
    return [] if found is None else [*Counter(dict(found[0])).elements()]


def sum_of(parts: Iterable[nodes.Expr], constant: int) -> nodes.Expr:
    """A sum as an expression."""
    found: nodes.Expr | None = None
    for each in parts:
        found = each if found is None else nodes.Binary("add", found, each)
    return index(constant) if found is None else add(found, constant) if constant else found


def _bound_by(stmt: nodes.Stmt) -> tuple[str, ...]:
    match stmt:
        case nodes.Let() | nodes.Var() | nodes.Assign():
            return (stmt.name,)
        case nodes.For():
            return (stmt.variable,)
        case nodes.Call():
            return tuple(each.name for each in stmt.results)
        case nodes.HostCall():
            return (stmt.result.name,)
        case _:
            return ()


def _local(name: str) -> tuple[Terms, int]:
    return frozenset({(nodes.Local("i64", name), 1)}), 0


def _sum(expr: nodes.Expr) -> tuple[Terms, int] | None:
    """An int64 as a sum; None where it depends on more than locals."""
    match expr:
        case nodes.Const("i64", value):
            return frozenset(), int(value)
        case nodes.Binary("add", left, right):
            one, other = _sum(left), _sum(right)
            return None if one is None or other is None else _added(one, other)
        case nodes.Local("i64") | nodes.Binary("mul", nodes.Local("i64"), nodes.Const()):
            return frozenset({(expr, 1)}), 0
        case _:
            return None


def _added(one: tuple[Terms, int], other: tuple[Terms, int]) -> tuple[Terms, int]:
    terms = Counter(dict(one[0]))
    terms.update(dict(other[0]))
    return frozenset(terms.items()), one[1] + other[1]
