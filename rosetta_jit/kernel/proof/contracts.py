"""What a routine may rely on and what its callers may: the two sides of its contract, for the proof."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Routine
from rosetta_jit.kernel.nodes import Call
from rosetta_jit.kernel.proof import claims
from rosetta_jit.kernel.proof.linear import Linear
from rosetta_jit.kernel.proof.obligations import UnprovenError, demand, oblige
from rosetta_jit.kernel.proof.paths import from_begin, variable
from rosetta_jit.kernel.proof.scope import Scope, entry
from rosetta_jit.kernel.proof.symbolic import condition, evaluate, unknown
from rosetta_jit.kernel.rewrite import locals_in

if TYPE_CHECKING:
    from rosetta_jit.kernel.proof.record import Record

MESSAGE = ("begin", "end")
"""What every routine sees of its caller."""


def inside(strides: tuple[int, ...], routine: Routine, record: Record | None) -> Scope:
    """The scope at the start of a routine: any arguments that it allows."""
    scope = entry(strides, record)
    scope.locals = {name: scope.locals[name] for name in MESSAGE}
    for parameter in routine.parameters:
        scope.locals[parameter.name] = parameter.type, unknown(scope, parameter.type)
    for required in routine.requires:
        scope.facts.assume(condition(scope, required))
    return scope


def keep(scope: Scope, routine: Routine) -> None:
    """Prove at the end of a routine's body what its callers rely on."""
    for result in routine.results:
        demand(result.name in scope.locals and scope.locals[result.name][0] == result.type, f"no {result.type} {result.name}")
    for ensured in routine.ensures:
        oblige(scope, condition(scope, ensured), claims.PROMISE)


def bind(scope: Scope, routine: Routine, call: Call) -> None:
    """Prove what a call owes, and bind its results.

    A result of type i64 is a position if an argument is one, and the routine promises something of it: it is kept as a distance from
    `begin`. One without a promise is a number that was read, and may be multiplied.
    """
    locals_ = {name: scope.locals[name] for name in MESSAGE}
    inner = Scope(scope.strides, scope.begin, scope.end, scope.facts, locals_, scope.used, scope.capacity, scope.record)
    for parameter, argument in zip(routine.parameters, call.arguments, strict=True):
        inner.locals[parameter.name] = typed = evaluate(scope, argument)
        if typed[0] != parameter.type:
            raise UnprovenError(f"{typed[0]} where {parameter.type} belongs")
    for required in routine.requires:
        oblige(inner, condition(inner, required), claims.DEMANDS)
    moves = any(isinstance(value, Linear) and from_begin(value) for _, value in (inner.locals[p.name] for p in routine.parameters))
    for result in routine.results:
        is_position = moves and result.type == "i64" and any(result.name in locals_in(ensured) for ensured in routine.ensures)
        inner.locals[result.name] = result.type, variable(scope, result.type, relative=is_position)
    for ensured in routine.ensures:
        scope.facts.assume(condition(inner, ensured))
    for local, result in zip(call.results, routine.results, strict=True):
        scope.bind(local.name, inner.locals[result.name])
