"""What the rules of one execution path of a direction set."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.language.places import field_names
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Assign, Assignment, Default, Expr, FieldStep, For, Given, Local, Place, Rule, SetLength, When
from rosetta_jit.model.rules import Kept
from rosetta_jit.model.types import Array, Map, Struct, Union
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.language.algebra.equality import Ranges


FILTERED = Local("filtered")
"""The value of what a filter sets: which element it is of is not followed."""


@dataclass(frozen=True, slots=True)
class Write:
    """What a rule sets, in loops over these ranges."""

    is_length: bool
    place: Place
    value: Expr
    ranges: Ranges


def changed(rule: Assignment | SetLength[Place, Expr], value: Expr) -> Expr:
    """The value of a rule; one within which units change is not followed."""
    return value if isinstance(rule, SetLength) or rule.by is None else Given("in other units", (), value.type)


def writes_of(rules: tuple[Rule, ...], ranges: Ranges) -> Iterator[Write]:
    """What rules set."""
    for rule in rules:
        match rule:
            case Assign(place, value) | SetLength(place, value):
                yield Write(isinstance(rule, SetLength), place, changed(rule, value), ranges)
            case For(_, start, body=body, kept=Kept(count=count)) if count is not None:
                for each in writes_of(body, (*ranges, (start, count))):
                    yield replace(each, value=FILTERED)
            case For(_, start, stop, body):
                yield from writes_of(body, (*ranges, (start, stop)))
            case When(_, then, otherwise):
                yield from writes_of((*then, *otherwise), ranges)
            case _:
                pass


def is_left_absent(place: Place, rules: tuple[Rule, ...]) -> bool:
    """Whether no rule sets a place, something in it or around it."""
    names = field_names(place)
    set_ = (write.place for write in writes_of(rules, ()))
    left = (rule.place for rule in rules if isinstance(rule, Default) and field_names(rule.place) != names)
    return not any(_meet(names, field_names(each)) for each in (*set_, *left))


def _meet(one: tuple[str, ...], other: tuple[str, ...]) -> bool:
    """Whether one place lies in the other, or is it."""
    return all(a == b for a, b in zip(one, other, strict=False))


def is_within(write: Write, place: Place) -> bool:
    """Whether a rule sets a number or a text in a place, whatever loops do."""
    is_plain = not isinstance(write.place.type, Array | Struct | Union | Map)
    return is_plain and not write.is_length and not write.ranges and write.place.steps[: len(place.steps)] == place.steps


def is_part_of(place: Place, other: Place) -> bool:
    """Whether a place is another one, or lies in it."""
    return place.side == other.side and place.steps[: len(other.steps)] == other.steps


def union_depths(place: Place, message: Message) -> list[int]:
    """After how many fields on the way to a place the next one is a case of a union."""
    fields = [step.field for step in place.steps if isinstance(step, FieldStep)]
    return [number for number, each in enumerate(fields, 1) if isinstance(message.value_type(each.type), Union) and number < len(fields)]
