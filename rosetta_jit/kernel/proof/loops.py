"""What is true in every round of a loop: guessed at the entry, kept as long as each round keeps it.

The relations guessed are few: a position stays within the message, nothing falls below its first value or below zero, what each
round adds an integer of few bits to has grown by no more than so many times the largest. One that a
round breaks is dropped for good, so that for all its loops together a kernel is walked at most once for each guess. To walk a loop again
is to walk all loops in it again: what can hardly hold is not tried.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Container, Iterable, Iterator, Mapping

from rosetta_jit.kernel.arithmetic import FLOATS, limits
from rosetta_jit.kernel.limits import MAX_LOOP_ROUNDS
from rosetta_jit.kernel.nodes import WIDTH, Advance, Assign, Binary, Block, Const, Convert, Expr, Get, If, Let, Load, Local, Select, Stmt
from rosetta_jit.kernel.proof import claims
from rosetta_jit.kernel.proof.formula import All, Any, Formula
from rosetta_jit.kernel.proof.linear import Linear, minus, plus, shifted, times
from rosetta_jit.kernel.proof.paths import ZERO, anchors, from_begin, grown, variable
from rosetta_jit.kernel.proof.scope import Scope, Typed
from rosetta_jit.kernel.proof.symbolic import linear
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import blocks_of, bound_names, changed_names, expressions_of, flat, operands, statements
from rosetta_jit.startup.dataclass import dataclass

FEW_BYTES = 4
"""Integers of so many are added up without a check in each round."""

READS = frozenset((Load, Get))

ROUNDS = 4
"""The anchor that is a variable's first value and a ``step`` for each round before."""


@dataclass(frozen=True, slots=True)
class Guess:
    """A relation that may hold in every round of a loop: ``sign * (variable - anchor) >= 0``."""

    name: str
    anchor: int
    sign: int
    step: int = 0


@dataclass(frozen=True, slots=True)
class Loop:
    """A loop's body and how to walk a round: ``enter`` is told the first atom of the round, ``leave`` checks what a round owes.

    One that counts its rounds has a ``variable`` that does, and a ``count`` of all of them.
    """

    body: Block
    enter: Callable[[int], None]
    walk: Callable[[], bool]
    leave: Callable[[], None]
    variable: str = ""
    count: Linear = ZERO


Made = tuple[tuple[str, ...], set[str], bool]
"""The names that a statement gives values to, those that these are made of, and whether the statement is an Assign."""


@dataclass(frozen=True, slots=True)
class Entry:
    """Where a loop begins: a mark to go back to, used lengths, and the variables and lanes that the loop changes."""

    mark: int
    used: tuple[Linear, ...]
    variables: dict[str, Typed]
    lanes: set[int]


def walk_rounds(scope: Scope, loop: Loop, dropped: set[Guess]) -> None:
    """Walk any round of a loop, and go to the place after it, with the same guesses known."""
    names = changed_names(loop.body)
    variables = {name: scope.locals[name] for name in sorted(names & scope.locals.keys())}
    at_entry = Entry(scope.mark(), scope.used, variables, advanced_lanes(loop.body))
    kept = [guess for guess in (*guesses(scope, names), *counted(loop, scope)) if guess not in dropped]
    while True:
        written = 0 if scope.record is None else scope.record.mark()
        lost = _round(scope, loop, at_entry, kept)
        scope.rollback(at_entry.mark)
        scope.used = at_entry.used
        if not lost:
            break
        if scope.record is not None:
            scope.record.retract(written)
        dropped.update(lost)
        kept = [guess for guess in kept if guess not in dropped]
    if scope.record is not None:
        first = [instance(scope, guess, at_entry.variables[guess.name], _now(scope, guess), ZERO) for guess in kept]
        scope.record.owe_all(first, claims.RELATION_FIRST)
    forget(scope, at_entry, kept)
    assume_counted(scope, at_entry, kept, loop.count)


