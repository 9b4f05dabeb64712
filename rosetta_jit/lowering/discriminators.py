"""Discriminators of the unions that rules fill: a case implies its own where no rule sets it, else it must be the one that it selects.

A rule for a discriminator runs before those for the cases: it chooses the case, which they are checked against.
"""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import check as words
from rosetta_jit.dataclass import dataclass
from rosetta_jit.kernel.ir import Assign as Set
from rosetta_jit.kernel.ir import Const, Expr, Switch, index
from rosetta_jit.lowering.places import field_names, places_in, rules_within
from rosetta_jit.lowering.scope import element_type
from rosetta_jit.lowering.typed import Assign, Default, FieldStep, For, IndexStep, SetLength, When
from rosetta_jit.lowering.typed import Const as Constant
from rosetta_jit.lowering.writer import integer
from rosetta_jit.model.births import selected, selecting
from rosetta_jit.model.types import Array, Bool, Bytes, Map, Struct, Union

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.lowering.scope import Message
    from rosetta_jit.lowering.typed import Place, Rule
    from rosetta_jit.lowering.writer import Writer
    from rosetta_jit.model.types import Field, Type
    from rosetta_jit.source import Span

Names = tuple[str, ...]

MAX_LABELS = 5_000
"""Labels that all values of discriminators together are compared with."""


@dataclass(frozen=True, slots=True)
class Told:
    """A union, the field that it is, and the type of its discriminator: ``by_rule`` if a rule sets that."""

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

    def chosen(self, writer: Writer, value: Expr) -> Expr:
        """The number of the case that a value selects."""
        if isinstance(value, Const):
            return index(selected(self.union, int(value.value)))
        found = writer.var("case", index(0 if self.union.default is None else self.union.default + 1))
        numbers = ((label, number) for number, labels in enumerate(self.union.labels, 1) for label in labels)
        cases = tuple((label, (Set(found.name, index(number)),)) for label, number in numbers)
        writer.emit(Switch(writer.let("label", integer(value)), cases, ()))
        return found


def told_unions(rules: tuple[Rule, ...], message: Message) -> dict[Names, Told]:
    """The unions with a discriminator that rules fill, by the names of their discriminators' places."""
    places = places_in(rules)
    named = {field_names(place) for place in places}
    found: dict[Names, Told] = {}
    for place in places:
        type_: Type = message.root
        names: Names = ()
        for step in place.steps:
            if isinstance(step, FieldStep):
                if isinstance(type_, Struct):
                    found |= {(*names, each): told for each, told in _unions(type_, step.field, message, names, named)}
                names, type_ = (*names, step.field.name), message.value_type(step.field.type)
            elif isinstance(type_, Array | Bytes | Map):
                type_ = message.value_type(element_type(type_))
    return found


def _unions(struct: Struct, touched: Field, message: Message, names: Names, named: set[Names]) -> list[tuple[str, Told]]:
    """The union with a discriminator in a struct, if it is ``touched`` or its discriminator is."""
    found: list[tuple[str, Told]] = []
    for each in struct.fields:
        if isinstance(each.type, Union) and touched.name in (each.name, each.type.discriminator or each.name):
            teller = next((field for field in struct.fields if field.name == each.type.discriminator), None)
            if teller is not None:
                told = Told(each.name, each.type, message.value_type(teller.type), (*names, teller.name) in named)
                found.append((teller.name, told))
    return found


def discriminator_of(place: Place, steps: int) -> Names | None:
    """The name of the discriminator, if so many steps lead to a union that has one."""
    last = place.steps[steps - 1]
    if not (isinstance(last, FieldStep) and isinstance(last.field.type, Union) and last.field.type.discriminator):
        return None
    around = tuple(step.field.name for step in place.steps[: steps - 1] if isinstance(step, FieldStep))
    return (*around, last.field.type.discriminator)


# --- the order of rules --------------------------------------------------------------------------------------------------


