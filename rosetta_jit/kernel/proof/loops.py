"""What is true in every round of a loop: guessed at the entry, kept as long as each round keeps it.

The relations guessed are few: a position stays within the message, nothing falls below its first value or below zero. One that a
round breaks is dropped for good, so that for all its loops together a kernel is walked at most once for each guess. To walk a loop again
is to walk all loops in it again: what can hardly hold is not tried.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.ir import Advance, Assign
from rosetta_jit.kernel.limits import MAX_LOOP_ROUNDS
from rosetta_jit.kernel.proof import claims
from rosetta_jit.kernel.proof.formula import All, Any
from rosetta_jit.kernel.proof.linear import Linear, minus, plus, shifted, times
from rosetta_jit.kernel.proof.paths import anchors, from_begin, grown, variable
from rosetta_jit.kernel.proof.symbolic import linear
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.shape import bound_names, expressions_of, statements
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Mapping

    from rosetta_jit.kernel.ir import Block, Expr
    from rosetta_jit.kernel.proof.formula import Formula
    from rosetta_jit.kernel.proof.scope import Scope, Typed


@dataclass(frozen=True, slots=True)
class Guess:
    """A relation that may hold in every round of a loop: ``sign * (variable - anchor) >= 0``."""

    name: str
    anchor: int
    sign: int


@dataclass(frozen=True, slots=True)
class Loop:
    """A loop's body and how to walk a round: ``enter`` is told the first atom of the round, ``leave`` checks what a round owes."""

    body: Block
    enter: Callable[[int], None]
    walk: Callable[[], bool]
    leave: Callable[[], None]


@dataclass(frozen=True, slots=True)
class Entry:
    """Where a loop begins: a mark to go back to, used lengths, and the variables that the loop changes."""

    mark: int
    used: list[Linear]
    variables: dict[str, Typed]


def walk_rounds(scope: Scope, loop: Loop, dropped: set[Guess]) -> None:
    """Walk any round of a loop, and go to the place after it, with the same guesses known."""
    names, lanes = changed_names(loop.body), advanced_lanes(loop.body)
    at_entry = Entry(scope.mark(), list(scope.used), {name: scope.locals[name] for name in sorted(names & scope.locals.keys())})
    kept = [guess for guess in guesses(scope, names) if guess not in dropped]
    while True:
        written = 0 if scope.record is None else scope.record.mark()
        lost = _round(scope, loop, at_entry, kept)
        scope.rollback(at_entry.mark)
        scope.used = list(at_entry.used)
        if not lost:
            break
        if scope.record is not None:
            scope.record.retract(written)
        dropped.update(lost)
        kept = [guess for guess in kept if guess not in dropped]
    if scope.record is not None:
        first = [instance(scope, guess, at_entry.variables[guess.name], _now(scope, guess)) for guess in kept]
        scope.record.owe_all(first, claims.RELATION_FIRST)
    forget(scope, at_entry, lanes, kept)


def _round(scope: Scope, loop: Loop, at_entry: Entry, kept: list[Guess]) -> list[Guess]:
    """Walk one round; returns the guesses that it breaks."""
    facts = scope.facts
    mark, first_atom = facts.mark(), len(facts.lows)
    forget(scope, at_entry, advanced_lanes(loop.body), kept)
    loop.enter(first_atom)
    lost: list[Guess] = []
    if not loop.walk() and not facts.impossible:
        loop.leave()
        claimed = [(guess, instance(scope, guess, at_entry.variables[guess.name], _now(scope, guess))) for guess in kept]
        lost = [guess for guess, formula in claimed if not facts.proves(formula)]
        if scope.record is not None:
            scope.record.owe_all([formula for _, formula in claimed], claims.RELATION_KEPT)
    facts.rollback(mark)
    return lost


def bounds(scope: Scope, measure: Linear, condition: Formula, first_atom: int) -> Formula:
    """That a measure cannot grow for ever: a constant lies above it, or the message's end, or what the loop's condition compares it with.

    The last must be the same in each round: made of atoms before ``first_atom``, the first that the round made.
    """
    low, high = scope.facts.lower(measure), scope.facts.upper(measure)
    within = All((shifted(measure, -low), shifted(times(measure, -1), high))) if high - low <= MAX_LOOP_ROUNDS else False
    fixed = (part for part in _conjuncts(condition) if all(atom < first_atom for atom, _ in plus(part, measure).terms))
    return Any((within, minus(linear(scope.locals["end"][1]), measure), *fixed))