def _round(scope: Scope, loop: Loop, at_entry: Entry, kept: list[Guess]) -> list[Guess]:
    """Walk one round; returns the guesses that it breaks."""
    facts = scope.facts
    mark, first_atom = facts.mark(), len(facts.lows)
    forget(scope, at_entry, kept)
    loop.enter(first_atom)
    index = linear(scope.locals[loop.variable][1]) if loop.variable else ZERO
    assume_counted(scope, at_entry, kept, index)
    lost: list[Guess] = []
    if not loop.walk() and not facts.impossible:
        loop.leave()
        behind = shifted(index, 1)
        claimed = [(guess, instance(scope, guess, at_entry.variables[guess.name], _now(scope, guess), behind)) for guess in kept]
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
    return Any((within, minus(scope.end, measure), *fixed))


def _conjuncts(formula: Formula) -> list[Linear]:
    match formula:
        case Linear():
            return [formula]
        case All(parts):
            return [conjunct for part in parts for conjunct in _conjuncts(part)]
        case _:
            return []


def needless(body: Block, said: Iterable[Expr], measure: Expr | None, known: Container[str], made: dict[int, list[Made]]) -> set[Guess]:
    """That a variable does not fall below its first value, where a loop sets it to what is not made of that, or says what it keeps.

    What grows in each round is tried all the same: a loop around this one may grow by it. ``made`` keeps what statements make,
    and those inside them, by their ids: those of a loop are asked for again by each loop around it.
    """
    variables = {name for name in changed_names(body) if name in known}
    named = {name for expr in said for name in locals_in(expr)} - (set[str]() if measure is None else locals_in(measure))
    found = variables & named
    if variables - named:
        found |= _not_made_of_themselves(body, variables - named, made)
    return {Guess(name, 2, 1) for name in found}


def _not_made_of_themselves(body: Block, names: set[str], made: dict[int, list[Made]]) -> set[str]:
    """Of some variables those that a loop sets to what is not computed from them."""
    users: dict[str, set[str]] = {}
    assigned: dict[str, list[set[str]]] = {name: [] for name in names}
    for targets, read, is_assigned in _all_made(body, made):
        if is_assigned and targets[0] in names:
            assigned[targets[0]].append(read)
        for name in read:
            known = users.get(name)
            if known is None:
                users[name] = set(targets)
            else:
                known.update(targets)
    return {name for name in names if not all(map(_made_of(name, users).intersection, assigned[name]))}


def _all_made(body: Block, made: dict[int, list[Made]]) -> list[Made]:
    """What the statements of a block give values to, and those inside."""
    found: list[Made] = []
    for stmt in body:
        known = made.get(id(stmt))
        if known is None:
            known = made[id(stmt)] = [*_made(stmt), *(each for block in blocks_of(stmt) for each in _all_made(block, made))]
        found += known
    return found


def _made(stmt: Stmt) -> list[Made]:
    is_assigned = isinstance(stmt, Assign)
    targets = (stmt.name,) if is_assigned else bound_names(stmt)
    return [(targets, set[str]().union(*map(_computed_from, expressions_of(stmt))), is_assigned)] if targets else []


def _computed_from(expr: Expr) -> set[str]:
    """The locals that a value is computed from. What memory holds says nothing of the place where it was read."""
    parts = [expr]
    for part in parts:  # which grows
        if type(part) not in READS:
            parts += operands(part)
    return {part.name for part in parts if type(part) is Local}


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
    return {stmt.lane for stmt in flat(body) if type(stmt) is Advance}


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
        found += [guess for guess in wanted if scope.facts.proves(instance(scope, guess, (type_, value), value, ZERO))]
    return found


