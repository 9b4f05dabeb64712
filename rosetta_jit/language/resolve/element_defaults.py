"""``default .a[].b``, and ``default rest`` of fields within elements: loops over all elements, behind the rules for their number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rosetta_jit.catalogue import rest as words
from rosetta_jit.catalogue.resolve import many_defaults
from rosetta_jit.language.limits import MAX_DEFAULTS
from rosetta_jit.language.places import field_names, value_inside
from rosetta_jit.language.resolve.defaults import ManyDefaultsError, default_rules
from rosetta_jit.language.resolve.expressions import type_index
from rosetta_jit.language.scope import Broken, Message, Scope, resolve_path
from rosetta_jit.language.typed import INT64, Const, Expr, FieldStep, For, IndexStep, Local, Place, Rule, SetLength, When
from rosetta_jit.language.untouched import Names
from rosetta_jit.model import mapping as model
from rosetta_jit.model.expr import Each, Index, Literal
from rosetta_jit.model.printer import show_expr
from rosetta_jit.model.types import Array, Struct
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Elements:
    """The names of an array, and those of a field within its elements."""

    array: Names
    field: Names


def elements_of(names: Names, message: Message) -> Elements | None:
    """The innermost array of variable length that a field lies in; None where it lies in none, or in one of fixed length."""
    struct, found = message.root, None
    for count, name in enumerate(names[:-1], 1):
        field = next(each for each in struct.fields if each.name == name)
        type_ = message.value_type(field.type)
        inner = value_inside(message, field.type)
        if isinstance(type_, Array):
            found = Elements(names[:count], names[count:]) if not isinstance(type_.length, int) else None
        if not isinstance(inner, Struct):
            return None
        struct = inner
    return found


def is_of_elements(rule: model.Rule) -> bool:
    """Whether a rule is `default .a[].b`."""
    return isinstance(rule, model.Default) and any(isinstance(step, Each) for step in rule.place.steps)


def named_elements(
    rules: Sequence[model.Rule], explicit: tuple[Rule, ...], broken: list[Names], scope: Scope
) -> list[tuple[Elements, Span | None]]:
    """The elements of which such ``rules`` say that a field has its default; other rules must say how many there are."""
    found: list[tuple[Elements, Span | None]] = []
    for rule in rules:
        if not isinstance(rule, model.Default):
            continue
        steps = (Index(Literal(0, rule.span)) if isinstance(step, Each) else step for step in rule.place.steps)
        place = resolve_path(replace(rule.place, steps=tuple(steps)), scope, type_index)
        if isinstance(place, Broken):
            broken.append(place.fields)
            continue
        names = field_names(place)
        if any(names[: len(each)] == each for each in broken):
            continue
        elements = elements_of(names, scope.messages[scope.target])
        if elements is not None and elements.array in lengths_in(explicit):
            found.append((elements, rule.span))
        else:
            scope.problems.append(words.no_elements(rule.span, show_expr(rule.place)))
            broken.append(names)
    return found


def with_defaults(rules: tuple[Rule, ...], wanted: Sequence[tuple[Elements, Span | None]], scope: Scope) -> tuple[Rule, ...]:
    """The rules, and behind each that sets the length of such an array a loop over its elements."""
    try:
        return tuple(made for rule in rules for made in _with(rule, wanted, scope.messages[scope.target], 0))
    except ManyDefaultsError:
        scope.problems.append(many_defaults(wanted[0][1], MAX_DEFAULTS))
        return rules


def _with(rule: Rule, wanted: Sequence[tuple[Elements, Span | None]], message: Message, depth: int) -> list[Rule]:
    match rule:
        case SetLength(place, value):
            mine = [(elements.field, span) for elements, span in wanted if elements.array == field_names(place)]
            return [rule, *([_loop(place, value, mine, message, depth)] if mine else [])]
        case For(variable, start, stop, body, span, kept):
            inner = tuple(made for each in body for made in _with(each, wanted, message, depth + 1))
            return [For(variable, start, stop, inner, span, kept)]
        case When(condition, then, otherwise, span):
            first, second = (tuple(made for each in block for made in _with(each, wanted, message, depth)) for block in (then, otherwise))
            return [When(condition, first, second, span)]
        case _:
            return [rule]


def _loop(array: Place, length: Expr, fields: Sequence[tuple[Names, Span | None]], message: Message, depth: int) -> Rule:
    number = Local(f"each element{depth or ''}", counts=True)
    body = [made for names, span in fields for made in default_rules(_field(array, number, names, message), message, span)]
    return For(number.name, Const(0, INT64), length, tuple(body), fields[0][1])


def _field(array: Place, number: Local, names: Names, message: Message) -> Place:
    steps, type_ = [*array.steps, IndexStep(number)], message.value_type(array.type)
    for name in names:
        struct = message.value_type(type_.element) if isinstance(type_, Array) else type_
        assert isinstance(struct, Struct)
        field = next(each for each in struct.fields if each.name == name)
        steps.append(FieldStep(field))
        type_ = message.value_type(field.type)
    return Place(array.side, tuple(steps), type_, array.span)


def lengths_in(rules: tuple[Rule, ...]) -> set[Names]:
    """The arrays whose length a rule sets."""
    found: set[Names] = set()
    for rule in rules:
        match rule:
            case SetLength(place):
                found.add(field_names(place))
            case For(body=body):
                found |= lengths_in(body)
            case When(then=then, otherwise=otherwise):
                found |= lengths_in(then) | lengths_in(otherwise)
            case _:
                pass
    return found
