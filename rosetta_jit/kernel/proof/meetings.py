"""Where the branches of a kernel meet again, in the record of what it owes: what holds from there on must hold on each path."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from rosetta_jit.kernel.proof import claims
from rosetta_jit.kernel.proof.formula import All, Any, Formula, equal
from rosetta_jit.kernel.proof.linear import Linear
from rosetta_jit.kernel.proof.record import Premise, Record, chain
from rosetta_jit.kernel.proof.scope import Arrival, Scope, Typed, Value


def meet(
    scope: Scope,
    record: Record,
    before: dict[str, Typed],
    arrivals: list[Arrival],
    walk: Callable[[Scope, dict[str, Typed], list[Arrival]], None],
) -> None:
    """Go on where paths meet, and write down that what is taken as known from there on holds on each of them."""
    common, first = record.premises(), len(scope.facts.lows)
    claimed = record.claimed(lambda: walk(scope, before, arrivals))
    ways = Any(tuple(All((*_since(each.premises, common), *_values(scope, before, each))) for each in arrivals))
    met = Premise(ways, record.stmt, common)
    for formula in claimed:
        record.write(met, formula, claims.ALL_PATHS, first, "paths")
    for arrival in arrivals:
        for formula in _unlike(scope, before, arrival, first):
            record.write(arrival.premises, formula, claims.ALL_PATHS, first, "paths")


def _since(premises: Premise | None, common: Premise | None) -> list[Formula]:
    """What one path took as known since it left the others."""
    found: list[Formula] = []
    for premise in chain(premises):
        if premise is common:
            break
        found.append(premise.formula)
    return found


def _values(scope: Scope, before: dict[str, Typed], arrival: Arrival) -> list[Formula]:
    """That the variables and the used lengths where paths meet are those of one of them."""
    return [equal(here, there) for here, there in _pairs(scope, before, arrival) if isinstance(here, Linear) and isinstance(there, Linear)]


def _unlike(scope: Scope, before: dict[str, Typed], arrival: Arrival, first: int) -> Iterator[Formula]:
    """Where values are kept that are no new unknowns (atoms from ``first`` on), they must be those of each path."""
    for here, there in _pairs(scope, before, arrival):
        if isinstance(here, Linear) and isinstance(there, Linear):
            if here != there and all(atom < first for atom, _ in here.terms):
                yield equal(here, there)
        elif here is not None and here != there:
            yield False


def _pairs(scope: Scope, before: dict[str, Typed], arrival: Arrival) -> list[tuple[Value, Value]]:
    """The values of variables and the used lengths where paths meet, each with that of one path."""
    values: list[tuple[Value, Value]] = [(scope.locals[name][1], arrival.changed.get(name, old)[1]) for name, old in before.items()]
    return [*values, *zip(scope.used, arrival.used, strict=True)]
