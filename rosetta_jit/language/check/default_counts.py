"""Fields that count the elements of an array and are left at 0, their default, where rules give the array elements: those never agree."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.catalogue import rest as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.places import field_names, shown_place
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Assign, Const, Default, FieldStep, Place, Rule, SetLength
from rosetta_jit.model.types import Array, Bytes, Int, Struct, Type
from rosetta_jit.model.walk import every_rule, fields_of, names_of, path_of


def defaulted_counts(rules: tuple[Rule, ...], target: Message) -> list[Diagnostic]:
    """The defaults of a direction that rules for an array contradict."""
    filled = {field_names(place) for place in _filled(rules)}
    problems: list[Diagnostic] = []
    for rule in _defaults(rules):
        *around, name = field_names(rule.place)
        owner = _owner(rule.place, target)
        arrays = [each for each in (owner.fields if owner is not None else ()) if (*around, each.name) in filled]
        counted = (each for each in arrays if name in _counts(target.value_type(each.type)))
        problems.extend(words.default_count(rule.span, shown_place(rule.place.steps), f".{each.name}") for each in counted)
    return problems


def _defaults(rules: tuple[Rule, ...]) -> Iterator[Default[Place]]:
    for rule in every_rule(rules):
        if isinstance(rule, Default) and isinstance(rule.place.type, Int) and isinstance(rule.place.steps[-1], FieldStep):
            yield rule


def _filled(rules: tuple[Rule, ...]) -> Iterator[Place]:
    """Arrays that rules assign, or give a length that is not written down as 0."""
    for rule in every_rule(rules):
        match rule:
            case Assign(place) if isinstance(place.type, Array | Bytes):
                yield place
            case SetLength(place, value) if not (isinstance(value, Const) and value.value == 0):
                yield place
            case _:
                pass


def _owner(place: Place, message: Message) -> Struct | None:
    """The struct that a field is of."""
    owner: Type = message.root
    for step in place.steps[:-1]:
        if isinstance(step, FieldStep):
            owner = message.value_type(step.field.type)
        elif isinstance(owner, Array):
            owner = message.value_type(owner.element)
    return owner if isinstance(owner, Struct) else None


def _counts(type_: Type) -> set[str]:
    """The fields beside an array that tell its length."""
    if not isinstance(type_, Array | Bytes) or type_.length is None or isinstance(type_.length, int):
        return set()
    return {names_of(path_of(each))[-1] for each in fields_of(type_.length, "wire") if names_of(path_of(each))}
