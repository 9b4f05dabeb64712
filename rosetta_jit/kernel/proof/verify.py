"""The proof that a kernel is safe, for every message and every holder: a symbolic run over all its paths.

Where the obligations come from: `symbolic` (accesses and arithmetic in expressions), this module (statements), `paths` (what
survives where paths meet), `contracts` (routines), `shape` (the text). A failed proof is a bug of ours, never a user's mistake.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.arithmetic import limits
from rosetta_jit.kernel.limits import MAX_PROOFS, MAX_TERMS
from rosetta_jit.kernel.proof import claims, effects, paths
from rosetta_jit.kernel.proof.formula import All, Formula, equal, negated
from rosetta_jit.kernel.proof.known import once
from rosetta_jit.kernel.proof.linear import Linear, minus, plus, shifted
from rosetta_jit.kernel.proof.obligations import UnprovenError, demand, oblige
from rosetta_jit.kernel.proof.scope import Scope, Typed, entry
from rosetta_jit.kernel.proof.symbolic import condition, evaluate, integer, linear
from rosetta_jit.kernel.routines import called_routines, named_lanes
from rosetta_jit.kernel.shape import shape_error
from rosetta_jit.startup.dataclass import dataclass, field
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.kernel.proof import contracts, loops
    from rosetta_jit.kernel.proof.loops import Guess, Made
    from rosetta_jit.kernel.proof.record import Record
else:
    contracts, loops = late("rosetta_jit.kernel.proof", "contracts", "loops")


class VerificationError(AssertionError):
    """A kernel that could not be proven safe."""


@dataclass(slots=True)
class _Walk:
    """One body's walk: where it is, in how many loops of each kind, and what it has found out about loops and checks, by their ids."""

    scope: Scope
    routines: Mapping[str, ir.Routine]
    notes: bool = False
    tries_all: bool = False
    fors: int = 0
    whiles: int = 0
    variables: set[str] = field(default_factory=set[str])
    dropped: dict[int, set[Guess]] = field(default_factory=dict[int, "set[Guess]"])
    seen: dict[int, nodes.Stmt] = field(default_factory=dict[int, "nodes.Stmt"])
    needed: set[int] = field(default_factory=set[int])
    made: dict[int, list[Made]] = field(default_factory=dict[int, "list[Made]"])


def verify(kernel: ir.Kernel, record: Record | None = None) -> None:
    """Prove a kernel, and write down what it owes in a record, if there is one.

    Raises
    ------
    VerificationError
        Something in it cannot be shown to be safe; the message names the statement.
    """
    check_shape(kernel)
    routines = _proven_routines(kernel, record)
    for number, body in enumerate(kernel.bodies):
        if record is not None:
            record.begin(f"body {number + 1}" if len(kernel.bodies) > 1 else "", kernel.sites)
        _body(kernel, body, routines, record)


def settled(kernel: ir.Kernel) -> frozenset[int]:
    """The ids of Require and Expect statements that cannot fail wherever they stand, and of Ifs that always choose their first block.

    The kernel's shape is sound.

    Raises
    ------
    VerificationError
        As `verify`.
    """
    found: set[int] = set()
    needed: set[int] = set()
    routines = _proven_routines(kernel)
    for body in kernel.bodies:
        walk = _body(kernel, body, routines, notes=True)
        found |= walk.seen.keys()
        needed |= walk.needed
    return frozenset(found - needed)


def check_shape(kernel: ir.Kernel) -> None:
    """Refuse a kernel whose text is not sound: VerificationError."""
    problem = shape_error(kernel)
    if problem is not None:
        raise VerificationError(f"kernel {kernel.name}: {problem}")


def _proven_routines(kernel: ir.Kernel, record: Record | None = None) -> Mapping[str, ir.Routine]:
    """The routines of a kernel of sound shape, proven."""
    known: dict[str, ir.Routine] = {}
    for routine in kernel.routines:
        try:
            if record is None:
                called = tuple(known[each] for each in called_routines(routine.body))
                _prove_routine(_strides_of(kernel.strides, (routine, *called)), routine, called)
            else:
                record.begin(f"routine {routine.name}", routine.sites)
                _routine(kernel.strides, routine, tuple(known.values()), record)
        except UnprovenError as error:
            raise VerificationError(f"kernel {kernel.name}, routine {routine.name}: {error}") from error
        known[routine.name] = routine
    return known


def _strides_of(strides: tuple[int, ...], routines: tuple[ir.Routine, ...]) -> tuple[int, ...]:
    """The strides that a proof of routines depends on: rows of lanes that they do not name have no bytes, in which nothing is proven.

    So one proof holds for kernels of many holders.
    """
    named = {lane for routine in routines for lane in named_lanes(routine)}
    return tuple(stride if lane in named else 0 for lane, stride in enumerate(strides[: max(named, default=-1) + 1]))