def counted(loop: Loop, scope: Scope) -> list[Guess]:
    """How far variables may get to which each round adds an integer of few bits, in a loop that runs no negative number of times."""
    if not loop.variable:
        return []
    named = {stmt.name: stmt.value for stmt in _once(loop.body) if isinstance(stmt, Let)}
    often = Counter([stmt.name for stmt, _ in statements(loop.body) if isinstance(stmt, Assign)])
    found: list[Guess] = []
    for stmt in _once(loop.body):
        added = _added(stmt.value, stmt.name, named) if isinstance(stmt, Assign) and often[stmt.name] == 1 else None
        if added is None or not isinstance(stmt, Assign) or not _is_integer(scope.locals.get(stmt.name)):
            continue
        low, high = added
        found += [Guess(stmt.name, ROUNDS, -1, high), *([Guess(stmt.name, ROUNDS, 1, low)] if low < 0 else [])]
    return found if found and scope.facts.proves(loop.count) else []


def _is_integer(known: Typed | None) -> bool:
    return known is not None and known[0] == "i64" and isinstance(known[1], Linear)


def _once(body: Block) -> Iterator[Stmt]:
    """The statements that run once in a round at most."""
    for stmt in body:
        yield stmt
        if isinstance(stmt, If):
            yield from _once((*stmt.then, *stmt.otherwise))


def _added(value: Expr, name: str, named: Mapping[str, Expr]) -> tuple[int, int] | None:
    """The least and the most that a value is beyond that of a variable, where it is a sum with it."""
    match _written(value, named):
        case Binary("add", Local("i64", first), step) if first == name:
            return _range(_written(step, named), named)
        case _:
            return None


def _range(value: Expr, named: Mapping[str, Expr]) -> tuple[int, int] | None:
    """The bounds of an integer of few bits."""
    match value:
        case Const(value=int(number)) if abs(number) <= 1:
            return int(number), int(number)
        case Select(_, then, otherwise):
            ranges = [_range(_written(each, named), named) for each in (then, otherwise)]
            known = [each for each in ranges if each is not None]
            return (min(low for low, _ in known), max(high for _, high in known)) if len(known) == len(ranges) else None
        case Convert(_, operand) if (type_ := type_of(operand)) not in FLOATS and (type_ == "bool" or WIDTH[type_] <= FEW_BYTES):
            return (0, 1) if type_ == "bool" else limits(type_)
        case _:
            return None


def _written(value: Expr, named: Mapping[str, Expr]) -> Expr:
    """What a name was given, for a name."""
    return named.get(value.name, value) if isinstance(value, Local) else value


def instance(scope: Scope, guess: Guess, at_entry: Typed, value: Linear, rounds: Linear) -> Linear:
    """A guess about a value, as a fact; ``at_entry`` is the variable before the first round, and so many ``rounds`` were before."""
    counts = guess.anchor == ROUNDS
    mark = plus(linear(at_entry[1]), times(rounds, guess.step)) if counts else anchors(scope, at_entry)[guess.anchor]
    return times(minus(value, mark), guess.sign)


def assume_counted(scope: Scope, at_entry: Entry, kept: list[Guess], rounds: Linear) -> None:
    """The guesses about what rounds count, where there were so many before."""
    for guess in kept:
        if guess.anchor == ROUNDS:
            scope.facts.assume(instance(scope, guess, at_entry.variables[guess.name], _now(scope, guess), rounds))


def _now(scope: Scope, guess: Guess) -> Linear:
    return linear(scope.locals[guess.name][1])


def forget(scope: Scope, at_entry: Entry, kept: list[Guess]) -> None:
    """Go to the head of some round: what the loop changes is unknown but for the guesses."""
    for name, (type_, old) in at_entry.variables.items():
        if type_ == "bool" or type_ in FLOATS:
            scope.bind(name, (type_, None))
        else:
            scope.bind(name, (type_, variable(scope, type_, relative=from_begin(linear(old)))))
    for guess in kept:
        if guess.anchor != ROUNDS:
            scope.facts.assume(instance(scope, guess, at_entry.variables[guess.name], _now(scope, guess), ZERO))
    for lane in sorted(at_entry.lanes):
        scope.use(lane, grown(scope, lane, at_entry.used[lane]))
