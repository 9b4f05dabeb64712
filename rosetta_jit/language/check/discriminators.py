"""Discriminators of the unions that rules fill: a case implies its own where no rule sets it, else it must be the one that it selects."""

from __future__ import annotations

from rosetta_jit.language.places import field_names, places_in
from rosetta_jit.language.scope import Message, element_type
from rosetta_jit.language.typed import FieldStep, Place, Rule
from rosetta_jit.model.initial_values import selecting
from rosetta_jit.model.types import Array, Bytes, Field, Map, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass

Names = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Discriminator:
    """The field that selects the case of a union: set by a rule (``by_rule``), or implied by the case that rules fill.

    ``name`` and ``union`` are the field and the type of the union, ``type`` is that of the discriminator.
    """

    name: str
    union: Union
    type: Type
    by_rule: bool

    def label(self, case: str) -> int:
        """What selects a case."""
        return selecting(self.union, self.type, self.number(case))

    def number(self, case: str) -> int:
        """The number of a case, from 1."""
        return 1 + next(number for number, each in enumerate(self.union.cases) if each.name == case)


def discriminators_of(rules: tuple[Rule, ...], message: Message) -> dict[Names, Discriminator]:
    """The discriminators of the unions that rules fill, by the names of their places."""
    places = places_in(rules)
    named = {field_names(place) for place in places}
    found: dict[Names, Discriminator] = {}
    unions: dict[int, tuple[Struct, list[Field]]] = {}  # by the identity of the struct: to look at each rule takes quadratic time
    for place in places:
        type_: Type = message.root
        names: Names = ()
        for step in place.steps:
            if isinstance(step, FieldStep):
                if isinstance(type_, Struct):
                    if id(type_) not in unions:
                        unions[id(type_)] = type_, [each for each in type_.fields if isinstance(each.type, Union)]
                    nested = _of_struct(*unions[id(type_)], step.field, message, names, named)
                    found |= {(*names, each): discriminator for each, discriminator in nested}
                names, type_ = (*names, step.field.name), message.value_type(step.field.type)
            elif isinstance(type_, Array | Bytes | Map):
                type_ = message.value_type(element_type(type_))
    return found


def _of_struct(
    struct: Struct, unions: list[Field], touched: Field, message: Message, names: Names, named: set[Names]
) -> list[tuple[str, Discriminator]]:
    """The discriminators of a struct's ``unions``, where the union is ``touched`` or its discriminator is."""
    found: list[tuple[str, Discriminator]] = []
    for each in unions:
        if isinstance(each.type, Union) and touched.name in (each.name, each.type.discriminator or each.name):
            selector = next((field for field in struct.fields if field.name == each.type.discriminator), None)
            if selector is not None:
                discriminator = Discriminator(each.name, each.type, message.value_type(selector.type), (*names, selector.name) in named)
                found.append((selector.name, discriminator))
    return found


def discriminator_of(place: Place, steps: int) -> Names | None:
    """The name of the discriminator, if so many steps lead to a union that has one."""
    if not steps:
        return None  # the whole message, of one of several wires
    last = place.steps[steps - 1]
    if not (isinstance(last, FieldStep) and isinstance(last.field.type, Union) and last.field.type.discriminator):
        return None
    around = tuple(step.field.name for step in place.steps[: steps - 1] if isinstance(step, FieldStep))
    return (*around, last.field.type.discriminator)
