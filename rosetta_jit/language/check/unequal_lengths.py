"""Arrays that a loop reads up to the length of another: a warning, unless the mapping refuses messages in which the two differ.

`for i from 0 to len(.name) … .position[i] … end` is right only where there are as many positions as names, and nothing but the mapping can
say so: `reject "…" when len(.position) != len(.name)`.
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.catalogue import check as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.places import shown_shape
from rosetta_jit.language.typed import (
    Assign,
    Binary,
    Const,
    Expr,
    FieldStep,
    For,
    IndexStep,
    LenOf,
    Local,
    Place,
    Reject,
    Rule,
    SetLength,
    Step,
    When,
)
from rosetta_jit.language.untouched import places_read
from rosetta_jit.model.types import Array, Bytes

Steps = tuple["Step", ...]
Pairs = frozenset[frozenset["Steps"]]


def other_lengths(rules: tuple[Rule, ...]) -> Iterator[Diagnostic]:
    """Warnings of one direction."""
    yield from _within(rules, frozenset(_agreed(rules)), {})


def _within(rules: tuple[Rule, ...], agreed: Pairs, loops: dict[str, Place]) -> Iterator[Diagnostic]:
    """``loops`` are the arrays whose lengths the variables run to."""
    for rule in rules:
        match rule:
            case For(variable, Const(0), LenOf(place), body):
                yield from _within(body, agreed, {**loops, variable: place})
            case For(variable, body=body):
                yield from _within(body, agreed, {name: place for name, place in loops.items() if name != variable})
            case When(_, then, otherwise):
                yield from _within((*then, *otherwise), agreed, loops)
            case Assign(_, value) | SetLength(_, value):
                yield from (found for place in places_read(value) for found in _reports(place, agreed, loops))
            case _:
                pass


def _reports(place: Place, agreed: Pairs, loops: dict[str, Place]) -> Iterator[Diagnostic]:
    for number, step in enumerate(place.steps):
        bound = loops.get(step.index.name) if isinstance(step, IndexStep) and isinstance(step.index, Local) else None
        array = place.steps[:number]
        if bound is None or bound.side != place.side or bound.steps == array or frozenset((bound.steps, array)) in agreed:
            continue
        if _has_own_length(array):
            yield words.other_length(place.span, shown_shape(array), shown_shape(bound.steps))


def _has_own_length(array: Steps) -> bool:
    """Whether neither the type nor another field tells the length of an array."""
    if not array or not isinstance(array[-1], FieldStep):
        return False
    field = array[-1].field
    return field.length is None and not (isinstance(field.type, Array | Bytes) and field.type.length is not None)


def _agreed(rules: tuple[Rule, ...]) -> Iterator[frozenset[Steps]]:
    """Arrays of which messages with different lengths are refused."""
    for rule in rules:
        if isinstance(rule, When) and rule.then and isinstance(rule.then[0], Reject):
            yield from _unequal(rule.condition)


def _unequal(condition: Expr) -> Iterator[frozenset[Steps]]:
    match condition:
        case Binary("!=", LenOf(left), LenOf(right)):
            yield frozenset((left.steps, right.steps))
        case Binary("or", left, right):
            yield from _unequal(left)
            yield from _unequal(right)
        case _:
            pass
