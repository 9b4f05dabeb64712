"""Counters: fields that hold the number of elements of an array. LCM has no other counts; a bottle schema may say so of a list (`:length`).

A message in which the two differ is refused, so that one can stand for the other wherever a message is read.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rosetta_jit.language.typed import FieldStep, Step
from rosetta_jit.model.expr import Expr, Member, Path
from rosetta_jit.model.types import Array, Bytes, Type

Counter = tuple[tuple["Step", ...], str]
"""The struct around, by the way to it, and the field of it that counts."""


def counter_of(steps: Sequence[Step]) -> Counter | None:
    """What tells the number of elements at a place, where one field alone does; of arrays within arrays, each has its own."""
    at = max((number for number, step in enumerate(steps) if isinstance(step, FieldStep)), default=None)
    found = [] if at is None else _counts(steps, at)
    dimensions = 0 if at is None else len(steps) - at - 1
    name = found[dimensions] if dimensions < len(found) else None
    return None if at is None or name is None else (tuple(steps[:at]), name)


def counters_of(steps: Sequence[Step]) -> Iterator[tuple[str, ...]]:
    """The names of the fields that count anything on the way to a place, at it, or within it."""
    around: tuple[str, ...] = ()
    for at, step in enumerate(steps):
        if isinstance(step, FieldStep):
            yield from ((*around, name) for name in _counts(steps, at) if name is not None)
            around = (*around, step.field.name)


def _counts(steps: Sequence[Step], at: int) -> list[str | None]:
    """What tells the length of the field at a step, and of the arrays within it."""
    step = steps[at]
    assert isinstance(step, FieldStep)
    field = step.field
    inside = list(_lengths(field.type))
    own = _name(field.length) if at == 0 else None  # its paths start at the message
    return [own, *inside[1:]] if own is not None else inside


def _lengths(type_: Type) -> Iterator[str | None]:
    while isinstance(type_, Array):
        yield _name(type_.length)
        type_ = type_.element
    if isinstance(type_, Bytes):
        yield _name(type_.length)


def _name(length: int | Expr | None) -> str | None:
    """The one field that a length is."""
    match length:
        case Path(_, (Member(name),)):
            return name
        case _:
            return None
