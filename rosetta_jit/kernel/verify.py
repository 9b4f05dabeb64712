"""The proof that a kernel is safe, for every message and every holder: a symbolic run over all its paths.

Where the obligations come from: `symbolic` (accesses and arithmetic in expressions), this module (statements), `paths` (what
survives where paths meet), `contracts` (routines), `shape` (the text). A failed proof is a bug of ours, never a user's mistake.
"""

from __future__ import annotations

from dataclasses import field
from functools import lru_cache, partial
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.dataclass import dataclass
from rosetta_jit.kernel import contracts, paths
from rosetta_jit.kernel.ir import (
    WIDTH,
    Advance,
    Assign,
    Call,
    Copy,
    Expect,
    Fill,
    For,
    HostCall,
    If,
    Let,
    Place,
    Require,
    Reserve,
    Return,
    SetField,
    Store,
    Switch,
    Var,
    While,
    Wire,
)
from rosetta_jit.kernel.linear import Linear, minus, plus, shifted
from rosetta_jit.kernel.loops import Loop, is_bounded, walk_rounds
from rosetta_jit.kernel.printer import statement_text
from rosetta_jit.kernel.prove import All, Any, equal, negated
from rosetta_jit.kernel.shape import shape_error
from rosetta_jit.kernel.symbolic import (
    MAX_ROWS,
    Scope,
    UnprovenError,
    check_extent,
    check_field,
    check_lane,
    check_wire,
    condition,
    demand,
    entry,
    evaluate,
    integer,
    linear,
    oblige,
    unknown,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rosetta_jit.kernel.ir import Block, Expr, Failure, Kernel, Routine, Stmt
    from rosetta_jit.kernel.loops import Guess
    from rosetta_jit.kernel.prove import Formula
    from rosetta_jit.kernel.symbolic import Typed

MAX_PROOFS = 256
"""Routines of which it is remembered that they were proven."""

MAX_TERMS = 6
"""A longer sum gets a name: sums over many fields would cost more with each field."""

MAX_USED_TERMS = 2
"""A used length of more terms gets a name: what is known of it, and asked, would cost more with each text that is put together."""


class VerificationError(AssertionError):
    """A kernel that could not be proven safe."""


@dataclass(slots=True)
class _Walk:
    """One body's walk: where it is, and what it has found out about loops and checks, by the ids of their statements."""

    scope: Scope
    routines: Mapping[str, Routine]
    notes: bool = False
    loops: int = 0
    variables: set[str] = field(default_factory=set[str])
    dropped: dict[int, set[Guess]] = field(default_factory=dict[int, "set[Guess]"])
    seen: dict[int, Stmt] = field(default_factory=dict[int, "Stmt"])
    needed: set[int] = field(default_factory=set[int])


def verify(kernel: Kernel) -> None:
    """Prove a kernel.

    Raises
    ------
    VerificationError
        Something in it cannot be shown to be safe; the message names the statement.
    """
    routines = _proven_routines(kernel)
    for body in kernel.bodies:
        _body(_Walk(entry(kernel.strides), routines), kernel, body)


def settled(kernel: Kernel) -> frozenset[int]:
    """The ids of Require and Expect statements that cannot fail wherever they stand, and of Ifs that always choose their first block.

    Raises
    ------
    VerificationError
        As `verify`.
    """
    found: set[int] = set()
    needed: set[int] = set()
    routines = _proven_routines(kernel)
    for body in kernel.bodies:
        walk = _Walk(entry(kernel.strides), routines, notes=True)
        _body(walk, kernel, body)
        found |= walk.seen.keys()
        needed |= walk.needed
    return frozenset(found - needed)


def _proven_routines(kernel: Kernel) -> Mapping[str, Routine]:
    """The routines of a kernel of sound shape, proven."""
    problem = shape_error(kernel)
    if problem is not None:
        raise VerificationError(f"kernel {kernel.name}: {problem}")
    for number, routine in enumerate(kernel.routines):
        try:
            _prove_routine(kernel.strides, routine, kernel.routines[:number])
        except UnprovenError as error:
            raise VerificationError(f"kernel {kernel.name}, routine {routine.name}: {error}") from error
    return {routine.name: routine for routine in kernel.routines}


@lru_cache(maxsize=MAX_PROOFS)
def _prove_routine(strides: tuple[int, ...], routine: Routine, before: tuple[Routine, ...]) -> None:
    """Prove a routine, which calls those before it. No pass changes one, so that a proof holds for all rounds of all passes."""
    walk = _Walk(contracts.inside(strides, routine), {each.name: each for each in before})
    _block(walk, routine.body)
    contracts.keep(walk.scope, routine)


def _body(walk: _Walk, kernel: Kernel, body: Block) -> None:
    try:
        ended = _block(walk, body)
        demand(ended or walk.scope.facts.impossible, "a path ends without Return")
    except UnprovenError as error:
        raise VerificationError(f"kernel {kernel.name}: {error}") from error


def _block(walk: _Walk, block: Block) -> bool:
    """Walk a block; True when every path through it has returned."""
    for number, stmt in enumerate(block):
        try:
            ended = _statement(walk, stmt)
        except UnprovenError as error:
            raise _named(error, stmt) from error.__cause__
        if ended:
            demand(number == len(block) - 1, "statements after the end of their path")
            return True
    return False


def _named(error: UnprovenError, stmt: Stmt) -> UnprovenError:
    """The error with the innermost statement's text."""
    return error if "\n" in str(error) else UnprovenError(f"{error}\n  in: {statement_text(stmt)}")


# --- statements --------------------------------------------------------------------------------------------------------


def _statement(walk: _Walk, stmt: Stmt) -> bool:
    scope = walk.scope
    match stmt:
        case Require(at, size, failure):
            start, length = integer(scope, at), integer(scope, size)
            _failure(scope, failure)
            _check(walk, stmt, All((start, length, minus(minus(linear(scope.locals["end"][1]), start), length))))
        case Expect(expr, failure):
            _failure(scope, failure)
            _check(walk, stmt, condition(scope, expr))
        case Let(name, value) | Var(name, value):
            scope.bind(name, _value(scope, value))
            if isinstance(stmt, Var):
                walk.variables.add(name)
        case Assign(name, value):
            demand(name in walk.variables and name in scope.locals, f"{name} is no variable")
            new = _value(scope, value)
            demand(new[0] == scope.locals[name][0], f"{name} is no {new[0]}")
            scope.bind(name, new)
        case Return(position):
            oblige(scope, integer(scope, position), "a position that may be negative")
            return True
        case Store() | SetField() | Copy() | Fill():
            _effect(scope, stmt)
        case Reserve() | Advance():
            _rows(scope, stmt)
        case For() | While() | If() | Switch():
            return _nested(walk, stmt)
        case Call(routine, _, _, _, indices):
            for position in indices:
                integer(scope, position)
            contracts.bind(scope, walk.routines[routine], stmt)
        case HostCall():
            _host_call(scope, stmt)
        case _:
            assert_never(stmt)
    return False


def _check(walk: _Walk, stmt: Require | Expect, formula: Formula) -> None:
    """A check holds from here on."""
    _note(walk, stmt, formula)
    walk.scope.facts.assume(formula)


def _note(walk: _Walk, stmt: Require | Expect | If, formula: Formula) -> None:
    """Note whether a condition is known before it is asked.

    Only in a loop is that worth a proof. Elsewhere a check costs little, and what it says saves proofs of what follows from it.
    """
    if not walk.notes:
        return
    key, facts = id(stmt), walk.scope.facts
    walk.seen[key] = stmt
    if key not in walk.needed and not (facts.proves(formula) if walk.loops else facts.shows(formula)):
        walk.needed.add(key)


def _failure(scope: Scope, failure: Failure) -> None:
    integer(scope, failure.at)
    for position in failure.indices:
        integer(scope, position)


def _value(scope: Scope, expr: Expr) -> Typed:
    type_, value = evaluate(scope, expr)
    if isinstance(value, Linear) and len(value.terms) > MAX_TERMS:
        return type_, _shortened(scope, value)
    return type_, value


def _shortened(scope: Scope, value: Linear) -> Linear:
    """An atom for a long sum, `begin` kept apart."""
    facts = scope.facts
    begin, end = linear(scope.locals["begin"][1]), linear(scope.locals["end"][1])
    origin = begin if paths.from_begin(value) else Linear(0)
    rest = minus(value, origin)
    low = facts.lower(rest)
    if low < 0 and facts.proves(rest):  # what its parts say together, which bounds of each do not
        low = 0
    atom = facts.fresh(low, facts.upper(rest))
    facts.assume(equal(atom, rest))
    paths.learn_distance(scope, minus(minus(end, origin), atom), facts.lower(minus(end, value)))
    return plus(origin, atom)


def _effect(scope: Scope, stmt: Store | SetField | Copy | Fill) -> None:
    match stmt:
        case Store(at, value, _):
            type_, _ = evaluate(scope, value)
            check_wire(scope, integer(scope, at), Linear(WIDTH[type_]))
        case SetField(place, value):
            check_field(scope, place, evaluate(scope, value)[0])
        case Copy(target, source, size):
            _copy(scope, target, source, integer(scope, size))
        case Fill(target, size, byte):
            demand(0 <= byte <= 255, f"{byte} is no byte")
            check_extent(scope, target, integer(scope, size))
        case _:
            assert_never(stmt)


def _copy(scope: Scope, target: Place | Wire, source: Place | Wire, size: Linear) -> None:
    into, out_of = check_extent(scope, target, size), check_extent(scope, source, size)
    demand(isinstance(target, Place) or isinstance(source, Place), "a copy within the message")
    if isinstance(target, Place) and isinstance(source, Place) and target.lane == source.lane:
        apart = Any((minus(minus(out_of, into), size), minus(minus(into, out_of), size)))
        oblige(scope, apart, "a copy onto itself")


def _host_call(scope: Scope, call: HostCall) -> None:
    for argument in call.arguments:
        evaluate(scope, argument)
    _failure(scope, call.failure)
    filled = None if call.target is None else check_extent(scope, call.target.address, integer(scope, call.target.size))
    for extent in call.inputs:
        begin, size = check_extent(scope, extent.address, integer(scope, extent.size)), integer(scope, extent.size)
        if filled is not None and call.target is not None and _same_memory(extent.address, call.target.address):
            apart = Any((minus(minus(filled, begin), size), minus(minus(begin, filled), integer(scope, call.target.size))))
            oblige(scope, apart, "a function that fills what it reads")
    scope.bind(call.result.name, (call.result.type, unknown(scope, call.result.type)))


def _same_memory(one: Place | Wire, other: Place | Wire) -> bool:
    return isinstance(one, Wire) == isinstance(other, Wire) and getattr(one, "lane", None) == getattr(other, "lane", None)


def _rows(scope: Scope, stmt: Reserve | Advance) -> None:
    check_lane(scope, stmt.lane)
    count = integer(scope, stmt.count)
    oblige(scope, count, "a count of rows that may be negative")
    used, capacity = scope.used[stmt.lane], scope.capacity[stmt.lane]
    room = minus(minus(capacity, used), count)
    if isinstance(stmt, Reserve):
        scope.facts.assume(room)
        return
    oblige(scope, room, "rows that were not reserved")
    after = plus(used, count)
    if len(after.terms) > MAX_USED_TERMS:
        atom = scope.facts.fresh(scope.facts.lower(used), MAX_ROWS)
        scope.facts.assume(All((equal(atom, after), minus(capacity, atom), minus(atom, used))))
        after = atom
    scope.used[stmt.lane] = after


# --- branches and loops ------------------------------------------------------------------------------------------------


def _nested(walk: _Walk, stmt: For | While | If | Switch) -> bool:
    match stmt:
        case If(expr, then, otherwise):
            chosen = condition(walk.scope, expr)
            _note(walk, stmt, chosen)
            ways: list[tuple[Formula, Block]] = [(chosen, then), (negated(chosen), otherwise)]
        case Switch():
            ways = _cases(walk.scope, stmt)
        case For():
            _for(walk, stmt)
            return False
        case While():
            _while(walk, stmt)
            return False
        case _:
            assert_never(stmt)
    return paths.branch(walk.scope, [(formula, partial(_block, walk, block)) for formula, block in ways])


def _cases(scope: Scope, stmt: Switch) -> list[tuple[Formula, Block]]:
    numbers = [number for number, _ in stmt.cases]
    demand(len(set(numbers)) == len(numbers), "a case that stands twice")
    type_, value = evaluate(scope, stmt.value)
    demand(type_ != "bool", "a switch on a bool")
    subject = linear(value)
    others = All(tuple(negated(equal(subject, Linear(number))) for number in sorted(numbers)))
    return [*((equal(subject, Linear(number)), block) for number, block in stmt.cases), (others, stmt.default)]


def _for(walk: _Walk, loop: For) -> None:
    scope = walk.scope
    count = integer(scope, loop.count)

    def enter(_first_atom: int) -> None:
        index = scope.facts.fresh(0, max(0, scope.facts.upper(count) - 1))
        scope.facts.assume(shifted(minus(count, index), -1))
        scope.bind(loop.variable, ("i64", index))

    walk.loops += 1
    _rounds(walk, loop, enter, lambda: None)
    walk.loops -= 1


def _while(walk: _Walk, loop: While) -> None:
    scope = walk.scope
    at_start: list[Linear] = []

    def enter(first_atom: int) -> None:
        _assume_invariant(scope, loop)
        before, chosen = integer(scope, loop.measure), condition(scope, loop.condition)
        scope.facts.assume(chosen)
        demand(is_bounded(scope, before, chosen, first_atom), "a loop that nothing bounds")
        at_start.append(before)

    def leave() -> None:
        oblige(scope, shifted(minus(integer(scope, loop.measure), at_start[-1]), -1), "a round that makes no progress")
        for expr in loop.invariant:
            oblige(scope, condition(scope, expr), "an invariant that a round breaks")

    for expr in loop.invariant:
        oblige(scope, condition(scope, expr), "an invariant that does not hold at first")
    _rounds(walk, loop, enter, leave)
    _assume_invariant(scope, loop)
    scope.facts.assume(negated(condition(scope, loop.condition)))


def _assume_invariant(scope: Scope, loop: While) -> None:
    for expr in loop.invariant:
        scope.facts.assume(condition(scope, expr))


def _rounds(walk: _Walk, loop: For | While, enter: Callable[[int], None], leave: Callable[[], None]) -> None:
    dropped = walk.dropped.setdefault(id(loop), set())
    walk_rounds(walk.scope, Loop(loop.body, enter, partial(_block, walk, loop.body), leave), dropped)