@lru_cache(maxsize=MAX_PROOFS)
def _prove_routine(strides: tuple[int, ...], routine: ir.Routine, called: tuple[ir.Routine, ...]) -> None:
    """Prove a routine, which calls others. No pass changes one, so that a proof holds for all rounds of all passes."""
    once((strides, routine, called), lambda: _routine(strides, routine, called, None))


def _routine(strides: tuple[int, ...], routine: ir.Routine, before: tuple[ir.Routine, ...], record: Record | None) -> None:
    walk = _Walk(contracts.inside(strides, routine, record), {each.name: each for each in before})
    _block(walk, routine.body)
    contracts.keep(walk.scope, routine)


def _body(
    kernel: ir.Kernel, body: nodes.Block, routines: Mapping[str, ir.Routine], record: Record | None = None, *, notes: bool = False
) -> _Walk:
    """The walk of a body: with the guesses about its loops that are mostly enough or, where it is not proven with them, with all."""
    written = 0 if record is None else record.mark()
    walk = _Walk(entry(kernel.strides, record), routines, notes)
    try:
        _whole(walk, body)
    except UnprovenError:
        if record is not None:
            record.retract(written)
        walk = _Walk(entry(kernel.strides, record), routines, notes, tries_all=True)
        try:
            _whole(walk, body)
        except UnprovenError as error:
            raise VerificationError(f"kernel {kernel.name}: {error}") from error
    return walk


def _whole(walk: _Walk, body: nodes.Block) -> None:
    if not _block(walk, body):
        oblige(walk.scope, formula=False, claim=claims.RETURNS)


def _block(walk: _Walk, block: nodes.Block) -> bool:
    """Walk a block; True when every path through it has returned."""
    record = walk.scope.record
    outer = None if record is None else record.stmt
    ended = False
    for number, stmt in enumerate(block):
        if record is not None:
            record.stmt = stmt
        try:
            ended = _statement(walk, stmt)
        except UnprovenError as error:
            raise _named(error, stmt) from error.__cause__
        if ended:
            demand(number == len(block) - 1, "statements after the end of their path")
    if record is not None:
        record.stmt = outer
    return ended


def _named(error: UnprovenError, stmt: nodes.Stmt) -> UnprovenError:
    """The error with the innermost statement's text."""
    from rosetta_jit.kernel.printer import statement_text

    return error if "\n" in str(error) else UnprovenError(f"{error}\n  in: {statement_text(stmt)}")


# --- statements --------------------------------------------------------------------------------------------------------


def _statement(walk: _Walk, stmt: nodes.Stmt) -> bool:
    scope = walk.scope
    match stmt:
        case nodes.Require(at, size, failure):
            start, length = integer(scope, at), integer(scope, size)
            effects.failure(scope, failure)
            _check(walk, stmt, All((start, length, minus(minus(scope.end, start), length))))
        case nodes.Expect(expr, failure):
            effects.failure(scope, failure)
            _check(walk, stmt, condition(scope, expr))
        case nodes.Let(name, value) | nodes.Var(name, value):
            scope.bind(name, _value(scope, value))
            if isinstance(stmt, nodes.Var):
                walk.variables.add(name)
        case nodes.Assign(name, value):
            demand(name in walk.variables and name in scope.locals, f"{name} is no variable")
            new = _value(scope, value)
            demand(new[0] == scope.locals[name][0], f"{name} is no {new[0]}")
            scope.bind(name, new)
        case nodes.Return(position, registers):
            for _, value in registers:
                integer(scope, value)
            oblige(scope, integer(scope, position), claims.POSITION)
            return True
        case nodes.Store() | nodes.SetField() | nodes.Copy() | nodes.Fill():
            effects.move(scope, stmt)
        case nodes.Reserve() | nodes.Advance():
            effects.rows(scope, stmt)
        case nodes.For() | nodes.While() | nodes.If() | nodes.Switch():
            return _nested(walk, stmt)
        case nodes.Call(routine, _, _, _, indices):
            for position in indices:
                integer(scope, position)
            contracts.bind(scope, walk.routines[routine], stmt)
        case nodes.HostCall():
            effects.host_call(scope, stmt)
        case _:
            assert_never(stmt)
    return False


def _check(walk: _Walk, stmt: nodes.Require | nodes.Expect, formula: Formula) -> None:
    """A check holds from here on."""
    _note(walk, stmt, formula)
    walk.scope.facts.assume(formula)


def _note(walk: _Walk, stmt: nodes.Require | nodes.Expect | nodes.If, formula: Formula) -> None:
    """Note whether a condition is known before it is asked.

    Only in a loop is that worth a proof, and in one that goes through a message a short one. Elsewhere a check costs little, and what it
    says saves proofs of what follows from it.
    """
    if not walk.notes:
        return
    key, facts = id(stmt), walk.scope.facts
    walk.seen[key] = stmt
    knows = facts.proves if walk.fors else facts.adds_up if walk.whiles else facts.shows
    if key not in walk.needed and not knows(formula):
        walk.needed.add(key)