def discriminators_first(rules: tuple[Rule, ...], unions: Mapping[Names, Told], problems: list[Diagnostic]) -> tuple[Rule, ...]:
    """The rules in an order in which each discriminator is set before a case of its union.

    A problem where the array that a discriminator is in has no elements before a case is set, or where labels are too many.
    """
    told = {names: each for names, each in unions.items() if each.by_rule}
    if not told:
        return rules
    computed = (rule for rule in _assigned(rules) if not isinstance(rule.value, Constant))
    labels = sum(sum(map(len, told[names].union.labels)) for rule in computed if (names := field_names(rule.place)) in told)
    if labels > MAX_LABELS:
        problems.append(words.many_labels(rules[0].span, MAX_LABELS))
    return _ordered(rules, told, problems)


def _assigned(rules: tuple[Rule, ...]) -> list[Assign]:
    return [rule for rule in rules_within(rules) if isinstance(rule, Assign)]


def _ordered(rules: tuple[Rule, ...], told: Mapping[Names, Told], problems: list[Diagnostic]) -> tuple[Rule, ...]:
    rules = tuple(_inside(rule, told, problems) for rule in rules)
    order = _Order(told, problems)
    for number, rule in enumerate(rules):
        order.place(number, rule)
    moved = {id(rule) for found in order.early.values() for rule in found}
    return tuple(
        each
        for number, rule in enumerate(rules)
        for each in (*order.early.get(number, ()), rule)
        if each is not rule or id(rule) not in moved
    )


def _inside(rule: Rule, told: Mapping[Names, Told], problems: list[Diagnostic]) -> Rule:
    match rule:
        case For(body=body):
            return replace(rule, body=_ordered(body, told, problems))
        case When(_, then, otherwise):
            return replace(rule, then=_ordered(then, told, problems), otherwise=_ordered(otherwise, told, problems))
        case Default(place, span) if field_names(place) in told:
            return Assign(place, _zero(place, span), span)
        case _:
            return rule


def _zero(place: Place, span: Span | None) -> Constant:
    return Constant(False if isinstance(place.type, Bool) else 0, place.type, span)


@dataclass(slots=True)
class _Order:
    """Where in a block the rules for discriminators belong: ``early`` are those that are moved to before a rule."""

    told: Mapping[Names, Told]
    problems: list[Diagnostic]
    early: dict[int, list[Rule]] = field(default_factory=dict[int, "list[Rule]"])
    cases: dict[Names, int] = field(default_factory=dict[Names, int])
    bare: dict[Names, int] = field(default_factory=dict[Names, int])
    arrays: dict[Names, int] = field(default_factory=dict[Names, int])

    def place(self, number: int, rule: Rule) -> None:
        """Look at the next rule of the block: ``cases`` and ``bare`` are the first rules for cases, with and without discriminators."""
        leaves = [each for each in rules_within((rule,)) if isinstance(each, Assign | SetLength | Default)]
        telling = [each.place for each in leaves if field_names(each.place) in self.told]
        tells = {field_names(place) for place in telling}
        chosen = {names for each in leaves for names in _cases_of(each.place)} & self.told.keys()
        behind = [found for names in tells if (found := (self.bare if names in chosen else self.cases).get(names)) is not None]
        if behind:
            self.move(rule, min(behind), telling)
        for names in chosen:
            self.cases.setdefault(names, number)
            if names not in tells:
                self.bare.setdefault(names, number)
        self.arrays |= {field_names(each.place): number for each in leaves if isinstance(each.place.type, Array | Map)}

    def move(self, rule: Rule, before: int, telling: list[Place]) -> None:
        late = [place for place in telling if any(self.arrays.get(array, -1) >= before for array in _arrays(place))]
        if late:
            self.problems.append(words.late_discriminator(late[0].span, "".join(f".{name}" for name in field_names(late[0]))))
        self.early.setdefault(before, []).append(rule)


def _cases_of(place: Place) -> list[Names]:
    """The discriminators of the unions that a place is in a case of, or is."""
    return [names for steps in range(1, len(place.steps) + 1) if (names := discriminator_of(place, steps)) is not None]


def _arrays(place: Place) -> list[Names]:
    """The arrays that a place is in."""
    return [
        field_names(replace(place, steps=place.steps[:number])) for number, step in enumerate(place.steps) if isinstance(step, IndexStep)
    ]
