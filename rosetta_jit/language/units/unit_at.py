"""In which unit the values at a place of a rule are: what `rosetta_jit.model.units.Context` knows at the end of its steps."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeGuard

from rosetta_jit.language.limits import MAX_KINDS
from rosetta_jit.language.typed import INT64, Const, Expr, FieldStep, IndexStep, Place, Step
from rosetta_jit.model.types import Array, Optional, Type
from rosetta_jit.model.units import Context
from rosetta_jit.startup.dataclass import dataclass, replace


@dataclass(frozen=True, slots=True)
class Mixed:
    """The units of elements of which a rule means any."""

    units: tuple[str | None, ...]


Unit = str | Mixed | None


def unit_at(place: Place) -> Unit:
    """The unit of the values at a place, if it is known."""
    first, *others = dict.fromkeys(context.unit for context in contexts_at(place))
    return Mixed((first, *others)) if others else first


def pairs_in_step(one: Place, other: Place) -> Iterator[tuple[str | None, str | None]]:
    """The units at two places, element by element where one variable says in both which; what is not so is a pair that differs."""
    indices = {step.index for place in (one, other) for step in place.steps if isinstance(step, IndexStep)}
    variables = [index for index in indices if not isinstance(index, Const)]
    fields = [step.field for place in (one, other) for step in place.steps if isinstance(step, FieldStep)]
    numbers = {step for field in fields for path, _ in field.part_units for step in path if isinstance(step, int)}
    for number in (*numbers, max(numbers, default=0) + 1):
        units = [unit_at(_fixed(place, variables[0], number)) for place in (one, other)] if len(variables) == 1 else ["", None]
        yield (None, "") if isinstance(units[0], Mixed) or isinstance(units[1], Mixed) else (units[0], units[1])


def _fixed(place: Place, variable: Expr, number: int) -> Place:
    """The same place for one value of an index."""
    known = Const(number, INT64)
    return replace(place, steps=tuple(replace(step, index=known) if _is_at(step, variable) else step for step in place.steps))


def _is_at(step: Step, variable: Expr) -> TypeGuard[IndexStep]:
    return isinstance(step, IndexStep) and step.index == variable


def contexts_at(place: Place) -> tuple[Context, ...]:
    """What is known at a place: several where an index is not, and not all elements are alike."""
    found: tuple[Context, ...] = (Context(),)
    length = None
    for step in place.steps:
        found = tuple(dict.fromkeys(each for context in found for each in _behind(step, context, length)))[:MAX_KINDS]
        length = _length(step.field.type) if isinstance(step, FieldStep) else None
    return found


def _length(type_: Type) -> int | None:
    return type_.fixed if isinstance(type_, Array) else _length(type_.value) if isinstance(type_, Optional) else None


def _behind(step: Step, context: Context, length: int | None) -> tuple[Context, ...]:
    match step:
        case FieldStep(field):
            return (context.member(field),)
        case _ if isinstance(step.index, Const):
            return (context.element(int(step.index.value)),)
        case _:
            every = context.elements
            return tuple(found for number, found in every.items() if number is not None or len(every) - 1 != (length or -1))
