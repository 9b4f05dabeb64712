"""What statements owe that change something: the message, a lane, or how many of its rows are in use."""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.kernel.limits import MAX_ROWS, MAX_USED_TERMS
from rosetta_jit.kernel.nodes import WIDTH, Advance, Copy, Failure, Fill, HostCall, Place, Reserve, SetField, Store, Wire
from rosetta_jit.kernel.proof import claims
from rosetta_jit.kernel.proof.formula import All, Any
from rosetta_jit.kernel.proof.linear import Linear, minus, plus
from rosetta_jit.kernel.proof.obligations import demand, oblige
from rosetta_jit.kernel.proof.scope import Scope
from rosetta_jit.kernel.proof.symbolic import check_extent, check_field, check_lane, check_wire, evaluate, integer, unknown


def failure(scope: Scope, what: Failure) -> None:
    """What a failure reports can be computed."""
    integer(scope, what.at)
    for position in what.indices:
        integer(scope, position)


def move(scope: Scope, stmt: Store | SetField | Copy | Fill) -> None:
    """What is moved lies in the message or in a lane."""
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
        oblige(scope, apart, claims.APART)


def host_call(scope: Scope, call: HostCall) -> None:
    """What a function of the host reads and fills lies in the message or in a lane."""
    for argument in call.arguments:
        evaluate(scope, argument)
    failure(scope, call.failure)
    filled = None if call.target is None else check_extent(scope, call.target.address, integer(scope, call.target.size))
    for extent in call.inputs:
        begin, size = check_extent(scope, extent.address, integer(scope, extent.size)), integer(scope, extent.size)
        if filled is not None and call.target is not None and _same_memory(extent.address, call.target.address):
            apart = Any((minus(minus(filled, begin), size), minus(minus(begin, filled), integer(scope, call.target.size))))
            oblige(scope, apart, claims.FILLED_APART)
    scope.bind(call.result.name, (call.result.type, unknown(scope, call.result.type)))


def _same_memory(one: Place | Wire, other: Place | Wire) -> bool:
    return isinstance(one, Wire) == isinstance(other, Wire) and getattr(one, "lane", None) == getattr(other, "lane", None)


def rows(scope: Scope, stmt: Reserve | Advance) -> None:
    """Rows are taken that were reserved."""
    check_lane(scope, stmt.lane)
    count = integer(scope, stmt.count)
    oblige(scope, count, claims.ROW_COUNT)
    used, capacity = scope.used[stmt.lane], scope.capacity[stmt.lane]
    room = minus(minus(capacity, used), count)
    if isinstance(stmt, Reserve):
        scope.facts.assume(room)
        return
    oblige(scope, room, claims.RESERVED)
    after = plus(used, count)
    if len(after.terms) > MAX_USED_TERMS:
        after = scope.facts.abbreviated(after, scope.facts.lower(used), MAX_ROWS)
        scope.facts.derive(All((minus(capacity, after), minus(after, used))))
    scope.use(stmt.lane, after)