def _conjuncts(formula: Formula) -> list[Linear]:
    match formula:
        case Linear():
            return [formula]
        case All(parts):
            return [conjunct for part in parts for conjunct in _conjuncts(part)]
        case _:
            return []


def changed_names(body: Block) -> set[str]:
    """The variables that a loop assigns."""
    return {stmt.name for stmt, _ in statements(body) if isinstance(stmt, Assign)}


def needless(body: Block, said: Iterable[Expr], measure: Expr | None, known: Container[str], reads: dict[int, set[str]]) -> set[Guess]:
    """That a variable does not fall below its first value, where a loop sets it to what is not made of that, or says what it keeps.

    What grows in each round is tried all the same: a loop around this one may grow by it. ``reads`` keeps the names that statements read,
    by their ids: those of a loop are asked for again by each loop around it.
    """
    users: dict[str, set[str]] = {}
    assigned: dict[str, list[set[str]]] = {}
    for stmt, _ in statements(body):
        read = reads.get(id(stmt))
        if read is None:
            read = reads[id(stmt)] = set[str]().union(*map(locals_in, expressions_of(stmt)))
        if isinstance(stmt, Assign):
            assigned.setdefault(stmt.name, []).append(read)
        for name in read:
            users.setdefault(name, set()).update((stmt.name,) if isinstance(stmt, Assign) else bound_names(stmt))
    told = {name for expr in said for name in locals_in(expr)} - (set[str]() if measure is None else locals_in(measure))
    variables = [name for name in assigned if name in known]
    return {Guess(name, 2, 1) for name in variables if name in told or not all(map(_made_of(name, users).intersection, assigned[name]))}


def _made_of(name: str, users: Mapping[str, set[str]]) -> set[str]:
    """A variable, and all that is computed from it, directly or not."""
    found, waiting = {name}, [name]
    while waiting:
        new = users.get(waiting.pop(), set()) - found
        found |= new
        waiting += new
    return found


def advanced_lanes(body: Block) -> set[int]:
    """The lanes that a loop takes rows of."""
    return {stmt.lane for stmt, _ in statements(body) if isinstance(stmt, Advance)}


def guesses(scope: Scope, names: set[str]) -> list[Guess]:
    """Relations that hold at the entry: positions stay in the message, and nothing falls below its first value or zero."""
    found: list[Guess] = []
    for name in sorted(names & scope.locals.keys()):
        type_, value = scope.locals[name]
        if type_ == "bool" or not isinstance(value, Linear):
            continue
        wanted = [Guess(name, 2, 1), Guess(name, 3, 1)]
        if type_ == "i64" and from_begin(value):
            wanted += [Guess(name, 0, 1), Guess(name, 1, -1)]
        found += [guess for guess in wanted if scope.facts.proves(instance(scope, guess, (type_, value), value))]
    return found


def instance(scope: Scope, guess: Guess, at_entry: Typed, value: Linear) -> Linear:
    """A guess about a value, as a fact; ``at_entry`` is the variable before the first round."""
    marks = anchors(scope, at_entry)
    return times(minus(value, marks[guess.anchor]), guess.sign)


def _now(scope: Scope, guess: Guess) -> Linear:
    return linear(scope.locals[guess.name][1])


def forget(scope: Scope, at_entry: Entry, lanes: set[int], kept: list[Guess]) -> None:
    """Go to the head of some round: what the loop changes is unknown but for the guesses."""
    for name, (type_, old) in at_entry.variables.items():
        if type_ == "bool" or type_ in FLOATS:
            scope.bind(name, (type_, None))
        else:
            scope.bind(name, (type_, variable(scope, type_, relative=from_begin(linear(old)))))
    for guess in kept:
        scope.facts.assume(instance(scope, guess, at_entry.variables[guess.name], _now(scope, guess)))
    for lane in sorted(lanes):
        scope.used[lane] = grown(scope, lane, at_entry.used[lane])