def _value(scope: Scope, expr: nodes.Expr) -> Typed:
    type_, value = evaluate(scope, expr)
    if isinstance(value, Linear) and len(value.terms) > MAX_TERMS:
        return type_, _shortened(scope, value)
    return type_, value


def _shortened(scope: Scope, value: Linear) -> Linear:
    """An atom for a long sum, `begin` kept apart."""
    facts = scope.facts
    origin = scope.begin if paths.from_begin(value) else Linear(0)
    rest = minus(value, origin)
    low = facts.lower(rest)
    if low < 0 and facts.proves(rest):  # what its parts say together, which bounds of each do not
        low = 0
    atom = facts.abbreviated(rest, low, facts.upper(rest))
    paths.learn_distance(scope, minus(minus(scope.end, origin), atom), facts.lower(minus(scope.end, value)))
    return plus(origin, atom)


# --- branches and loops ------------------------------------------------------------------------------------------------


def _nested(walk: _Walk, stmt: nodes.For | nodes.While | nodes.If | nodes.Switch) -> bool:
    match stmt:
        case nodes.If(expr, then, otherwise):
            chosen = condition(walk.scope, expr)
            _note(walk, stmt, chosen)
            ways: list[tuple[Formula, nodes.Block]] = [(chosen, then), (negated(chosen), otherwise)]
        case nodes.Switch():
            ways = _cases(walk.scope, stmt)
        case nodes.For():
            _for(walk, stmt)
            return False
        case nodes.While():
            _while(walk, stmt)
            return False
        case _:
            assert_never(stmt)
    return paths.branch(walk.scope, [(formula, partial(_block, walk, block)) for formula, block in ways])


def _cases(scope: Scope, stmt: nodes.Switch) -> list[tuple[Formula, nodes.Block]]:
    numbers = [number for number, _ in stmt.cases]
    demand(len(set(numbers)) == len(numbers), "a case that stands twice")
    type_, value = evaluate(scope, stmt.value)
    demand(type_ != "bool", "a switch on a bool")
    subject = linear(value)
    low, high = limits(type_)
    demand(all(low <= number <= high for number in numbers), f"a case that is no {type_}")
    no_case = All(tuple(negated(equal(subject, Linear(number))) for number in sorted(numbers)))
    return [*((equal(subject, Linear(number)), block) for number, block in stmt.cases), (no_case, stmt.default)]


def _for(walk: _Walk, loop: nodes.For) -> None:
    scope = walk.scope
    count = integer(scope, loop.count)

    def enter(_first_atom: int) -> None:
        index = scope.facts.fresh(0, max(0, scope.facts.upper(count) - 1))
        scope.facts.assume(shifted(minus(count, index), -1))
        scope.bind(loop.variable, ("i64", index))

    walk.fors += 1
    _rounds(walk, loop, enter, lambda: None, count)
    walk.fors -= 1


def _while(walk: _Walk, loop: nodes.While) -> None:
    scope = walk.scope
    at_start: list[Linear] = []

    def enter(first_atom: int) -> None:
        _assume_invariant(scope, loop)
        before, chosen = integer(scope, loop.measure), condition(scope, loop.condition)
        scope.facts.assume(chosen)
        oblige(scope, loops.bounds(scope, before, chosen, first_atom), claims.BOUNDED)
        at_start.append(before)

    def leave() -> None:
        oblige(scope, shifted(minus(integer(scope, loop.measure), at_start[-1]), -1), claims.PROGRESS)
        for expr in loop.invariant:
            oblige(scope, condition(scope, expr), claims.INVARIANT_KEPT)

    for expr in loop.invariant:
        oblige(scope, condition(scope, expr), claims.INVARIANT_FIRST)
    walk.whiles += 1
    _rounds(walk, loop, enter, leave)
    walk.whiles -= 1
    _assume_invariant(scope, loop)
    scope.facts.assume(negated(condition(scope, loop.condition)))


def _assume_invariant(scope: Scope, loop: nodes.While) -> None:
    for expr in loop.invariant:
        scope.facts.assume(condition(scope, expr))


def _rounds(
    walk: _Walk, loop: nodes.For | nodes.While, enter: Callable[[int], None], leave: Callable[[], None], count: Linear = paths.ZERO
) -> None:
    dropped = walk.dropped.get(id(loop))
    if dropped is None:
        said, measure = (loop.invariant, loop.measure) if isinstance(loop, nodes.While) else ((), None)
        dropped = walk.dropped[id(loop)] = (
            set() if walk.tries_all else loops.needless(loop.body, said, measure, walk.scope.locals, walk.made)
        )
    variable = loop.variable if isinstance(loop, nodes.For) else ""
    loops.walk_rounds(walk.scope, loops.Loop(loop.body, enter, partial(_block, walk, loop.body), leave, variable, count), dropped)
