"""Where the branches of a kernel meet again, and what is known there.

A variable that differs between paths becomes a new unknown. What is kept about it: its distances from a few *anchors* (the ends of
the message, its value before), as far as every path shows them.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import ne

from rosetta_jit.kernel.arithmetic import limits
from rosetta_jit.kernel.limits import MAX_POSITION, MAX_ROWS
from rosetta_jit.kernel.nodes import Scalar
from rosetta_jit.kernel.proof import claims
from rosetta_jit.kernel.proof.formula import Formula
from rosetta_jit.kernel.proof.linear import Linear, coefficient_of, minus, plus, shifted, sum_of, times
from rosetta_jit.kernel.proof.scope import Arrival, Scope, Typed
from rosetta_jit.kernel.proof.symbolic import linear

BEGIN_ATOM = 0
"""The first atom of every scope."""

ZERO = Linear(0)

FAR = 1 << 32
"""A distance that says nothing worth keeping."""


def branch(scope: Scope, ways: list[tuple[Formula, Callable[[], bool]]]) -> bool:
    """Walk each way under its condition, and go on with what all that arrive have in common; True where all have returned."""
    here, used = scope.mark(), scope.used
    before: dict[str, Typed] = {}
    arrivals: list[Arrival] = []
    returned = False
    for formula, walk in ways:
        mark = scope.facts.mark()
        scope.facts.assume(formula)
        if walk():
            returned = True
            scope.facts.rollback(mark)
        elif scope.facts.impossible:
            if scope.record is not None:
                scope.record.owe(formula=False, claim=claims.UNREACHABLE)
            scope.facts.rollback(mark)
        else:
            changed = scope.changed(here)
            before.update(changed)
            arrivals.append(_arrive(scope, changed, mark))
        scope.rollback(here)
        scope.used = used
    if arrivals and scope.record is not None:
        from rosetta_jit.kernel.proof.meetings import meet

        meet(scope, scope.record, before, arrivals, _meet)
    elif arrivals:
        _meet(scope, before, arrivals)
    elif not returned:
        scope.facts.assume(formula=False)
    return returned and not arrivals


def _arrive(scope: Scope, before: dict[str, Typed], mark: int) -> Arrival:
    """End a path: give up its facts, and keep what a meeting point needs. ``before`` is what it changed."""
    changed = {name: scope.locals[name] for name in before}
    distances: dict[str, list[tuple[int, int]]] = {}
    for name, now in changed.items():
        if _is_number(now):
            distances[name] = _distances(scope, linear(now[1]), anchors(scope, before[name]))
    premises = None if scope.record is None else scope.record.premises()
    return Arrival(changed, scope.used, scope.facts.rollback(mark), distances, premises)


def anchors(scope: Scope, old: Typed) -> list[Linear]:
    """What the values of a variable are compared with."""
    return [scope.begin, scope.end, linear(old[1]), ZERO]


def _is_number(value: Typed) -> bool:
    """Whether something is known of an integer; what is known of a bool may look like one."""
    return value[0] != "bool" and isinstance(value[1], Linear)


def _distances(scope: Scope, value: Linear, marks: list[Linear]) -> list[tuple[int, int]]:
    """For each anchor the least of ``value - anchor`` and of ``anchor - value``.

    Worth a proof is only that the value is in the message, and no less than before, or greater where that is quickly found.
    """
    ends = scope.facts.ends
    behind_begin, behind_end, grown_by, itself = [minus(value, mark) for mark in marks]
    after_begin, before_begin = ends(behind_begin)
    after_end, before_end = ends(behind_end)
    more, less = ends(grown_by)
    return [
        (_least(scope, after_begin, behind_begin), before_begin),
        (after_end, _least(scope, before_end, behind_end, -1)),
        (_growth(scope, more, grown_by), less),
        ends(itself),
    ]


def _least(scope: Scope, low: int, distance: Linear, sign: int = 1) -> int:
    """The least of a multiple of a distance, of which the table says that it is no less than ``low``."""
    return 0 if low < 0 and coefficient_of(distance, BEGIN_ATOM) == 0 and scope.facts.proves(times(distance, sign)) else low


def _growth(scope: Scope, low: int, distance: Linear) -> int:
    low = _least(scope, low, distance)
    return 1 if low == 0 and scope.facts.adds_up(shifted(distance, -1)) else low


def _meet(scope: Scope, before: dict[str, Typed], arrivals: list[Arrival]) -> None:
    """Go on with what is true on all paths that arrive (at least one); ``before`` is what any of them changed."""
    first, *others = arrivals
    for terms, bound in first.gained.items():
        shared = [arrival.gained.get(terms) for arrival in others]
        if None not in shared:
            scope.facts.assume(sum_of((-min([bound, *(each for each in shared if each is not None)]), terms)))
    for name, old in before.items():
        scope.bind(name, _met(scope, old, arrivals, name))
    unlike = sorted(set[int]().union(*[_unlike(first.used, arrival.used) for arrival in others]))
    met = {lane: grown(scope, lane, scope.used[lane]) for lane in unlike}
    scope.used = tuple([met.get(lane, used) for lane, used in enumerate(first.used)]) if met else first.used


def _unlike(used: tuple[Linear, ...], other: tuple[Linear, ...]) -> list[int]:
    """The lanes of which other lengths are used."""
    return [] if used is other else [lane for lane, is_other in enumerate(map(ne, used, other)) if is_other]


def _met(scope: Scope, old: Typed, arrivals: list[Arrival], name: str) -> Typed:
    values = [arrival.changed.get(name, old) for arrival in arrivals]
    if all(value[1] == values[0][1] for value in values):
        return values[0]
    if not _is_number(old):
        return old[0], None
    met = variable(scope, old[0], relative=all(from_begin(linear(value[1])) for value in values))
    marks = anchors(scope, old)
    unchanged = any(name not in arrival.distances for arrival in arrivals)
    own = _distances(scope, linear(old[1]), marks) if unchanged else []
    for k, mark in enumerate(marks):
        ways = [arrival.distances.get(name, own)[k] for arrival in arrivals]
        distance = minus(met, mark)
        learn_distance(scope, distance, min([way[0] for way in ways]))
        learn_distance(scope, distance, min([way[1] for way in ways]), -1)
    return old[0], met


def learn_distance(scope: Scope, distance: Linear, least: int, sign: int = 1) -> None:
    """Keep a lower bound of a distance, or with ``sign`` -1 of its opposite, if it says anything."""
    if least > -FAR or len(distance.terms) == 1:
        scope.facts.derive(shifted(times(distance, sign), -least))


# --- unknowns ----------------------------------------------------------------------------------------------------------


def variable(scope: Scope, type_: Scalar, *, relative: bool) -> Linear:
    """Any integer of a type; one that is a position is kept as a distance from `begin`."""
    low, high = limits(type_)
    if not relative:
        return scope.facts.fresh(low, high)
    value = plus(scope.begin, scope.facts.fresh(low - MAX_POSITION, high))
    scope.facts.assume(shifted(times(value, -1), high))
    return value


def grown(scope: Scope, lane: int, before: Linear) -> Linear:
    """The used length of a lane some time later: it never shrinks."""
    rows = scope.facts.fresh(0, MAX_ROWS)
    scope.facts.assume(minus(scope.capacity[lane], rows))
    scope.facts.assume(minus(rows, before))
    return rows


def from_begin(value: Linear) -> bool:
    """Whether a value is a distance from `begin`: a position."""
    return coefficient_of(value, BEGIN_ATOM) == 1
