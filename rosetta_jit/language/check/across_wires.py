"""Rules that read several wires: at which messages they run, and what is kept of each wire's last message for those of the others.

At a message of one wire the bytes of the others' are gone. A rule runs there if all that it reads of the others are numbers and bools that
are known without the message at hand: `.odom.x` and `len(.scan.ranges)`, but no text, and no element that a loop chooses. Each of them is
computed when its own message comes, and kept as state. Such a rule waits until every wire that it reads has sent a message, but for
those of which it asks whether one has: what it reads of them is 0 until then.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rosetta_jit.language import typed
from rosetta_jit.language.typed import Expr, FieldStep, Place
from rosetta_jit.language.untouched import asks_arrival, places_read
from rosetta_jit.language.walk import operands, parts
from rosetta_jit.model.types import Bool, Float, Int
from rosetta_jit.startup.dataclass import dataclass

Wires = frozenset[str]
"""Some of the wires of a mapping, by their names."""


@dataclass(frozen=True, slots=True)
class Memory:
    """What is kept of messages: the state variable of each value, and, of each wire, whether a message has come."""

    values: Mapping[Expr, typed.StateVariable]
    arrived: Mapping[str, Expr]


NOTHING_KEPT = Memory({}, {})


def wire_of(place: Place) -> Wires:
    """The wire that a place is of; none of a place of the holder."""
    first = place.steps[0] if place.side == "wire" and place.steps else None
    return frozenset([first.field.name]) if isinstance(first, FieldStep) else frozenset()


def wires_read(exprs: Iterable[Expr]) -> Wires:
    """The wires that expressions read."""
    return frozenset[str]().union(*(wire_of(place) for expr in exprs for place in places_read(expr)))


def asked_for(exprs: Iterable[Expr]) -> Wires:
    """The wires of which expressions ask whether a message has arrived: what reads them does not wait for one."""
    arrivals = [part for expr in exprs for part in parts(expr) if asks_arrival(part)]
    return frozenset[str]().union(*(wire_of(part.place) for part in arrivals if isinstance(part, typed.Has)))


def runs_at(exprs: Iterable[Expr], wires: Wires) -> Wires:
    """At messages of which wires a rule runs that reads several."""
    exprs = tuple(exprs)
    return frozenset(wire for wire in wires if all(_can_be_known(expr, wire, []) for expr in exprs))


def values_of_others(exprs: Iterable[Expr], wires: Wires) -> list[Expr]:
    """What a rule that reads several wires needs to be kept, in the order of the text."""
    found: list[Expr] = []
    exprs = tuple(exprs)
    for wire in sorted(runs_at(exprs, wires)):
        for expr in exprs:
            _can_be_known(expr, wire, found)
    return found


def remembered(expr: Expr, wire: str, memory: Memory) -> Expr | None:
    """What stands for a value of another wire's last message at one of ``wire``; None of what is no such value."""
    found = memory.values.get(expr) if memory.values else None
    return None if found is None or wire in wires_read([expr]) else found


def type_name(expr: Expr) -> str | None:
    """The type of the state variable that can keep a value; None where none can."""
    match expr.type:
        case Bool():
            return "bool"
        case Int(bits, signed):
            return f"{'' if signed else 'u'}int{bits}"
        case Float(bits):
            return f"float{bits}"
        case _:
            return None


def _can_be_known(expr: Expr, wire: str, found: list[Expr]) -> bool:
    """Whether an expression can be computed at a message of ``wire``; what it needs of the others is added to ``found``."""
    read = wires_read([expr])
    if read <= {wire}:
        return True
    if len(read) == 1 and _is_kept(expr):
        found.append(expr)
        return True
    if isinstance(expr, typed.Access | typed.LenOf | typed.IsText | typed.Has | typed.Search) and wire not in wire_of(expr.place):
        return False
    return all(_can_be_known(part, wire, found) for part in operands(expr))


def _is_kept(expr: Expr) -> bool:
    """Whether a value of one wire's message is kept as a whole.

    It is read of the message, made of what no state can keep, or computes only what is chosen; what depends on more than a message is not.
    """
    if type_name(expr) is None or _free(expr) or _looks_elsewhere(expr):
        return False
    match expr:
        case typed.Access() | typed.LenOf() | typed.IsText() | typed.Has() | typed.Search() | typed.Reduce():
            return True
        case typed.Choice() | typed.Listed() | typed.Binary("and" | "or"):
            return True
        case _:
            return any(type_name(part) is None for part in operands(expr))


def _looks_elsewhere(expr: Expr) -> bool:
    """Whether an expression reads state, the time, what a user's function gives, or whether a message has arrived."""
    return any(
        isinstance(each, typed.StateVariable | typed.HostCall)
        or (isinstance(each, typed.Call) and not each.arguments)
        or asks_arrival(each)
        for each in parts(expr)
    )


def _free(expr: Expr) -> set[str]:
    """The loop variables that an expression does not choose itself."""
    if isinstance(expr, typed.Local):
        return {expr.name}
    inner = set[str]().union(*map(_free, operands(expr)))
    return inner - {expr.variable.name} if isinstance(expr, typed.Reduce | typed.Search | typed.Nearest) else inner
