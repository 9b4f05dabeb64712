"""``default .a[].b``, and ``default rest`` of fields within elements: loops over all elements, behind the rules for their number."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import resolve
from rosetta_jit.catalogue import rest as words
from rosetta_jit.language.limits import MAX_DEFAULTS
from rosetta_jit.language.places import field_names, value_inside
from rosetta_jit.language.resolve.defaults import ManyDefaultsError, default_rules
from rosetta_jit.language.resolve.expressions import type_index
from rosetta_jit.language.scope import Broken, Message, Scope, resolve_path
from rosetta_jit.language.typed import (
    INT64,
    Assign,
    Const,
    Default,
    Expr,
    FieldStep,
    For,
    IndexStep,
    Local,
    Place,
    Rule,
    SetLength,
    Step,
    When,
)
from rosetta_jit.language.untouched import Names
from rosetta_jit.model import mapping as model
from rosetta_jit.model.expr import Each, Index, Literal
from rosetta_jit.model.types import Array, Struct
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.model import printer
else:
    printer = Late("rosetta_jit.model.printer")


@dataclass(frozen=True, slots=True)
class Elements:
    """The names of an array, and those of a field within its elements."""

    array: Names
    field: Names


def elements_of(names: Names, message: Message, within: Names) -> Elements | None:
    """The innermost array of variable length that a field of a message lies in; None where it lies in none, or in one of fixed length.

    The message may itself lie in another one: all names begin with those ``within``.
    """
    struct, found = message.root, None
    for count, name in enumerate(names[len(within) : -1], len(within) + 1):
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
        elements = elements_of(names, scope.messages[scope.target], field_names(scope.base(scope.target)))
        if elements is not None and elements.array in lengths_in(explicit):
            found.append((elements, rule.span))
        else:
            scope.problems.append(words.no_elements(rule.span, printer.show_expr(rule.place)))
            broken.append(names)
    return found


def with_defaults(rules: tuple[Rule, ...], wanted: Sequence[tuple[Elements, Span | None]], scope: Scope) -> tuple[Rule, ...]:
    """The rules, and behind each that sets the length of such an array a loop over its elements, unless a loop that sets them can do it."""
    try:
        return in_one_loop(tuple(made for rule in rules for made in _with(rule, wanted, scope.messages[scope.target], 0)))
    except ManyDefaultsError:
        scope.problems.append(resolve.many_defaults(wanted[0][1], MAX_DEFAULTS))
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


def in_one_loop(rules: tuple[Rule, ...]) -> tuple[Rule, ...]:
    """The rules, with loops that only leave fields of elements alone within those that set other fields of the same elements."""
    within = dict[int, list[For["Rule", "Expr"]]]()
    for rule in rules:
        array = _left_alone(rule)
        if isinstance(rule, For) and array is not None:
            loop = next((each for each in rules if isinstance(each, For) and _sets(each, array) and each.stop == rule.stop), None)
            within.setdefault(id(loop), []).extend([rule] if loop is not None else [])
    joined = {id(each) for found in within.values() for each in found}
    return tuple(
        replace(rule, body=(*rule.body, *(_renamed(each, rule.variable) for loop in within.get(id(rule), ()) for each in loop.body)))
        if isinstance(rule, For)
        else rule
        for rule in rules
        if id(rule) not in joined
    )


def _left_alone(rule: Rule) -> tuple[Step, ...] | None:
    """The array of whose elements a loop does nothing but leave fields alone, each element in turn."""
    match rule:
        case For(variable, Const(0), _, body, kept=None) if body and all(isinstance(each, Default) for each in body):
            arrays = {_array(each.place, variable) for each in body if isinstance(each, Default)}
            return arrays.pop() if len(arrays) == 1 else None
        case _:
            return None


def _sets(loop: For[Rule, Expr], array: tuple[Step, ...]) -> bool:
    """Whether a loop sets something of each element of an array in turn."""
    places = [each.place for each in loop.body if isinstance(each, Assign)]
    return loop.kept is None and loop.start == Const(0, INT64) and any(_array(place, loop.variable) == array for place in places)


def _array(place: Place, variable: str) -> tuple[Step, ...] | None:
    """The way to an array one of whose elements is chosen by a loop's variable, which is the only index of the place."""
    indices = [number for number, step in enumerate(place.steps) if isinstance(step, IndexStep)]
    return place.steps[: indices[0]] if len(indices) == 1 and place.steps[indices[0]] == IndexStep(Local(variable)) else None


def _renamed(rule: Rule, variable: str) -> Rule:
    """A field of an element left alone in a loop with another variable."""
    assert isinstance(rule, Default)
    steps = (IndexStep(Local(variable, counts=True)) if isinstance(step, IndexStep) else step for step in rule.place.steps)
    return replace(rule, place=replace(rule.place, steps=tuple(steps)))


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
